// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Reads a clip of a .hasp file, a project of Meta Haptics Studio, as one cell. Each clip holds a
/// .haptic document (read_haptic()). The format is that of github.com/facebook/haptics-studio.
/// \param name of the clip; empty: the clip that the project was last open at, or the first one.
///        The first clip of several of one name is read.
/// \param ignored gets the names of the other clips too.
tl::expected<Track, FormatError> read_hasp(std::string_view text, const std::string &name,
                                           std::vector<std::string> &ignored);

} // namespace tactile
