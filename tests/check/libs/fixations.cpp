// SPDX-License-Identifier: LGPL-2.1-or-later
#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "quality/fixations.h"
#include "support/temporary_file.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using quality::Fixations;

namespace {

cv::Mat
random_map(int width, int height, int values, std::mt19937 &generator)
{
  std::uniform_int_distribution<int> value(0, values - 1);
  cv::Mat map(height, width, CV_32FC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      map.at<float>(y, x) = 0.25F * static_cast<float>(value(generator));
  return map;
}

Fixations
random_fixations(int width, int height, int count, std::mt19937 &generator)
{
  std::uniform_real_distribution<double> x(0, width);
  std::uniform_real_distribution<double> y(0, height);
  Fixations fixations;
  for (int i = 0; i < count; ++i)
    fixations.emplace_back(x(generator), y(generator));
  return fixations;
}

double
value(const cv::Mat &map, cv::Point2d at)
{
  return map.at<float>(static_cast<int>(at.y), static_cast<int>(at.x));
}

double
wins(double positive, double negative)
{
  return positive > negative ? 1 : positive == negative ? 0.5 : 0;
}

/// The error of read_fixations(), empty if the file is read.
std::string
complaint(const std::filesystem::path &file)
{
  try {
    quality::read_fixations(file, { 800, 600 });
  } catch (const std::runtime_error &error) {
    return error.what();
  }
  return {};
}

} // namespace

CHECK_TEST(test_closed_forms)
{
  // Ones on a quarter of the map: mean 1/4, deviation √3/4.
  cv::Mat map = cv::Mat::zeros(20, 40, CV_32FC1);
  map(cv::Rect(0, 0, 10, 20)).setTo(1);
  const Fixations inside{ { 0, 0 }, { 9.9, 19.9 }, { 5, 5 } };
  const Fixations outside{ { 10, 0 }, { 39, 19 } };
  fail_unless_near(quality::nss(map, inside), std::sqrt(3.0), 1e-6);
  fail_unless_near(quality::nss(map, outside), -1 / std::sqrt(3.0), 1e-6);
  fail_unless_near(quality::shuffled_auc(map, inside, outside), 1, 0);
  fail_unless_near(quality::shuffled_auc(map, outside, inside), 0, 0);
  fail_unless_near(quality::shuffled_auc(map, inside, inside), 0.5, 0);
  // 3 of the 800 samples are fixated, all of them among the 200 ones. The other 197 ones tie.
  fail_unless_near(quality::auc_judd(map, inside), (600 + 0.5 * 197) / 797, 1e-12);
  fail_unless_near(quality::correlation(map, map), 1, 1e-6);
  fail_unless_near(quality::correlation(map, 3 - 2 * map), -1, 1e-6);

  // A position outside the map counts as its nearest sample.
  const Fixations off{ { -3, 5 }, { -1e9, 1e9 } };
  fail_unless_near(quality::nss(map, off), std::sqrt(3.0), 1e-6);
}

CHECK_TEST(test_flat_map)
{
  const cv::Mat map(20, 40, CV_32FC1, cv::Scalar(0.3));
  const Fixations fixations{ { 1, 1 }, { 7, 9 } };
  fail_unless_near(quality::nss(map, fixations), 0, 0);
  fail_unless_near(quality::auc_judd(map, fixations), 0.5, 0);
  fail_unless_near(quality::shuffled_auc(map, fixations, fixations), 0.5, 0);
  fail_unless_near(quality::correlation(map, quality::fixation_density(map.size(), fixations, 2)),
                   0, 0);
  fail_unless_near(quality::auc_judd(cv::Mat::ones(1, 1, CV_32FC1), fixations), 0.5, 0);
}

CHECK_TEST(test_brute_force)
{
  std::mt19937 generator(5);
  for (const auto &[width, height, values] :
       { std::tuple{ 3, 2, 4 }, { 17, 11, 1000 }, { 30, 20, 5 } }) {
    const cv::Mat map = random_map(width, height, values, generator);
    const cv::Mat other = random_map(width, height, values, generator);
    const auto fixations = random_fixations(width, height, 25, generator);
    const auto others = random_fixations(width, height, 40, generator);
    const double pixels = width * height;

    double mean = 0;
    double other_mean = 0;
    for (int i = 0; i < width * height; ++i) {
      mean += map.at<float>(i / width, i % width) / pixels;
      other_mean += other.at<float>(i / width, i % width) / pixels;
    }
    double variance = 0;
    double other_variance = 0;
    double covariance = 0;
    double judd = 0;
    double pairs = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double d = map.at<float>(y, x) - mean;
        const double e = other.at<float>(y, x) - other_mean;
        variance += d * d / pixels;
        other_variance += e * e / pixels;
        covariance += d * e / pixels;
        bool fixated = false;
        for (const auto &fixation : fixations)
          fixated = fixated || (std::floor(fixation.x) == x && std::floor(fixation.y) == y);
        for (const auto &fixation : fixations) {
          judd += fixated ? 0 : wins(value(map, fixation), map.at<float>(y, x));
          pairs += fixated ? 0 : 1;
        }
      }
    double nss = 0;
    double shuffled = 0;
    for (const auto &fixation : fixations) {
      nss += (value(map, fixation) - mean) / std::sqrt(variance) / 25;
      for (const auto &negative : others)
        shuffled += wins(value(map, fixation), value(map, negative)) / 25 / 40;
    }
    fail_unless_near(quality::nss(map, fixations), nss, 1e-6);
    if (pairs > 0)
      fail_unless_near(quality::auc_judd(map, fixations), judd / pairs, 1e-9);
    fail_unless_near(quality::shuffled_auc(map, fixations, others), shuffled, 1e-9);
    fail_unless_near(quality::correlation(map, other),
                     covariance / std::sqrt(variance * other_variance), 1e-6);
  }
}

