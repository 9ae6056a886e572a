// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/picture_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tactile {

namespace {

/// The four samples around a position on an axis, and their weights.
struct Taps
{
  std::array<int, 4> sample;
  std::array<double, 4> weight;
};

/// Taps for sample `index` of an axis that is resampled to the same number of samples.
Taps
taps_at(int index, int samples, const SaliencyView::Extent &picture)
{
  const double length = picture.length > 0 ? picture.length : static_cast<double>(samples);
  const double begin = picture.length > 0 ? picture.begin : 0.0;
  const double place = begin + length * (index + 0.5) / samples - 0.5;
  const double before = std::floor(place);
  const double t = place - before;
  Taps taps{ .sample = {},
             .weight = { t * (-1 + t * (2 - t)) / 2, 1 + t * t * (3 * t - 5) / 2,
                         t * (1 + t * (4 - 3 * t)) / 2, t * t * (t - 1) / 2 } };
  for (std::size_t i = 0; i < taps.sample.size(); i++)
    taps.sample[i] = static_cast<int>(
        std::clamp(before - 1 + static_cast<double>(i), 0.0, static_cast<double>(samples - 1)));
  return taps;
}

} // namespace

void
PictureMap::sample(const SaliencyView &map)
{
  clear();
  if (map.empty())
    return;
  width_ = map.width;
  height_ = map.height;
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  rows_.resize(width * height);
  for (std::size_t x = 0; x < width; x++) {
    const Taps taps = taps_at(static_cast<int>(x), width_, map.horizontal);
    for (std::size_t y = 0; y < height; y++) {
      double sum = 0;
      for (std::size_t i = 0; i < taps.sample.size(); i++)
        sum += taps.weight[i] * map.at(taps.sample[i], static_cast<int>(y));
      rows_[y * width + x] = sum;
    }
  }
  values_.reserve(rows_.size());
  for (int y = 0; y < height_; y++) {
    const Taps taps = taps_at(y, height_, map.vertical);
    for (std::size_t x = 0; x < width; x++) {
      double sum = 0;
      for (std::size_t i = 0; i < taps.sample.size(); i++)
        sum += taps.weight[i] * rows_[static_cast<std::size_t>(taps.sample[i]) * width + x];
      values_.push_back(static_cast<float>(std::max(0.0, sum)));
    }
  }
}

void
PictureMap::clear()
{
  values_.clear();
  width_ = height_ = 0;
}

double
PictureMap::peak() const
{
  return values_.empty() ? 0.0 : static_cast<double>(*std::ranges::max_element(values_));
}

} // namespace tactile
