// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include <tl/expected.hpp>

/// The one place that opens files which a user names. A pipe without a writer, a device or a folder
/// of that name is refused; nothing waits for it.
namespace files {

/// A file descriptor, closed with the object.
class File
{
public:
  File() = default;
  explicit File(int descriptor) : descriptor_(descriptor)
  {
  }
  ~File();
  File(File &&other) noexcept : descriptor_(std::exchange(other.descriptor_, -1))
  {
  }
  File &operator=(File &&other) noexcept
  {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  int descriptor() const
  {
    return descriptor_;
  }
  explicit operator bool() const
  {
    return descriptor_ >= 0;
  }
  /// Leaves the descriptor to the caller.
  int release()
  {
    return std::exchange(descriptor_, -1);
  }

private:
  int descriptor_ = -1;
};

/// Why a file cannot be used.
struct Error
{
  int number = 0;     ///< errno, such as ENOENT; 0: it is no regular file, or too large
  std::string reason; ///< without its name
};

/// Opens a regular file for reading.
tl::expected<File, Error> open_regular(const std::string &path);

/// An error for anything else than a regular file; none where there is nothing of that name.
tl::expected<void, Error> expect_regular(const File &file);
tl::expected<void, Error> expect_regular(const std::string &path);

/// The content of a regular file from its beginning; an error if it exceeds `most` bytes.
tl::expected<std::string, Error> read(const File &file, std::size_t most);
tl::expected<std::string, Error> read(const std::string &path, std::size_t most);

/// Creates or empties a file for writing, which never waits: a pipe is refused, but for this
/// process's own output and errors (/dev/stdout). A device, such as a terminal, and that pipe fail
/// a write for which they have no room.
tl::expected<File, Error> create(const std::string &path);

} // namespace files
