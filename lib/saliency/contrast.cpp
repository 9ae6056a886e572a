// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"
#include "saliency/rows.h"

#include <opencv2/core.hpp>

#include <algorithm>

namespace saliency {

Contrast::Contrast(double chroma_weight)
    : chroma_weight_squared_(static_cast<float>(chroma_weight * chroma_weight))
{
}

void
Contrast::operator()(const Pyramid &pyramid, LevelPair lightness, LevelPair chroma, cv::Mat &map,
                     const Team &team)
{
  fine_.resize(static_cast<std::size_t>(team.threads()));
  const cv::Mat &colored = chroma_squared(pyramid, chroma, team);
  const cv::Mat &center = pyramid.level(lightness.center).lightness();
  const cv::Mat &surround = pyramid.level(lightness.surround).lightness();
  map.create(center.size(), CV_32FC1);
  team.share(map.rows, [&](int part, int begin, int end) {
    auto &fine = fine_[static_cast<std::size_t>(part)];
    for (int y = begin; y < end; ++y)
      rows::contrast(
          center.ptr<float>(y),
          enlarged(surround, lightness.surround - lightness.center, y, map.cols, fine[0]),
          enlarged(colored, chroma.center - lightness.center, y, map.cols, fine[1]),
          static_cast<std::size_t>(map.cols), map.ptr<float>(y));
  });
}

/// w² (Δa² + Δb²) at the resolution of pair.center.
const cv::Mat &
Contrast::chroma_squared(const Pyramid &pyramid, LevelPair pair, const Team &team)
{
  const cv::Mat &a = pyramid.level(pair.center).planes[1];
  const cv::Mat &b = pyramid.level(pair.center).planes[2];
  const auto &surround = pyramid.level(pair.surround).planes;
  const int octaves = pair.surround - pair.center;
  chroma_.resize(std::max(chroma_.size(), static_cast<std::size_t>(pair.center) + 1));
  cv::Mat &map = chroma_[static_cast<std::size_t>(pair.center)];
  map.create(a.size(), CV_32FC1);
  team.share(a.rows, [&](int part, int begin, int end) {
    auto &fine = fine_[static_cast<std::size_t>(part)];
    for (int y = begin; y < end; ++y)
      rows::chroma_contrast({ a.ptr<float>(y), b.ptr<float>(y) },
                            { enlarged(surround[1], octaves, y, a.cols, fine[0]),
                              enlarged(surround[2], octaves, y, a.cols, fine[1]) },
                            chroma_weight_squared_, static_cast<std::size_t>(a.cols),
                            map.ptr<float>(y));
  });
  return map;
}

/// Row `row` of a plane interpolated to a level finer by `octaves`, `width` samples wide.
const float *
Contrast::enlarged(const cv::Mat &plane, int octaves, int row, int width, std::vector<float> &fine)
{
  if (octaves == 0)
    return plane.ptr<float>(row);
  fine.resize(static_cast<std::size_t>(width));
  rows::enlarge(between_rows(plane, row, octaves), octaves, fine.size(), fine.data());
  return fine.data();
}

} // namespace saliency
