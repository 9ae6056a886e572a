// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

namespace tactor {

/// The first 4096 bytes of a file without trailing white space; empty if it cannot be read.
inline std::string
small_file(const std::filesystem::path &path)
{
  std::ifstream file(path);
  std::array<char, 4096> bytes{};
  file.read(bytes.data(), bytes.size());
  std::string text(bytes.data(), static_cast<std::size_t>(file.gcount()));
  text.erase(text.find_last_not_of(" \t\r\n") + 1); // npos + 1 is 0
  return text;
}

} // namespace tactor
