// SPDX-License-Identifier: LGPL-2.1-or-later
#include "files/regular_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace files {

namespace {

tl::unexpected<Error>
failed(int number)
{
  return tl::unexpected(Error{ number, std::generic_category().message(number) });
}

tl::unexpected<Error>
refused(std::string reason)
{
  return tl::unexpected(Error{ 0, std::move(reason) });
}

const char *
kind_of(mode_t mode)
{
  return S_ISDIR(mode)    ? "a folder"
         : S_ISFIFO(mode) ? "a pipe"
         : S_ISSOCK(mode) ? "a socket"
                          : "a device";
}

/// A pipe that this process was given to write to has a reader already, such as /dev/stdout.
bool
is_own_output(const struct stat &pipe)
{
  return std::ranges::any_of(std::array{ STDOUT_FILENO, STDERR_FILENO }, [&](int own) {
    struct stat status
    {
    };
    return fstat(own, &status) == 0 && status.st_dev == pipe.st_dev && status.st_ino == pipe.st_ino;
  });
}

/// `writes`: what takes data as a file does will do.
tl::expected<void, Error>
expect_kind(const struct stat &status, bool writes)
{
  if (S_ISREG(status.st_mode) || (writes && S_ISCHR(status.st_mode))
      || (writes && S_ISFIFO(status.st_mode) && is_own_output(status)))
    return {};
  return refused(std::string("expected a regular file, got ") + kind_of(status.st_mode));
}

tl::expected<void, Error>
expect_kind(const File &file, bool writes)
{
  struct stat status
  {
  };
  if (fstat(file.descriptor(), &status) != 0)
    return failed(errno);
  return expect_kind(status, writes);
}

/// With O_NONBLOCK, a pipe that takes the name in between is not waited for either.
tl::expected<File, Error>
open_checked(const std::string &path, int flags, bool writes)
{
  struct stat status
  {
  };
  // Some devices act as soon as they are opened. If there is no file, open() has the reason.
  if (stat(path.c_str(), &status) == 0)
    if (const auto expected = expect_kind(status, writes); !expected)
      return tl::unexpected(expected.error());
  File file(open(path.c_str(), flags | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666));
  if (!file)
    return failed(errno);
  if (const auto expected = expect_kind(file, writes); !expected)
    return tl::unexpected(expected.error());
  return file;
}

} // namespace

File::~File()
{
  if (descriptor_ >= 0)
    close(descriptor_);
}

tl::expected<File, Error>
open_regular(const std::string &path)
{
  return open_checked(path, O_RDONLY, false);
}

tl::expected<void, Error>
expect_regular(const File &file)
{
  return expect_kind(file, false);
}

tl::expected<std::string, Error>
read(const File &file, std::size_t most)
{
  struct stat status
  {
  };
  if (fstat(file.descriptor(), &status) != 0)
    return failed(errno);
  const auto too_large = [most] {
    const bool is_round = most >= std::size_t{ 1 } << 20;
    return refused("larger than the " + std::to_string(is_round ? most >> 20 : most)
                   + (is_round ? " MiB" : " bytes") + " that are read");
  };
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > most)
    return too_large();
  std::string bytes;
  bytes.reserve(size);
  std::array<char, 65536> piece;
  for (;;) {
    const ssize_t count
        = pread(file.descriptor(), piece.data(), piece.size(), static_cast<off_t>(bytes.size()));
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0)
      return failed(errno);
    if (count == 0)
      return bytes;
    if (bytes.size() + static_cast<std::size_t>(count) > most) // it grows
      return too_large();
    bytes.append(piece.data(), static_cast<std::size_t>(count));
  }
}

tl::expected<std::string, Error>
read(const std::string &path, std::size_t most)
{
  return open_regular(path).and_then([most](const File &file) { return read(file, most); });
}

tl::expected<File, Error>
create(const std::string &path)
{
  return open_checked(path, O_WRONLY | O_CREAT | O_TRUNC, true);
}

} // namespace files
