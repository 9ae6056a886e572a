// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "labels.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace quality {

/// How much of a real film is felt. A chair that always vibrates conveys nothing.
struct ClipScores
{
  int frames = 0;
  double active = 0;          ///< share of frames in which any tactor is felt
  double tactors = 0;         ///< share of the nine tactors that are on: mean over frames
  double tactors_active = 0;  ///< tactors on at a time, 1 to 9: mean over active frames, 0 if none
  double longest = 0;         ///< longest stretch without a silent frame, s
  double longest_tactor = 0;  ///< the same for one tactor
  double cues_per_minute = 0; ///< a cue is an interval with a tactor on
  double camera_moves = 0;    ///< share of frames in which the camera counts as moving
  int cuts = 0;
};

struct ClipRow
{
  std::string clip;  ///< the file's name
  std::string model; ///< a profile or a peer
  ClipScores scores;
  std::optional<LabelScores> labels; ///< where there are labels of the clip
};

/// Analyzes the films of list_films(directory) with `profile=paper` and `profile=tuned`, as
/// saliencytactile does, decoded by decodebin to I420; those with labels by each available peer,
/// too. Rows are sorted by the clip's name; paper, tuned, then peers.
///
/// `threads` ≥ 1 share the work, and the result does not depend on their number. Requires
/// gst_init(). Throws std::runtime_error if there is no film, or if one cannot be played to its
/// end.
std::vector<ClipRow> score_clips(const std::filesystem::path &directory, int threads);

} // namespace quality
