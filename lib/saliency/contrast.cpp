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
  const cv::Mat &center = pyramid.level(lightness.center).lightness();
  if (const int coarser = chroma.center - lightness.center; coarser > 0) {
    chroma_squared(pyramid, chroma, chroma_);
    upsample(chroma_, coarser, coarser, center.size(), map);
  } else {
    chroma_squared(pyramid, chroma, map);
  }

  const cv::Mat &surround = pyramid.level(lightness.surround).lightness();
  const int octaves = lightness.surround - lightness.center;
  for (int y = 0; y < map.rows; ++y) {
    auto *row = map.ptr<float>(y);
    rows::contrast(center.ptr<float>(y), surround_row(surround, octaves, y, map.cols, fine_[0]),
                   row, static_cast<std::size_t>(map.cols), row);
  }
}

/// w² (Δa² + Δb²) at the centre's resolution.
void
Contrast::chroma_squared(const Pyramid &pyramid, LevelPair pair, cv::Mat &map)
{
  const auto &[lightness, a, b] = pyramid.level(pair.center).planes;
  const auto &surround = pyramid.level(pair.surround).planes;
  const int octaves = pair.surround - pair.center;
  map.create(a.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y)
    rows::chroma_contrast({ a.ptr<float>(y), b.ptr<float>(y) },
                          { surround_row(surround[1], octaves, y, map.cols, fine_[0]),
                            surround_row(surround[2], octaves, y, map.cols, fine_[1]) },
                          chroma_weight_squared_, static_cast<std::size_t>(map.cols),
                          map.ptr<float>(y));
}

/// What a plane of the surround has on a row of the centre, which is `width` wide.
const float *
Contrast::surround_row(const cv::Mat &surround, int octaves, int row, int width,
                       std::vector<float> &fine)
{
  const auto length = static_cast<std::size_t>(surround.cols);
  mixed_.resize(length);
  fine.resize(static_cast<std::size_t>(width));
  const RowPosition at = locate_row(row, octaves, surround.rows);
  rows::interpolate(surround.ptr<float>(at.before), surround.ptr<float>(at.after), at.weight,
                    length, mixed_.data());
  rows::enlarge(mixed_.data(), length, octaves, fine.size(), fine.data());
  return fine.data();
}

} // namespace saliency
