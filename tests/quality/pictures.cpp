// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pictures.h"

#include "random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace quality {

namespace {

/// Gradient of lightness across a disc, in codes.
constexpr double kSlope = 24;

/// An R'G'B' color: any lightness without overexposure, small chroma (σ 22 codes).
cv::Scalar
leaf_color(Random &random)
{
  const double gray = random.uniform(20, 190);
  const double warm = 22 * random.normal();
  const double green = 22 * random.normal() / 2;
  return { gray - warm, gray + green, gray + warm };
}

void
draw_leaf(cv::Mat &picture, cv::Point2d center, double radius, const cv::Scalar &color,
          double angle)
{
  const double reach = radius + 1;
  const int left = std::max(0, static_cast<int>(std::floor(center.x - reach)));
  const int right = std::min(picture.cols, static_cast<int>(std::ceil(center.x + reach)) + 1);
  const int top = std::max(0, static_cast<int>(std::floor(center.y - reach)));
  const int bottom = std::min(picture.rows, static_cast<int>(std::ceil(center.y + reach)) + 1);
  for (int y = top; y < bottom; ++y) {
    auto *row = picture.ptr<cv::Vec3b>(y);
    for (int x = left; x < right; ++x) {
      const double dx = x - center.x;
      const double dy = y - center.y;
      const double share = std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      if (share <= 0)
        continue;
      const double slope
          = kSlope / 2 * (dx * std::cos(angle) + dy * std::sin(angle)) / std::max(radius, 1.0);
      for (int c = 0; c < 3; ++c)
        row[x][c] = cv::saturate_cast<uchar>(row[x][c] + share * (color[c] + slope - row[x][c]));
    }
  }
}

} // namespace

cv::Mat
dead_leaves(cv::Size size, std::uint64_t seed)
{
  constexpr double kSmallest = 1.0 / 160;
  constexpr double kLargest = 1.0 / 10;
  constexpr double kCover = 12; // total area of the discs, in pictures: leaves no gaps

  Random random(seed);
  cv::Mat picture(size, CV_8UC3, cv::Scalar(128, 128, 128));
  const double area = static_cast<double>(size.width) * size.height;
  for (double covered = 0; covered < kCover * area;) {
    // Inverse of the distribution function of p(r) ~ r⁻³.
    const double u = random.uniform(0, 1);
    const double inverse = 1 / (kSmallest * kSmallest)
                           - u * (1 / (kSmallest * kSmallest) - 1 / (kLargest * kLargest));
    const double radius = size.width / std::sqrt(inverse);
    const cv::Point2d center(random.uniform(-radius, size.width + radius),
                             random.uniform(-radius, size.height + radius));
    const cv::Scalar color = leaf_color(random);
    draw_leaf(picture, center, radius, color, random.uniform(0, 2 * CV_PI));
    covered += CV_PI * radius * radius;
  }
  // Blur of a lens.
  cv::GaussianBlur(picture, picture, {}, 0.7);
  return picture;
}

} // namespace quality
