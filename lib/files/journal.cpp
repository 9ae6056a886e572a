// SPDX-License-Identifier: LGPL-2.1-or-later
#include "files/journal.h"

#include "files/replace.h"

#include <glib.h>

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace files {

namespace {

constexpr std::size_t kLargest = std::size_t{ 1 } << 30;

bool
has_name(const File &file, const std::string &path)
{
  struct stat opened
  {
  };
  struct stat named
  {
  };
  return fstat(file.descriptor(), &opened) == 0 && lstat(path.c_str(), &named) == 0
         && opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

} // namespace

tl::expected<Journal, std::string>
Journal::open(const std::string &path, const Kind &kind)
{
  for (;;) {
    File file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600));
    if (!file)
      return tl::unexpected(file_error(path) + "; expected a folder that can be written to, for "
                            + kind.name);
    if (const auto regular = expect_regular(file); !regular)
      return tl::unexpected("'" + path + "': " + regular.error().reason + "; " + kind.name
                            + " needs this name");
    if (flock(file.descriptor(), LOCK_EX | LOCK_NB) != 0)
      return tl::unexpected("'" + path + "' is in use: " + kind.in_use);
    if (!has_name(file, path)) // the process that had it has removed it since
      continue;
    if (!sync_folder(path))
      return tl::unexpected(file_error(path));
    return Journal(std::move(file), path, kind);
  }
}

tl::expected<Journal::Content, std::string>
Journal::read()
{
  Content content;
  size_ = 0;
  struct stat status
  {
  };
  if (fstat(file_.descriptor(), &status) == 0
      && static_cast<std::size_t>(status.st_size) > kLargest) {
    content.damaged = true;
    return content;
  }
  const auto bytes = read_whole(file_, path_, kLargest);
  if (!bytes)
    return tl::unexpected(bytes.error());
  return parse(*bytes, kind_, size_);
}

tl::expected<Journal::Content, std::string>
Journal::peek(const std::string &path, const Kind &kind)
{
  std::size_t size = 0;
  return read_whole(path, kLargest).map([&](const std::string &bytes) {
    return parse(bytes, kind, size);
  });
}

Journal::Content
Journal::parse(std::string_view rest, const Kind &kind, std::size_t &size)
{
  Content content;
  for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;
       rest.remove_prefix(end + 1)) {
    std::string line(rest.substr(0, end));
    if (size > 0) {
      content.entries.push_back(std::move(line));
    } else if (line.starts_with(kind.header)) {
      gsize length = 0;
      g_autofree guchar *base = g_base64_decode(line.c_str() + kind.header.size(), &length);
      content.base.assign(reinterpret_cast<const char *>(base), length);
    } else {
      content.damaged = true;
      return content;
    }
    size += end + 1;
  }
  // The beginning of a header is one that was never answered.
  content.damaged = size == 0 && !rest.empty()
                    && !kind.header.starts_with(rest.substr(0, kind.header.size()))
                    && !rest.starts_with(kind.header);
  return content;
}

std::string
Journal::header(std::string_view base) const
{
  g_autofree gchar *text
      = g_base64_encode(reinterpret_cast<const guchar *>(base.data()), base.size());
  return std::string(kind_.header) + text + "\n";
}

tl::expected<void, std::string>
Journal::append(std::string_view base, std::string_view entry)
{
  std::string bytes;
  if (size_ + entry.size() + base.size() / 3 * 4 + kind_.header.size() + 8 > kLargest)
    return tl::unexpected("'" + path_ + "' is full; " + kind_.if_full);
  if (size_ == 0)
    bytes = header(base);
  bytes.append(entry).append("\n");
  const auto size = static_cast<off_t>(size_);
  if (ftruncate(file_.descriptor(), size) == 0 && lseek(file_.descriptor(), size, SEEK_SET) == size
      && write_all(file_, bytes) && fdatasync(file_.descriptor()) == 0) {
    size_ += bytes.size();
    return {};
  }
  const std::string error = file_error(path_);
  if (ftruncate(file_.descriptor(), size) != 0)
    return tl::unexpected(error + ", and what was written of the entry cannot be taken back");
  return tl::unexpected(error);
}

tl::expected<void, std::string>
Journal::clear()
{
  if (ftruncate(file_.descriptor(), 0) != 0)
    return tl::unexpected(file_error(path_));
  size_ = 0; // whether or not the disk has it
  if (fsync(file_.descriptor()) != 0)
    return tl::unexpected(file_error(path_));
  return {};
}

tl::expected<void, std::string>
Journal::replace(std::string_view base, std::string_view entry)
{
  return replace_file(path_, header(base).append(entry).append("\n"))
      .and_then([&](const std::string &warning) -> tl::expected<Journal, std::string> {
        if (!warning.empty())
          return tl::unexpected(warning);
        return open(path_, kind_);
      })
      .and_then([&](Journal &&fresh) {
        *this = std::move(fresh);
        return read();
      })
      .map([](const Content &) {});
}

void
Journal::remove()
{
  unlink(path_.c_str());
}

tl::expected<std::string, std::string>
Journal::set_aside()
{
  for (int number = 1;; number++) {
    const std::string name = path_ + ".damaged-" + std::to_string(number);
    // Some file systems have no links. No other program gives such names: we hold the journal's
    // lock.
    if (access(name.c_str(), F_OK) == 0)
      continue;
    if (rename(path_.c_str(), name.c_str()) != 0)
      return tl::unexpected(file_error(name));
    tl::expected<Journal, std::string> fresh = open(path_, kind_);
    if (!fresh)
      return tl::unexpected(fresh.error());
    *this = *std::move(fresh);
    return name;
  }
}

} // namespace files
