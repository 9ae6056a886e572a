// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace quality {

/// A gaze position in samples of a map, where sample i covers [i, i + 1).
using Fixations = std::vector<cv::Point2d>;

/// The fixations on each picture, by its file name, and of each subject, in pixels. The file is CSV
/// with the header "image,subject,x,y". Positions are in [0, width] × [0, height] of `picture`.
/// Throws std::runtime_error with file, line and what was expected, also for files above 64 MiB and
/// for names with a path.
std::map<std::string, std::map<std::string, Fixations>>
read_fixations(const std::filesystem::path &file, cv::Size picture);

// How well a map predicts fixations: Bylinskii, Judd, Oliva, Torralba & Durand (2019), "What do
// different evaluation metrics tell us about saliency models?". A map is CV_32FC1, finite and not
// empty. A fixation has the value of its sample, or of the nearest one if it is outside. Several
// fixations in a sample all count. There is at least one.

/// Normalized scanpath saliency (Peters, Iyer, Itti & Koch 2005): mean of (map - mean of map) /
/// standard deviation of map over the fixations. A flat map scores 0.
double nss(const cv::Mat &map, std::span<const cv::Point2d> fixations);

/// AUC-Judd (Judd, Ehinger, Durand & Torralba 2009): the area under the ROC curve, which is the
/// probability that a fixation's value exceeds that of a sample without fixation. Ties count ½. A
/// flat map scores ½, as does a map with fixations in every sample.
double auc_judd(const cv::Mat &map, std::span<const cv::Point2d> fixations);

/// Shuffled AUC (Tatler, Baddeley & Gilchrist 2005; Zhang, Tong, Marks, Shan & Cottrell 2008): the
/// probability that a fixation's value exceeds that at a fixation on another picture. A center
/// prior gains nothing. Ties count ½. All `others` (at least one) are compared, without random
/// draws.
double shuffled_auc(const cv::Mat &map, std::span<const cv::Point2d> fixations,
                    std::span<const cv::Point2d> others);

/// Number of fixations in each sample, blurred by a Gaussian of `sigma` samples if that is > 0.
/// CV_32FC1.
cv::Mat fixation_density(cv::Size size, std::span<const cv::Point2d> fixations, double sigma);

/// Pearson's correlation coefficient of two maps of one size; 0 if either is flat.
double correlation(const cv::Mat &map, const cv::Mat &density);

} // namespace quality
