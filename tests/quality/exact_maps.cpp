// SPDX-License-Identifier: LGPL-2.1-or-later
#include "exact_maps.h"

#include "support/saliency_oracle.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace quality {

namespace {

cv::Mat
samples(const saliency::Component &component)
{
  cv::Mat plane(component.height, component.width, CV_64FC1);
  for (int y = 0; y < plane.rows; ++y)
    for (int x = 0; x < plane.cols; ++x)
      plane.at<double>(y, x)
          = component.data[y * component.row_stride + x * component.pixel_stride];
  return plane;
}

/// Linear interpolation on the pyramid's grid, the last sample repeated. CV_64FC1.
cv::Mat
upsampled(const cv::Mat &image, int octaves_x, int octaves_y, cv::Size size)
{
  if (octaves_x == 0 && octaves_y == 0)
    return image;
  const double step_x = std::ldexp(1.0, octaves_x);
  const double step_y = std::ldexp(1.0, octaves_y);
  cv::Mat fine(size, CV_64FC1);
  for (int y = 0; y < size.height; ++y) {
    const double at_y = std::min(y / step_y, image.rows - 1.0);
    const int y0 = static_cast<int>(at_y);
    const auto *above = image.ptr<double>(y0);
    const auto *below = image.ptr<double>(std::min(y0 + 1, image.rows - 1));
    for (int x = 0; x < size.width; ++x) {
      const double at_x = std::min(x / step_x, image.cols - 1.0);
      const int x0 = static_cast<int>(at_x);
      const int x1 = std::min(x0 + 1, image.cols - 1);
      const double fx = at_x - x0;
      const double fy = at_y - y0;
      fine.at<double>(y, x) = (1 - fy) * ((1 - fx) * above[x0] + fx * above[x1])
                              + fy * ((1 - fx) * below[x0] + fx * below[x1]);
    }
  }
  return fine;
}

cv::Mat
lab_of(const std::array<cv::Mat, 3> &components, const saliency::FrameView &frame, int threads)
{
  cv::Mat lab(components[0].size(), CV_64FC3);
  const auto band = [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < lab.cols; ++x) {
        const auto value = oracle::samples_to_lab(
            { components[0].at<double>(y, x), components[1].at<double>(y, x),
              components[2].at<double>(y, x) },
            frame.model, frame.depth, frame.full_range, frame.matrix);
        lab.at<cv::Vec3d>(y, x) = { value[0], value[1], value[2] };
      }
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i)
    helpers.emplace_back(band, lab.rows * i / threads, lab.rows * (i + 1) / threads);
  band(0, lab.rows / threads);
  helpers.clear();
  return lab;
}

int
octaves_between(int fine, int coarse)
{
  if (coarse == fine)
    return 0;
  if (coarse == (fine + 1) / 2)
    return 1;
  throw std::invalid_argument("chroma has all samples or half of them");
}

/// The components, each as large as the frame.
std::array<cv::Mat, 3>
components_of(const saliency::FrameView &frame)
{
  if (frame.depth != 8 || frame.model == saliency::ColorModel::gray)
    throw std::invalid_argument("expected three components of 8 bits");
  std::array<cv::Mat, 3> components;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &component = frame.components[i];
    const int columns = octaves_between(frame.width, component.width);
    const int rows = octaves_between(frame.height, component.height);
    components[i] = samples(component);
    if (std::max(columns, rows) > 0)
      components[i] = upsampled(components[i], columns, rows, { frame.width, frame.height });
  }
  return components;
}

} // namespace

cv::Mat
exact_lab(const saliency::FrameView &frame, int threads)
{
  return lab_of(components_of(frame), frame, threads);
}

cv::Mat
decimated(cv::Mat image, int octaves)
{
  for (int i = 0; i < octaves; ++i) {
    cv::Mat half;
    cv::pyrDown(image, half, { (image.cols + 1) / 2, (image.rows + 1) / 2 });
    image = half;
  }
  return image;
}

cv::Mat
exact_spatial_saliency(const cv::Mat &lab, const saliency::FrameLevels &levels,
                       const saliency::Profile &profile)
{
  std::vector<std::array<cv::Mat, 3>> pyramid(static_cast<std::size_t>(levels.coarsest) + 1);
  cv::Mat level_lab = lab;
  for (int n = levels.finest; n <= levels.coarsest; ++n) {
    cv::split(level_lab, pyramid[static_cast<std::size_t>(n)].data());
    level_lab = decimated(level_lab, 1);
  }
  const auto difference_squared = [&](saliency::LevelPair pair, std::size_t channel) -> cv::Mat {
    const cv::Mat &center = pyramid[static_cast<std::size_t>(pair.center)][channel];
    const int octaves = pair.surround - pair.center;
    const cv::Mat difference
        = center
          - upsampled(pyramid[static_cast<std::size_t>(pair.surround)][channel], octaves, octaves,
                      center.size());
    return difference.mul(difference);
  };

  cv::Mat sum;
  for (std::size_t i = 0; i < levels.pairs.size(); ++i) {
    const auto lightness = levels.pairs[i];
    const auto chroma = levels.chroma[i];
    const cv::Mat chroma_squared
        = profile.chroma_weight * profile.chroma_weight
          * (difference_squared(chroma, 1) + difference_squared(chroma, 2));
    cv::Mat map = difference_squared(lightness, 0);
    const int octaves = chroma.center - lightness.center;
    map += upsampled(chroma_squared, octaves, octaves, map.size());
    cv::sqrt(map, map);
    map = decimated(map, levels.saliency - lightness.center);
    sum = sum.empty() ? map : sum + map;
  }
  return profile.contrast_mean ? sum / static_cast<double>(levels.pairs.size()) : sum;
}

} // namespace quality
