// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"

#include <cstdint>
#include <memory>

namespace quality {

enum class Title
{
  fades,   ///< in within 0.5–1 s, stands for 3–4 s, fades out
  pops,    ///< the same, at once
  credits, ///< lines that scroll up, 1/8 to 1/4 of the height per second
};

/// White text of several fonts and sizes over a picture; empty: over black.
///
/// Allowed in its cells: from when a title appears until 1 s after it stands; anywhere: while it
/// goes, and for 0.5 s after. Credits: anywhere for 1 s. Quiet: all the rest.
std::unique_ptr<CinemaFilm> title_film(Title title, const cv::Mat &picture, cv::Size size,
                                       std::uint64_t seed);

} // namespace quality
