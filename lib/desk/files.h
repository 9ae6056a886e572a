// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include <tl/expected.hpp>

/// Versions of a file.
namespace desk {

/// Keeps the present content of a file as "PATH.desk~N~", with N one above the highest, and removes
/// those that are `most` older. Returns the name without the folder; empty if there is no file. The
/// "PATH.~N~" of other programs stay.
tl::expected<std::string, std::string> keep_version(const std::string &path, int most);

} // namespace desk
