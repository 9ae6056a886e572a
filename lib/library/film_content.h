// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace library {

/// SHA-256, in hexadecimal, of a film's size in decimal and of 64 KiB each from its beginning,
/// middle and end. The name does not count. Empty: it is no file, or cannot be read.
std::string film_content(const std::string &film);

/// A file at one time. One that is still being downloaded or recorded is another later.
struct FileVersion
{
  std::uintmax_t size;
  std::filesystem::file_time_type changed;
  bool operator==(const FileVersion &) const = default;
};

/// The present version of a file; none: it cannot be read.
std::optional<FileVersion> file_version(const std::string &path);

} // namespace library
