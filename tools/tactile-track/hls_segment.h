// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/track.h"

#include <cstdint>
#include <string>

namespace hls {

/// The cues of a stretch of the film as a segment of WebVTT. `start` is the time stamp of 0:00 in
/// 90 000 Hz. A cue beyond the end is cut, so that each part is played once.
std::string segment_text(const std::deque<tactile::Cue> &cues, const tactile::Track &track,
                         std::int64_t start, tactile::Time begin, tactile::Time end);

} // namespace hls
