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

/// Where people looked, in samples of a map of which sample i covers [i, i + 1).
using Fixations = std::vector<cv::Point2d>;

/// The fixations of all subjects on each picture, by file name, in pixels of the picture. The file
/// is CSV with the head "image,subject,x,y"; every position lies in [0, width] × [0, height] of
/// `picture`. Throws std::runtime_error that names file, line and what was expected; so it does for
/// files beyond 64 MiB and for names that are more than a file name.
std::map<std::string, Fixations> read_fixations(const std::filesystem::path &file,
                                                cv::Size picture);

// How well a map tells where people looked; Bylinskii, Judd, Oliva, Torralba & Durand (2019), "What
// do different evaluation metrics tell us about saliency models?". A map is CV_32FC1, finite, not
// empty; positions outside count for the nearest sample. A fixation's value is that of the sample
// in which it lies, and each fixation counts, several in one sample too. At least one fixation.

/// Normalized scanpath saliency (Peters, Iyer, Itti & Koch 2005): mean of (map - mean of map) /
/// standard deviation of map over the fixations. A flat map scores 0.
double nss(const cv::Mat &map, std::span<const cv::Point2d> fixations);

/// AUC-Judd (Judd, Ehinger, Durand & Torralba 2009): the area under the curve of fixations against
/// samples without fixation above a threshold, that is the probability that a fixation's value is
/// above that of a sample without one; ties count one half. A flat map scores ½, as does one whose
/// every sample is fixated.
double auc_judd(const cv::Mat &map, std::span<const cv::Point2d> fixations);

/// Shuffled AUC (Tatler, Baddeley & Gilchrist 2005; Zhang, Tong, Marks, Shan & Cottrell 2008): the
/// probability that a fixation's value is above that at a place where people looked on another
/// picture, so a center prior gains nothing; ties count one half. Instead of random draws all
/// `others` (at least one) are compared.
double shuffled_auc(const cv::Mat &map, std::span<const cv::Point2d> fixations,
                    std::span<const cv::Point2d> others);

/// Number of fixations in each sample, blurred by a Gaussian of `sigma` > 0 samples. CV_32FC1.
cv::Mat fixation_density(cv::Size size, std::span<const cv::Point2d> fixations, double sigma);

/// Pearson's correlation coefficient of two maps of one size; 0 if either is flat.
double correlation(const cv::Mat &map, const cv::Mat &density);

} // namespace quality
