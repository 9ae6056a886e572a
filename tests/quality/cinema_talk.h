// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"

#include <cstdint>
#include <memory>

namespace quality {

/// A person from the chest up who talks in phrases of 1.5–3 s: the mouth opens and closes at
/// 3–5 Hz, the head nods a little, eyes blink, the hands rest. With `listener`, a second one is
/// silent and nods as much. Before a blurred picture.
///
/// Felt in the cells of the talker's face: from the first phrase on. Allowed anywhere: before.
std::unique_ptr<CinemaFilm> talking_film(bool listener, const cv::Mat &picture, cv::Size size,
                                         std::uint64_t seed);

} // namespace quality
