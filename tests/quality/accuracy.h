// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "table.h"

#include <filesystem>

namespace quality {

/// How well maps agree with those of a double-precision oracle, which computes L*a*b* of every
/// pixel and decimates that.
///
/// Of the front ends "default" converts where conversion_level() says, "exact" every pixel.
///
/// Spatial maps of tuned and maps of tuned_spatial on dead leaves with sensor noise σ 2; with
/// `data`, not empty, also on the photographs in its folder osie, and spatial and spatiotemporal
/// maps of tuned on the films in its folder clips. A spatial map is computed in double precision
/// throughout; what follows is the library's (Stages), run over the oracle's L*a*b*.
///
/// `quick`: fewer leaves, every tenth photograph, the first 100 frames of films. Throws
/// std::runtime_error if a file is missing or cannot be read.
Table accuracy_table(const std::filesystem::path &data, int threads, bool quick);

/// Whether both front ends keep to their floors on a few leaves; says where not.
bool accuracy_holds(int threads);

} // namespace quality
