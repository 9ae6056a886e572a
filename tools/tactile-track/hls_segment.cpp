// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hls_segment.h"

#include "tracks/formats/webvtt_timing.h"
#include "tracks/text_cue.h"

#include <algorithm>

namespace hls {

std::string
segment_text(const std::deque<tactile::Cue> &cues, const tactile::Track &track, std::int64_t start,
             tactile::Time begin, tactile::Time end)
{
  std::string text = "WEBVTT\nX-TIMESTAMP-MAP=MPEGTS:" + std::to_string(start)
                     + ",LOCAL:00:00:00.000\n\nNOTE tactile "
                     + tactile::write_grid({ track.rows(), track.columns() }, track.rate()) + "\n";
  const auto ms = [](tactile::Time time) {
    return std::chrono::floor<std::chrono::milliseconds>(time);
  };
  const auto first = std::ranges::upper_bound(cues, begin, {}, &tactile::Cue::end);
  for (auto cue = first; cue != cues.end() && cue->begin < end; ++cue) {
    const tactile::Time from = ms(std::max(cue->begin, begin));
    const tactile::Time to = ms(std::min(cue->end, end));
    if (from < to)
      text += "\n" + tactile::write_webvtt_timing(from, to) + "\n"
              + tactile::write_text_cue(cue->map) + "\n";
  }
  return text;
}

} // namespace hls
