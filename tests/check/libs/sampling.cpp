// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Interpolated sampling against plain computations in double precision, with the same bits on every
// instruction set of this CPU.
#include "saliency/sampling.h"

#include "frame/lab_image.h"

#include <hwy/targets.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using saliency::LabImage;
using saliency::Similarity;
using saliency::TexturedPoints;

namespace {

/// Widths from less than any vector to every remainder of the longest one.
constexpr int kLeastWidth = 2;
constexpr int kMostWidth = 40;
constexpr int kHeight = 9;

/// A pan, which leaves samples adjacent, and a zoom with roll, which does not.
const Similarity kMotions[] = { { 1, 0, 2.3, -0.8 }, { 1.07, 0.05, -1.2, 0.6 } };

/// Runs `check` with each instruction set. Its results must be bit-identical for all sets.
void
with_all(const std::function<std::vector<float>()> &check)
{
  const auto targets = hwy::SupportedTargets();
  std::vector<float> first;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::GetChosenTarget().Update(target);
    const auto found = check();
    if (first.empty())
      first = found;
    fail_unless(found == first, "%s differs", hwy::TargetName(target));
    hwy::GetChosenTarget().Update(targets);
  }
}

/// Images have their exact size, so a sanitizer sees overruns.
cv::Mat
random_image(cv::Size size, std::mt19937 &generator)
{
  std::uniform_real_distribution<float> value(0, 20);
  cv::Mat image(size, CV_32FC1);
  for (std::size_t i = 0; i < image.total(); ++i)
    image.ptr<float>()[i] = value(generator);
  return image;
}

LabImage
random_lab(cv::Size size, unsigned seed)
{
  std::mt19937 generator(seed);
  LabImage lab;
  for (cv::Mat &plane : lab.planes)
    plane = random_image(size, generator);
  return lab;
}

bool
is_inside(const cv::Mat &image, double x, double y)
{
  return x >= 0 && y >= 0 && x < image.cols - 1 && y < image.rows - 1;
}

/// Whether rounding may decide if a place is inside.
bool
is_at_edge(const cv::Mat &image, double x, double y)
{
  const auto near = [](double a, double b) {
    return std::abs(a - b) < 1e-4;
  };
  return near(x, 0) || near(y, 0) || near(x, image.cols - 1) || near(y, image.rows - 1);
}

double
value_at(const cv::Mat &image, double x, double y)
{
  const int left = std::min(static_cast<int>(x), image.cols - 2);
  const int top = std::min(static_cast<int>(y), image.rows - 2);
  double sum = 0;
  for (const int row : { top, top + 1 })
    for (const int column : { left, left + 1 })
      sum += static_cast<double>(image.at<float>(row, column)) * (1 - std::abs(x - column))
             * (1 - std::abs(y - row));
  return sum;
}

/// Points all over an image and beyond it.
TexturedPoints
random_points(int count, cv::Size size, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> share(0, 1);
  TexturedPoints points;
  for (int i = 0; i < count; ++i) {
    std::array<float, TexturedPoints::kParameters> change{};
    for (float &by : change)
      by = 6 * share(generator) - 3;
    points.add(share(generator) * static_cast<float>(size.width),
               share(generator) * static_cast<float>(size.height), 20 * share(generator), change);
  }
  points.finish();
  return points;
}

} // namespace

CHECK_TEST(test_shift_equations)
{
  constexpr float kScale = 4;
  const cv::Size size(kMostWidth, kHeight);
  const cv::Mat image = random_lab(size, 1).lightness();
  for (const int count : { 1, 15, 16, 17, 90 })
    for (const Similarity &motion : kMotions)
      with_all([&] {
        const auto points = random_points(count, size, static_cast<unsigned>(count));
        const auto &dx = points.change[TexturedPoints::kShiftX];
        const auto &dy = points.change[TexturedPoints::kShiftY];
        std::size_t inside = 0;
        std::array<double, 5> sums{};
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double x = motion.x(points.x[i], points.y[i]);
          const double y = motion.y(points.x[i], points.y[i]);
          if (!is_inside(image, x, y))
            continue;
          ++inside;
          const double residual = value_at(image, x, y) - points.lightness[i];
          const double weight = std::pow(1 + residual * residual / (kScale * kScale), -2);
          const double terms[]
              = { dx[i] * dx[i], dx[i] * dy[i], dy[i] * dy[i], dx[i] * residual, dy[i] * residual };
          for (std::size_t k = 0; k < sums.size(); ++k)
            sums[k] += weight * terms[k];
        }
        const auto found = saliency::shift_equations(image, motion, points, kScale);
        ck_assert_uint_eq(found.points, inside);
        const std::array values{ found.xx, found.xy, found.yy, found.x, found.y };
        for (std::size_t k = 0; k < sums.size(); ++k)
          fail_unless_near(values[k], sums[k], 2e-3);
        return std::vector<float>(values.begin(), values.end());
      });
}

CHECK_TEST(test_warp)
{
  for (int width = kLeastWidth; width <= kMostWidth; ++width)
    for (const Similarity &motion : kMotions) {
      const cv::Mat image = random_lab({ width, kHeight }, 4).planes[0];
      with_all([&] {
        cv::Mat warped;
        saliency::warp(image, motion, warped);
        std::vector<float> found;
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < width; ++x) {
            const double at_x = motion.x(x, y);
            const double at_y = motion.y(x, y);
            const float value = warped.at<float>(y, x);
            found.push_back(std::isnan(value) ? -1000 : value);
            if (is_at_edge(image, at_x, at_y))
              continue;
            if (is_inside(image, at_x, at_y))
              fail_unless_near(value, value_at(image, at_x, at_y), 2e-4);
            else
              fail_unless(std::isnan(value));
          }
        return found;
      });
    }
}

CHECK_MAIN(sampling)
