// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/rarity.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace saliency {

namespace {

constexpr std::size_t kBins = 16; ///< along each axis
constexpr std::size_t kCells = kBins * kBins * kBins;
constexpr float kLightnessRange = 100;
constexpr float kHalfChroma = 24;     ///< |a*| that maps to half of the range
constexpr float kLargestChroma = 112; ///< |a*| at the outermost bin's edge
constexpr float kUnseen = 1e-4F;      ///< smallest share of any color
constexpr float kScale = 5;

/// The bin of a position in [0, 1], clamped to the outermost bins.
int
bin(float position)
{
  constexpr auto bins = static_cast<float>(kBins);
  return static_cast<int>(std::min(std::max(position * bins, 0.0F), bins - 1));
}

float
chroma_position(float chroma)
{
  constexpr float scale = 0.5F * (kLargestChroma + kHalfChroma) / kLargestChroma;
  return 0.5F + scale * chroma / (std::abs(chroma) + kHalfChroma);
}

std::uint16_t
cell(float lightness, float a, float b)
{
  constexpr int bins = kBins;
  return static_cast<std::uint16_t>(
      (bin(lightness / kLightnessRange) * bins + bin(chroma_position(a))) * bins
      + bin(chroma_position(b)));
}

/// [½ 1 ½] along the axis of this stride; zero beyond the outermost bins.
void
smooth(const std::vector<float> &in, std::size_t stride, std::vector<float> &out)
{
  std::copy(in.begin(), in.end(), out.begin());
  const std::size_t line = kBins * stride;
  const std::size_t pairs = line - stride;
  for (std::size_t start = 0; start < kCells; start += line) {
    const float *from = in.data() + start;
    float *to = out.data() + start;
    for (std::size_t i = 0; i < pairs; ++i)
      to[i] += 0.5F * from[i + stride];
    for (std::size_t i = 0; i < pairs; ++i)
      to[i + stride] += 0.5F * from[i];
  }
}

} // namespace

Rarity::Rarity(double border) : border_(border), histogram_(kCells), table_(kCells)
{
  assert(border >= 0 && border <= 0.5);
}

void
Rarity::operator()(const LabImage &lab, cv::Mat &weight)
{
  const cv::Size size = lab.size();
  CV_Assert(!size.empty());
  weight.create(size, CV_32FC1);
  bins_.resize(weight.total());

  const auto margin = [this](int length) {
    const int samples = static_cast<int>(std::lround(border_ * length));
    return border_ > 0 ? std::clamp(samples, 1, (length + 1) / 2) : (length + 1) / 2;
  };
  const int rows = margin(size.height);
  const int columns = margin(size.width);

  std::fill(histogram_.begin(), histogram_.end(), 0.0F);
  std::size_t counted = 0;
  auto *bins = bins_.data();
  for (int y = 0; y < size.height; ++y, bins += size.width) {
    const auto *lightness = lab.planes[0].ptr<float>(y);
    const auto *a = lab.planes[1].ptr<float>(y);
    const auto *b = lab.planes[2].ptr<float>(y);
    for (int x = 0; x < size.width; ++x)
      bins[x] = cell(lightness[x], a[x], b[x]);
    const auto count = [&](int from, int to) {
      for (int x = from; x < to; ++x)
        histogram_[bins[x]] += 1;
      counted += static_cast<std::size_t>(to - from);
    };
    if (y < rows || y >= size.height - rows) {
      count(0, size.width);
    } else {
      count(0, columns);
      count(std::max(columns, size.width - columns), size.width);
    }
  }

  smooth(histogram_, 1, table_);
  smooth(table_, kBins, histogram_);
  smooth(histogram_, kBins * kBins, table_);

  // For all bins: one vectorized logarithm costs less than a call for each bin in use.
  cv::Mat rarity(1, static_cast<int>(kCells), CV_32FC1, table_.data());
  rarity.convertTo(rarity, CV_32F, 1 / static_cast<double>(counted), kUnseen);
  cv::log(rarity, rarity);
  for (float &r : table_)
    r = std::max(0.0F, -r / kScale);

  bins = bins_.data();
  for (int y = 0; y < size.height; ++y, bins += size.width) {
    auto *out = weight.ptr<float>(y);
    for (int x = 0; x < size.width; ++x)
      out[x] = table_[bins[x]];
  }
}

} // namespace saliency
