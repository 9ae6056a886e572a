// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"

#include <cmath>

namespace saliency {

Contrast::Contrast(double chroma_weight)
    : chroma_weight_squared_(static_cast<float>(chroma_weight * chroma_weight))
{
}

void
Contrast::operator()(const Pyramid &pyramid, LevelPair lightness, LevelPair chroma, cv::Mat &map)
{
  chroma_squared(pyramid, chroma);
  const cv::Mat &center = pyramid.level(lightness.center);
  const cv::Mat *chroma_map = &chroma_;
  if (const int octaves = chroma.center - lightness.center; octaves > 0) {
    upsample(chroma_, octaves, octaves, center.size(), chroma_upsampled_);
    chroma_map = &chroma_upsampled_;
  }
  if (chroma != lightness) {
    const int octaves = lightness.surround - lightness.center;
    upsample(pyramid.level(lightness.surround), octaves, octaves, center.size(), surround_);
  }
  map.create(center.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    const auto *c = center.ptr<cv::Vec3f>(y);
    const auto *s = surround_.ptr<cv::Vec3f>(y);
    const auto *ab = chroma_map->ptr<float>(y);
    auto *out = map.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x) {
      const float dl = c[x][0] - s[x][0];
      out[x] = std::sqrt(dl * dl + ab[x]);
    }
  }
}

/// Leaves the pair's surround in `surround_` as well.
void
Contrast::chroma_squared(const Pyramid &pyramid, LevelPair pair)
{
  const cv::Mat &center = pyramid.level(pair.center);
  const int octaves = pair.surround - pair.center;
  upsample(pyramid.level(pair.surround), octaves, octaves, center.size(), surround_);
  chroma_.create(center.size(), CV_32FC1);
  for (int y = 0; y < chroma_.rows; ++y) {
    const auto *c = center.ptr<cv::Vec3f>(y);
    const auto *s = surround_.ptr<cv::Vec3f>(y);
    auto *out = chroma_.ptr<float>(y);
    for (int x = 0; x < chroma_.cols; ++x) {
      const float da = c[x][1] - s[x][1];
      const float db = c[x][2] - s[x][2];
      out[x] = chroma_weight_squared_ * (da * da + db * db);
    }
  }
}

} // namespace saliency
