// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quality {

/// How much of a real film is felt. A chair that always buzzes tells nothing.
struct ClipScores
{
  int frames = 0;
  double active = 0;         ///< share of frames in which any tactor is felt
  double tactors = 0;        ///< tactors felt, as a share of the chair's nine: mean over frames
  double tactors_active = 0; ///< tactors felt at a time, [1, 9]: mean over active frames, 0 without
  double longest = 0;        ///< longest stretch without a silent frame, s
  double longest_tactor = 0; ///< the same of a single tactor
  double cues_per_minute = 0; ///< a cue is a stretch in which one tactor is felt
  double camera_moves = 0;    ///< share of frames in which the camera counts as moving
  int cuts = 0;
};

struct ClipRow
{
  std::string clip; ///< the file's name
  std::string profile;
  ClipScores scores;
};

/// What `profile=paper` and `profile=tuned` make of the films in `directory`: avi, m4v, mkv, mov,
/// mp4, mpg, ogv, ts, webm. Rows come by name, paper before tuned. Films are decoded by whatever
/// decodebin finds, converted to I420, and analyzed as saliencytactile does.
///
/// GStreamer is initialized. Throws std::runtime_error if there is no such film, or if one cannot
/// be played to its end.
std::vector<ClipRow> score_clips(const std::filesystem::path &directory);

} // namespace quality
