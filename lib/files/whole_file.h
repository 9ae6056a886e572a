// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "files/regular_file.h"
#include "files/replace.h"

#include <cstddef>
#include <string>
#include <string_view>

/// Files that are complete or not there. Errors are texts with the file's name.
namespace files {

/// "'film.vtt': No space left on device", with errno.
std::string file_error(const std::string &path);

/// The content of a file, up to `most` bytes.
tl::expected<std::string, std::string> read_whole(const std::string &path, std::size_t most);
tl::expected<std::string, std::string> read_whole(const File &file, const std::string &path,
                                                  std::size_t most);

/// False, with errno, if not all can be written.
bool write_all(const File &file, std::string_view bytes);

/// The file is replaced as a whole, and is on the disk. Returns a warning if it is in place, but
/// was perhaps not written to the disk; else none.
tl::expected<std::string, std::string> replace_file(const std::string &path, std::string_view bytes,
                                                    Readers readers = Readers::as_before);

} // namespace files
