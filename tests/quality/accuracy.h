// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "table.h"

#include <filesystem>

namespace quality {

/// How many frames the oracle, which is slow, is asked about.
enum class OracleExtent
{
  few,  ///< every tenth photograph, 3 s of each film
  some, ///< every fourth photograph, 30 s of each film
  all,
};

/// Agreement of maps with a double-precision oracle, which converts every pixel to L*a*b* and
/// decimates the result.
///
/// The front end "default" converts at decimation_level(), "exact" every pixel.
///
/// Compares spatial maps of tuned and maps of tuned_spatial on dead leaves with sensor noise σ 2.
/// If `data` is not empty, also on the photographs in its folder osie, and spatial and
/// spatiotemporal maps of tuned on the films in its folder clips. The oracle's spatial maps are in
/// double precision throughout. Its other maps are the library's, of the oracle's L*a*b*.
///
/// `threads` ≥ 1 share the sets of frames. Throws std::runtime_error if a file cannot be read.
Table accuracy_table(const std::filesystem::path &data, int threads, OracleExtent extent);

/// Whether both front ends reach their floors on a few leaves. Prints those that do not.
bool accuracy_holds(int threads);

} // namespace quality
