// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "estimate.h"
#include "films.h"
#include "tactile/tactile_map.h"

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
  std::vector<Mean> right; ///< in each span, for precision
  std::vector<Mean> found; ///< in each span, for recall
};

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
  std::vector<std::vector<bool>> found_; ///< for each label, for each of its half seconds
  std::vector<Mean> right_;              ///< for each label, of its felt frames
  Mean felt_;                            ///< of the judged frames
};

} // namespace quality
