// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "estimate.h"
#include "films.h"
#include "tactile/tactile_map.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace quality {

enum class Verdict
{
  felt,    ///< something happens: silence misses it
  allowed, ///< may be felt
  quiet,   ///< nothing is to be felt
};

/// What a person would expect to feel during [start, end) of a film, on 3 × 3 tactors.
struct Label
{
  Time start{ 0 };
  Time end{ 0 };
  Verdict verdict = Verdict::allowed;
  std::vector<bool> cells; ///< nine, row by row: where it is
  bool anywhere = false;   ///< all of them
  int strength = 0;        ///< 1 a gesture, 2 a movement, 3 a blow, a jump, a fall; 0: none is told
  std::string what;        ///< what is seen
};

/// Reads labels as tests/quality/labels/README.md describes them. Spans come in order, without gaps
/// or overlaps. Throws std::runtime_error that names file, line and what was expected.
std::vector<Label> read_labels(const std::filesystem::path &file);

struct LabelScores
{
  double felt = 0;      ///< share of the judged frames that are felt
  double precision = 0; ///< of these, those whose strongest cell is right; 1 if none is felt
  double recall = 0;    ///< share of the half seconds to be felt that have a right frame; 1 if none
  double quiet_felt = 0;   ///< share of the frames felt in which nothing is to be felt
  double full = 0;         ///< share of the felt frames whose strongest level is above 0.9
  std::vector<Mean> right; ///< in each span, for precision
  std::vector<Mean> found; ///< in each span, for recall
  std::vector<Mean> quiet; ///< in each span, for quiet_felt
  /// In each span with cells, how much better than chance the strongest cells of its felt frames
  /// are: 0 if as often right as those of the film in any order, 1 if always. A method with one
  /// favorite cell scores 0.
  std::vector<Mean> place;
  /// For each of three strengths, the level of each of its spans to be felt: the upper quartile of
  /// its frames' strongest levels, silent ones too.
  std::array<std::vector<double>, 4> levels;
};

/// Whether strong events feel stronger than weak ones: for each level of `strong`, the share of
/// those of `weak` that are below it, equal ones half.
std::vector<Mean> above(const std::vector<double> &strong, const std::vector<double> &weak);

/// Compares what is felt of a film with its labels.
class LabelJudge
{
public:
  explicit LabelJudge(std::vector<Label> labels);

  /// The next frame, shown from `time` on. Frames beyond the last label are left out.
  void frame(Time time, const tactile::TactileMap &map);

  LabelScores scores() const;

private:
  std::vector<Label> labels_;
  std::vector<std::vector<bool>> found_;      ///< for each label, for each of its half seconds
  std::vector<Mean> right_;                   ///< for each label, of its felt frames
  std::vector<Mean> quiet_;                   ///< for each label, of its quiet frames
  std::vector<std::array<int, 9>> favorites_; ///< for each label, its frames' strongest cells
  std::vector<std::vector<double>> levels_;   ///< for each label, of its frames
  Mean felt_;                                 ///< of the judged frames
  Mean full_;                                 ///< of the felt frames
};

} // namespace quality
