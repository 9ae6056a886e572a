// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/profile.h"

namespace saliency {

Profile
Profile::paper()
{
  Profile profile;
  profile.exact = true;
  for (int center = 2; center <= 4; ++center)
    for (int delta = 3; delta <= 4; ++delta)
      profile.levels.push_back({ center, center + delta });
  profile.contrast_normalization = Normalization::itti;
  profile.saliency_level = 2;
  for (int center = 0; center <= 2; ++center)
    for (int delta = 3; delta <= 4; ++delta)
      profile.windows.push_back({ 1 << center, 1 << (center + delta) });
  profile.temporal_sign = TemporalSign::absolute;
  profile.time_base = TimeBase::frames;
  profile.history_start = HistoryStart::empty;
  profile.temporal_normalization = Normalization::itti;
  return profile;
}

Profile
Profile::tuned()
{
  Profile profile;
  profile.reference_width = 220;
  profile.chroma_weight = 2;
  profile.levels = { { 2, 3 } };
  profile.saliency_level = 4;
  profile.windows = { { 1, 8 }, { 2, 16 }, { 4, 32 }, { 8, 64 } };
  profile.temporal_sign = TemporalSign::onset;
  profile.temporal_mean = true;
  profile.time_base = TimeBase::seconds;
  profile.history_start = HistoryStart::filled;
  return profile;
}

Profile
Profile::tuned_spatial()
{
  Profile profile = tuned();
  profile.spatial_cue = SpatialCue::surroundedness;
  profile.levels = { { 3, 3 } };
  profile.threshold_step = 3;
  profile.area_exponent = 0.5;
  profile.saliency_level = 3;
  profile.rarity = true;
  return profile;
}

} // namespace saliency
