// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "labels.h"

#include <array>
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
  std::string clip;    ///< the file's name
  bool unseen = false; ///< no constant was chosen on the film: its labels lie in the folder unseen
  std::string model;   ///< a profile or a peer
  ClipScores scores;
  std::optional<LabelScores> labels; ///< where there are labels of the clip
};

/// The sensitivities at which ours is scored, the default first.
inline constexpr std::array kSensitivities{ 1.0, 0.5, 0.7, 1.4, 2.0 };

/// The model of score_clips() that is ours at a sensitivity.
std::string model_at(double sensitivity);

/// Ours without the detection of faces.
inline constexpr const char *kWithoutPeople = "tuned, people=off";

/// The model of fitted_elsewhere().
inline constexpr const char *kFitted = "tuned, fitted on the other films";

/// Leaves one film out: for each film with labels, ours at the sensitivity that is best on all the
/// other films.
std::vector<ClipRow> fitted_elsewhere(const std::vector<ClipRow> &rows);

/// Tracks that any method made of films: DIRECTORY/FILM.csv, as tactile-track writes them, for each
/// film that is to be judged.
struct Method
{
  std::string name;
  std::filesystem::path tracks;
};

/// Which models score_clips() compares.
enum class Contenders
{
  ours, ///< `profile=tuned` alone, at kSensitivities, and without people
  all,
};

struct ClipSet
{
  std::filesystem::path films;  ///< those of list_films(), and of its folder `unseen`
  std::filesystem::path labels; ///< FILM.csv, here or in its folder `unseen`
  std::vector<Method> methods{};
};

/// Analyzes the films with `profile=paper` and `profile=tuned`, as saliencytactile does, decoded by
/// decodebin to I420; those with labels by each available peer, too: as it is, and silent but for
/// as many of its strongest frames as `tuned` is felt ("same share"). "center, same frames" is felt
/// where `tuned` is, in the middle cell alone. Rows are sorted by the clip's name; paper, tuned,
/// peers, then methods.
///
/// `threads` ≥ 1 share the work, and the result does not depend on their number. Requires
/// gst_init(). Throws std::runtime_error if there is no film, if one cannot be played to its end,
/// or if a track cannot be read.
std::vector<ClipRow> score_clips(const ClipSet &set, Contenders contenders, int threads);

} // namespace quality
