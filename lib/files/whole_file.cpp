// SPDX-License-Identifier: LGPL-2.1-or-later
#include "files/whole_file.h"

#include "files/replace.h"

#include <glib.h>

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace fs = std::filesystem;

namespace files {

namespace {

tl::unexpected<std::string>
failed(const std::string &path)
{
  return tl::unexpected(file_error(path));
}

std::string
named(const std::string &path, const Error &error)
{
  return "'" + path + "': " + error.reason;
}

} // namespace

std::string
file_error(const std::string &path)
{
  return "'" + path + "': " + std::generic_category().message(errno);
}

tl::expected<std::string, std::string>
read_whole(const std::string &path, std::size_t most)
{
  return read(path, most).map_error([&](const Error &error) { return named(path, error); });
}

tl::expected<std::string, std::string>
read_whole(const File &file, const std::string &path, std::size_t most)
{
  return read(file, most).map_error([&](const Error &error) { return named(path, error); });
}

bool
write_all(const File &file, std::string_view bytes)
{
  while (!bytes.empty()) {
    const ssize_t count = write(file.descriptor(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0)
      return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

tl::expected<std::string, std::string>
replace_file(const std::string &path, std::string_view bytes, Readers readers)
{
  const fs::path whole(path);
  std::string part = folder_of(path) + "/." + whole.filename().string() + ".XXXXXX";
  std::error_code ignored;
  const bool is_new = readers == Readers::as_before && !fs::exists(whole, ignored);
  const int mode = is_new ? 0666 : 0600; // less the umask
  const File file(g_mkstemp_full(part.data(), O_RDWR | O_CLOEXEC, mode));
  if (!file)
    return failed(part);
  const auto give_up = [&](tl::unexpected<std::string> error) {
    unlink(part.c_str());
    return error;
  };
  if (!write_all(file, bytes))
    return give_up(failed(path));
  const auto replaced = replace(file, part, path, readers);
  if (!replaced)
    return give_up(tl::unexpected(named(path, replaced.error())));
  return *replaced
             ? std::string()
             : file_error(folder_of(path)) + ", after the file was written; save it elsewhere, too";
}

} // namespace files