CHECK_TEST(test_density)
{
  // Two fixations in one sample: a Gaussian of volume 2 about its center.
  const Fixations fixations{ { 30.2, 20.9 }, { 30.9, 20.1 } };
  const cv::Mat density = quality::fixation_density({ 61, 41 }, fixations, 3);
  fail_unless_near(cv::sum(density)[0], 2, 1e-4);
  const double peak = 2 / (2 * std::acos(-1.0) * 9);
  for (const auto &[dx, dy] : { std::pair{ 0, 0 }, { 3, 0 }, { 0, -3 }, { 4, 5 } })
    fail_unless_near(density.at<float>(20 + dy, 30 + dx),
                     peak * std::exp(-(dx * dx + dy * dy) / 18.0), 1e-4 * peak);
}

CHECK_TEST(test_reading)
{
  const TemporaryFile file("image,subject,x,y\r\n1001.jpg,0,0,600\n1003.jpg,0,12.5,7\n"
                           "1001.jpg,14,800,1e2\n");
  const auto fixations = quality::read_fixations(file.path, { 800, 600 });
  ck_assert_int_eq(static_cast<int>(fixations.size()), 2);
  fail_unless(fixations.at("1001.jpg").at("0") == Fixations({ { 0, 600 } }));
  fail_unless(fixations.at("1001.jpg").at("14") == Fixations({ { 800, 100 } }));
  fail_unless(fixations.at("1003.jpg").at("0") == Fixations({ { 12.5, 7 } }));
}

CHECK_TEST(test_unreadable)
{
  // Errors name the line.
  const struct
  {
    const char *content;
    const char *said;
  } cases[] = {
    { "", "holds no fixations" },
    { "image,subject,x,y\n", "holds no fixations" },
    { "image,x,y\n1.jpg,1,1\n", ":1: expected the head" },
    { "image,subject,x,y\n1.jpg,0,1,1\n1.jpg,0,1\n", ":3: expected x in 0..800 and y in 0..600" },
    { "image,subject,x,y\n1.jpg,0,1,1,1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,,1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,1,600.1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,-0.1,1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,nan,1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,inf,1\n", ":2: expected x" },
    { "image,subject,x,y\n1.jpg,0,1px,1\n", ":2: expected x" },
    { "image,subject,x,y\n../1.jpg,0,1,1\n", ":2: expected a file name" },
    { "image,subject,x,y\n..,0,1,1\n", ":2: expected a file name" },
    { "image,subject,x,y\n/etc/passwd,0,1,1\n", ":2: expected a file name" },
    { "image,subject,x,y\n,0,1,1\n", ":2: expected a file name" },
    { "image,subject,x,y\n\n", ":2: expected a file name" },
  };
  for (const auto &c : cases) {
    const TemporaryFile file(c.content);
    const auto said = complaint(file.path);
    fail_unless(said.find(c.said) != std::string::npos, "'%s': '%s'", c.content, said.c_str());
  }
  fail_unless(complaint("/nonexistent/fixations.csv").find("cannot be read") != std::string::npos);
  fail_unless(!complaint(std::filesystem::temp_directory_path()).empty());

  const TemporaryFile large;
  std::filesystem::resize_file(large.path, (64U << 20U) + 1);
  fail_unless(complaint(large.path).find("64 MiB") != std::string::npos);
}

CHECK_MAIN(fixations)
