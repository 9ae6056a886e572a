// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace quality {

/// Means over the pictures of a split; see fixations.h.
struct PhotographScores
{
  double nss = 0;
  double auc_judd = 0;
  double shuffled_auc = 0;
  double cc = 0;
};

struct PhotographRow
{
  std::string model;
  std::string split; ///< "train" or "validation"
  int pictures = 0;
  PhotographScores scores;
};

/// How well models tell where people look on photographs: the literal paper, the film profile's
/// spatial map, the profile for single pictures, each still peer that is available, and peers times
/// our weights. Rows come model by model, train before validation.
///
/// `directory` holds OSIE's pictures NUMBER.jpg of 800 × 600 and fixations.csv (Xu, Jiang, Wang,
/// Kankanhalli & Zhao 2014). Numbers that are 1 modulo 4 are for training, 3 for validation. A
/// picture goes through jpegdec into the analyzer as I420, as it does in a pipeline; peers see it
/// as B'G'R'. Every map is brought to 200 × 150, where a sample is 4 pixels, and blurred by 6
/// samples, 1 degree of visual angle; no center prior. Shuffled AUC compares with all fixations on
/// the other pictures of the split.
///
/// `threads` ≥ 1 share the pictures; the result does not depend on their number. GStreamer is
/// initialized. Throws std::runtime_error if a file is missing or not as it has to be.
std::vector<PhotographRow> score_photographs(const std::filesystem::path &directory,
                                             int threads = 2);

/// A photograph, CV_8UC3 BGR, 800 × 600. Throws std::runtime_error as above.
cv::Mat read_photograph(const std::filesystem::path &file);

} // namespace quality
