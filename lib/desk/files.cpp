// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/files.h"

#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace fs = std::filesystem;

namespace desk {

namespace {

using files::folder_of;

constexpr std::string_view kVersion = ".desk~"; ///< and a number and "~"

tl::unexpected<std::string>
failed(const std::string &path)
{
  return tl::unexpected(file_error(path));
}

std::string
named(const std::string &path, const files::Error &error)
{
  return "'" + path + "': " + error.reason;
}

/// The numbers of the versions that are kept.
std::vector<int>
versions(const std::string &path)
{
  std::vector<int> numbers;
  const std::string stem = fs::path(path).filename().string() + std::string(kVersion);
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(path), error), none; !error && entry != none;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with('~') || name.size() <= stem.size())
      continue;
    int number = 0;
    const char *const end = name.data() + name.size() - 1;
    const auto [stop, wrong] = std::from_chars(name.data() + stem.size(), end, number);
    if (wrong == std::errc() && stop == end && number > 0 && number < 1'000'000'000)
      numbers.push_back(number);
  }
  return numbers;
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
  return files::read(path, most).map_error([&](const files::Error &error) {
    return named(path, error);
  });
}

tl::expected<std::string, std::string>
read_whole(const File &file, const std::string &path, std::size_t most)
{
  return files::read(file, most).map_error([&](const files::Error &error) {
    return named(path, error);
  });
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
replace_file(const std::string &path, std::string_view bytes)
{
  const fs::path whole(path);
  std::string part = folder_of(path) + "/." + whole.filename().string() + ".XXXXXX";
  const File file(mkostemp(part.data(), O_CLOEXEC));
  if (!file)
    return failed(part);
  const auto give_up = [&](tl::unexpected<std::string> error) {
    unlink(part.c_str());
    return error;
  };
  if (!write_all(file, bytes))
    return give_up(failed(path));
  std::error_code ignored;
  if (!fs::exists(whole, ignored)) {
    const mode_t mask = umask(0);
    umask(mask);
    if (fchmod(file.descriptor(), 0666 & ~mask) != 0 && errno != EPERM) // FAT has no permissions
      return give_up(failed(path));
  }
  const auto replaced = files::replace(file, part, path);
  if (!replaced)
    return give_up(tl::unexpected(named(path, replaced.error())));
  return *replaced
             ? std::string()
             : file_error(folder_of(path)) + ", after the file was written; save it elsewhere, too";
}

tl::expected<std::string, std::string>
keep_version(const std::string &path, int most)
{
  std::error_code error;
  if (!fs::exists(path, error))
    return {};
  const std::vector<int> numbers = versions(path);
  int newest = 0;
  for (const int number : numbers)
    newest = std::max(newest, number);
  const auto named = [&](int number) {
    return path + std::string(kVersion) + std::to_string(number) + "~";
  };
  newest++;
  fs::create_hard_link(path, named(newest), error); // the new file has another inode
  if (error)
    fs::copy_file(path, named(newest), error);
  if (error) {
    std::error_code ignored;
    fs::remove(named(newest), ignored);
    return tl::unexpected("'" + named(newest) + "': " + error.message());
  }
  for (const int number : numbers)
    if (number <= newest - most)
      fs::remove(named(number), error);
  return fs::path(named(newest)).filename().string();
}

} // namespace desk
