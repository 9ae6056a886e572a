// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"
#include "saliency/rows.h"

#include <opencv2/core.hpp>

namespace saliency {

Contrast::Contrast(double chroma_weight)
    : chroma_weight_squared_(static_cast<float>(chroma_weight * chroma_weight))
{
}

void
Contrast::operator()(const Pyramid &pyramid, LevelPair lightness, LevelPair chroma, cv::Mat &map)
{
  const cv::Mat &center = pyramid.level(lightness.center);
  if (const int coarser = chroma.center - lightness.center; coarser > 0) {
    chroma_squared(pyramid, chroma, chroma_);
    upsample(chroma_, coarser, coarser, center.size(), map);
  } else {
    chroma_squared(pyramid, chroma, map);
  }

  const int octaves = lightness.surround - lightness.center;
  const auto width = static_cast<std::size_t>(center.cols);
  for (int y = 0; y < map.rows; ++y) {
    surround_row(pyramid.level(lightness.surround), octaves, y, 1, width);
    auto *row = map.ptr<float>(y);
    rows::contrast(center.ptr<float>(y), fine_[0].data(), row, width, row);
  }
}

/// w² (Δa² + Δb²) at the centre's resolution.
void
Contrast::chroma_squared(const Pyramid &pyramid, LevelPair pair, cv::Mat &map)
{
  const cv::Mat &center = pyramid.level(pair.center);
  const auto width = static_cast<std::size_t>(center.cols);
  map.create(center.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    surround_row(pyramid.level(pair.surround), pair.surround - pair.center, y, 3, width);
    rows::chroma_contrast(center.ptr<float>(y), fine_[1].data(), fine_[2].data(),
                          chroma_weight_squared_, width, map.ptr<float>(y));
  }
}

/// `fine_` becomes what the surround has on a row of the centre: its first channels.
void
Contrast::surround_row(const cv::Mat &surround, int octaves, int row, std::size_t channels,
                       std::size_t width)
{
  const auto length = static_cast<std::size_t>(surround.cols);
  mixed_.resize(3 * length);
  for (auto &plane : coarse_)
    plane.resize(length);
  const RowPosition at = locate_row(row, octaves, surround.rows);
  rows::interpolate(surround.ptr<float>(at.before), surround.ptr<float>(at.after), at.weight,
                    3 * length, mixed_.data());
  rows::split(mixed_.data(), length, { coarse_[0].data(), coarse_[1].data(), coarse_[2].data() });
  for (std::size_t c = 0; c < channels; ++c) {
    fine_[c].resize(width);
    rows::enlarge(coarse_[c].data(), length, octaves, width, fine_[c].data());
  }
}

} // namespace saliency
