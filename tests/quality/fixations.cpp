// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fixations.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace quality {

namespace {

constexpr std::uintmax_t kLargestFile = 64U << 20U;
constexpr std::string_view kHead = "image,subject,x,y";

/// Throws for an invalid line.
[[noreturn]] void
refuse(const std::filesystem::path &file, int line, const std::string &expected)
{
  throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": expected " + expected);
}

/// Takes the field before the next comma.
std::string_view
next_field(std::string_view &rest)
{
  const auto comma = std::min(rest.find(','), rest.size());
  const auto field = rest.substr(0, comma);
  rest.remove_prefix(std::min(comma + 1, rest.size()));
  return field;
}

/// Parses a field that must be a number from 0 to `limit`.
bool
parse(std::string_view field, double limit, double &value)
{
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc{} && end == field.data() + field.size() && value >= 0 && value <= limit;
}

cv::Point
sample_at(const cv::Mat &map, cv::Point2d position)
{
  const auto index = [](double coordinate, int length) {
    return static_cast<int>(std::clamp(std::floor(coordinate), 0.0, length - 1.0));
  };
  return { index(position.x, map.cols), index(position.y, map.rows) };
}

std::vector<float>
values_at(const cv::Mat &map, std::span<const cv::Point2d> positions)
{
  std::vector<float> values;
  values.reserve(positions.size());
  for (const auto &position : positions)
    values.push_back(map.at<float>(sample_at(map, position)));
  return values;
}

/// The probability that a positive exceeds a negative. Ties count ½.
double
area_under_curve(std::vector<float> positives, const std::vector<float> &negatives)
{
  std::sort(positives.begin(), positives.end());
  std::ptrdiff_t halves = 0;
  for (const float negative : negatives) {
    const auto [equal, above] = std::equal_range(positives.begin(), positives.end(), negative);
    halves += (positives.end() - equal) + (positives.end() - above);
  }
  return 0.5 * static_cast<double>(halves) / static_cast<double>(positives.size())
         / static_cast<double>(negatives.size());
}

struct Moments
{
  double mean;
  double deviation;
};

Moments
moments(const cv::Mat &map)
{
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(map, mean, deviation);
  return { mean[0], deviation[0] };
}

/// Whether a map's deviation is within rounding errors.
bool
is_flat(const Moments &m)
{
  return m.deviation <= 1e-6 * std::abs(m.mean);
}

} // namespace

std::map<std::string, std::map<std::string, Fixations>>
read_fixations(const std::filesystem::path &file, cv::Size picture)
{
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  std::ifstream in(file);
  if (error || !in)
    throw std::runtime_error(file.string() + ": cannot be read");
  if (size > kLargestFile)
    throw std::runtime_error(file.string() + ": is beyond 64 MiB");

  std::map<std::string, std::map<std::string, Fixations>> fixations;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.ends_with('\r'))
      line.pop_back();
    if (number == 1) {
      if (line != kHead)
        refuse(file, number, "the head " + std::string(kHead));
      continue;
    }
    std::string_view rest = line;
    const auto name = next_field(rest);
    const auto subject = next_field(rest);
    const auto x = next_field(rest);
    cv::Point2d position;
    if (name.empty() || name.starts_with('.') || name.find('/') != std::string_view::npos
        || subject.empty())
      refuse(file, number, "a file name and a subject");
    if (!parse(x, picture.width, position.x) || !parse(rest, picture.height, position.y))
      refuse(file, number,
             "x in 0.." + std::to_string(picture.width) + " and y in 0.."
                 + std::to_string(picture.height));
    fixations[std::string(name)][std::string(subject)].push_back(position);
  }
  if (fixations.empty())
    throw std::runtime_error(file.string() + ": holds no fixations");
  return fixations;
}

double
nss(const cv::Mat &map, std::span<const cv::Point2d> fixations)
{
  const auto m = moments(map);
  if (is_flat(m))
    return 0;
  double sum = 0;
  for (const float value : values_at(map, fixations))
    sum += (value - m.mean) / m.deviation;
  return sum / static_cast<double>(fixations.size());
}

double
auc_judd(const cv::Mat &map, std::span<const cv::Point2d> fixations)
{
  cv::Mat fixated = cv::Mat::zeros(map.size(), CV_8UC1);
  for (const auto &fixation : fixations)
    fixated.at<std::uint8_t>(sample_at(map, fixation)) = 1;
  std::vector<float> others;
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      if (fixated.at<std::uint8_t>(y, x) == 0)
        others.push_back(map.at<float>(y, x));
  return others.empty() ? 0.5 : area_under_curve(values_at(map, fixations), others);
}

double
shuffled_auc(const cv::Mat &map, std::span<const cv::Point2d> fixations,
             std::span<const cv::Point2d> others)
{
  return area_under_curve(values_at(map, fixations), values_at(map, others));
}

cv::Mat
fixation_density(cv::Size size, std::span<const cv::Point2d> fixations, double sigma)
{
  cv::Mat density = cv::Mat::zeros(size, CV_32FC1);
  for (const auto &fixation : fixations)
    density.at<float>(sample_at(density, fixation)) += 1;
  if (sigma > 0)
    cv::GaussianBlur(density, density, {}, sigma);
  return density;
}

double
correlation(const cv::Mat &map, const cv::Mat &density)
{
  const auto m = moments(map);
  const auto d = moments(density);
  if (is_flat(m) || is_flat(d))
    return 0;
  double sum = 0;
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      sum += (map.at<float>(y, x) - m.mean) * (density.at<float>(y, x) - d.mean);
  return sum / static_cast<double>(map.total()) / m.deviation / d.deviation;
}

} // namespace quality
