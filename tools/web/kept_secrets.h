// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

/// Writes a file, which only the user may read if it is new. Returns a warning as
/// files::replace_file() does. Throws std::runtime_error.
std::string write_private_file(const std::string &path, const std::string &text);

/// Secrets of the addresses of a program's pages, from a file that only the user may read; without
/// a valid one, they are new and written there. They stay: a page that is open when the program ends
/// finds the next one at the same address. Throws std::runtime_error if the file cannot be written.
std::vector<std::string> kept_secrets(const std::string &file, std::size_t count);
