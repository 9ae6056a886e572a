// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Interpolated sampling against plain computations in double precision, with the same bits on every
// instruction set of this CPU.
#include "saliency/sampling.h"

#include <hwy/targets.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "support/tolerance.h"

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

GST_START_TEST(test_shift_equations)
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
GST_END_TEST;

GST_START_TEST(test_novelty)
{
  constexpr saliency::NoveltyScale kScale{ .noise = 2, .least_gradient = 1.5, .most = 3 };
  constexpr double kBelow = 0.3;
  for (int width = kLeastWidth; width <= kMostWidth; ++width)
    for (const Similarity &motion : kMotions) {
      const cv::Size size(width, kHeight);
      const LabImage now = random_lab(size, 1);
      const LabImage then = random_lab(size, 2);
      const LabImage mesh = random_lab({ width, 2 }, 3); // x and y above and below
      const auto by = [&](std::size_t plane, int x) {
        const cv::Mat &m = mesh.planes[plane];
        return (1 - kBelow) * m.at<float>(0, x) / 8 + kBelow * m.at<float>(1, x) / 8;
      };
      const cv::Mat by_x = mesh.planes[0] / 8;
      const cv::Mat by_y = mesh.planes[1] / 8;
      with_all([&] {
        std::vector<float> all;
        std::vector<float> row(static_cast<std::size_t>(width));
        for (int y = 0; y < kHeight; ++y) {
          saliency::novelty(now, then, motion,
                            { .x = { by_x.ptr<float>(0), by_x.ptr<float>(1) },
                              .y = { by_y.ptr<float>(0), by_y.ptr<float>(1) },
                              .weight = static_cast<float>(kBelow) },
                            y, kScale, row.data());
          for (int x = 0; x < width; ++x) {
            const double at_x = motion.x(x - by(0, x), y - by(1, x));
            const double at_y = motion.y(x - by(0, x), y - by(1, x));
            if (is_at_edge(then.planes[0], at_x, at_y))
              continue;
            double expected = 0;
            if (is_inside(then.planes[0], at_x, at_y)) {
              double residual = 0;
              double gradient = 0;
              for (std::size_t c = 0; c < 3; ++c) {
                const auto at = [&plane = now.planes[c]](int column, int line) {
                  return static_cast<double>(plane.at<float>(
                      std::clamp(line, 0, plane.rows - 1), std::clamp(column, 0, plane.cols - 1)));
                };
                residual += std::pow(at(x, y) - value_at(then.planes[c], at_x, at_y), 2);
                gradient += std::pow((at(x + 1, y) - at(x - 1, y)) / 2, 2)
                            + std::pow((at(x, y + 1) - at(x, y - 1)) / 2, 2);
              }
              expected = std::min(3.0, std::max(0.0, std::sqrt(residual) - 2)
                                           / (std::sqrt(gradient) + 1.5));
            }
            fail_unless_near(row[static_cast<std::size_t>(x)], expected, 2e-4);
          }
          all.insert(all.end(), row.begin(), row.end());
        }
        return all;
      });
    }
}
GST_END_TEST;

GST_START_TEST(test_add_sampled)
{
  constexpr float kBorder = 1;
  constexpr float kLength = 1.7F;
  for (int width = kLeastWidth; width <= kMostWidth; ++width)
    for (const Similarity &motion : kMotions) {
      const cv::Size size(width, kHeight);
      const LabImage images = random_lab(size, 4);
      const auto &[image, now, before] = images.planes;
      with_all([&] {
        cv::Mat sum = before.clone();
        saliency::add_sampled(image, motion, kBorder, now, kLength, sum);
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < width; ++x) {
            const double at_x = motion.x(x, y);
            const double at_y = motion.y(x, y);
            const cv::Mat within(size - cv::Size(2, 2), CV_32FC1);
            if (is_at_edge(within, at_x - kBorder, at_y - kBorder))
              continue;
            double expected = before.at<float>(y, x);
            if (is_inside(within, at_x - kBorder, at_y - kBorder))
              expected += value_at(image, at_x, at_y)
                          - static_cast<double>(kLength) * now.at<float>(y, x);
            fail_unless_near(sum.at<float>(y, x), expected, 2e-4);
          }
        return std::vector<float>(sum.ptr<float>(), sum.ptr<float>() + sum.total());
      });
    }
}
GST_END_TEST;

static Suite *
sampling_suite(void)
{
  Suite *suite = suite_create("sampling");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_shift_equations);
  tcase_add_test(tc, test_novelty);
  tcase_add_test(tc, test_add_sampled);
  return suite;
}

GST_CHECK_MAIN(sampling);
