// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tl/expected.hpp>

#include <cstddef>
#include <string>
#include <vector>

/// The tokens of a file that only the user can read, or new ones, which the file has from now on:
/// the addresses of pages stay when their program is started again. Fails if the file cannot be
/// written, or others can read it, as on a file system without permissions: then there is none.
tl::expected<std::vector<std::string>, std::string> kept_tokens(const std::string &file,
                                                                std::size_t count);
