// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace quality {

/// Of a picture, or means over pictures. See fixations.h.
struct PhotographScores
{
  double nss = 0;
  double auc_judd = 0;
  double shuffled_auc = 0;
  double cc = 0;
  // What is felt on a chair of 3 × 3 tactors.
  double cell_right = 0; ///< the strongest cell is the one that people look at most: share
  double cell_cc = 0;    ///< correlation of the levels with the share of fixations in each cell
  double felt_nss = 0;   ///< NSS of the levels, each of which holds in all of its cell
};

struct PhotographRow
{
  std::string model;
  std::string split;                      ///< "train" or "validation"
  std::vector<PhotographScores> pictures; ///< of each

  PhotographScores mean() const;
};

/// How well models predict fixations on photographs: the paper profile, the tuned profile's spatial
/// map, the profile for single pictures with and without the detector of faces if it works, each
/// available peer for stills, and peers times our weights; and people, of whom one half predicts
/// the other, both ways. Rows are grouped by model, train before validation.
///
/// `directory` holds OSIE's pictures NUMBER.jpg of 800 × 600 and fixations.csv (Xu, Jiang, Wang,
/// Kankanhalli & Zhao 2014). Numbers that are 1 modulo 4 are for training, 3 for validation.
/// jpegdec decodes pictures to I420 for the analyzer, as in a pipeline, and to B'G'R' for peers.
/// All maps are scaled to 200 × 150 (4 pixels per sample) and blurred by 6 samples (1 degree of
/// visual angle), without center prior. Shuffled AUC uses all fixations on the other pictures of
/// the split.
///
/// `threads` ≥ 1 share the pictures, and the result does not depend on their number. Requires
/// gst_init(). Throws std::runtime_error if a file is missing or invalid.
std::vector<PhotographRow> score_photographs(const std::filesystem::path &directory,
                                             int threads = 2);

/// A photograph, CV_8UC3 BGR, 800 × 600. Throws std::runtime_error as above.
cv::Mat read_photograph(const std::filesystem::path &file);

} // namespace quality
