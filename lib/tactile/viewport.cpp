// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/viewport.h"

#include <algorithm>
#include <cmath>

namespace tactile {

namespace {

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// Center of a sample in the picture, in [0, 1].
double
position(int sample, int samples, const SaliencyView::Extent &picture)
{
  const double begin = picture.length > 0 ? picture.begin : 0.0;
  const double length = picture.length > 0 ? picture.length : static_cast<double>(samples);
  return std::clamp((sample + 0.5 - begin) / length, 0.0, 1.0);
}

/// Moves a border toward `to` by at most `reach`.
double
approach(double from, double to, double reach)
{
  return from + std::clamp(to - from, -reach, reach);
}

struct Span
{
  double begin;
  double end;
};

/// Mean ± 2 σ, clipped to the picture, of these moments and the prior, whose mean is 1/2 and whose
/// mean square is 1/3.
Span
span_of(double first, double second, double weight, double prior)
{
  if (weight <= 0)
    return { 0, 1 };
  const double mean = (first + prior / 2) / (weight + prior);
  const double variance = (second + prior / 3) / (weight + prior) - mean * mean;
  const double length = std::min(1.0, 4 * std::sqrt(variance));
  const double begin = std::clamp(mean - length / 2, 0.0, 1 - length);
  return { begin, begin + length };
}

} // namespace

/// Decays the past and adds a map with the weight `share`.
void
AdaptiveViewport::remember(const SaliencyView &map, double cut, double decay, double share)
{
  double sum = 0;
  Moments x_sum;
  Moments y_sum;
  for (int y = 0; share > 0 && y < map.height; ++y) {
    const double row = position(y, map.height, map.vertical);
    for (int x = 0; x < map.width; ++x) {
      const double value = map.at(x, y);
      if (value <= cut)
        continue;
      const double column = position(x, map.width, map.horizontal);
      sum += value;
      x_sum.first += value * column;
      x_sum.second += value * column * column;
      y_sum.first += value * row;
      y_sum.second += value * row * row;
    }
  }
  const double scale = sum > 0 ? share / sum : 0.0;
  const auto add = [&](Moments &to, const Moments &moments) {
    to.first = decay * to.first + scale * moments.first;
    to.second = decay * to.second + scale * moments.second;
  };
  add(horizontal_, x_sum);
  add(vertical_, y_sum);
  weight_ = decay * weight_ + scale * sum;
}

const Viewport &
AdaptiveViewport::follow(const SaliencyView &map, double floor, double threshold, Time time)
{
  if (last_time_ && time < *last_time_)
    reset();
  const Time passed = last_time_ ? time - *last_time_ : Time::zero();
  last_time_ = time;

  const double peak = map.peak();
  const bool salient = peak > std::max(0.0, floor);
  if (salient)
    last_salient_ = time;
  const double decay = std::exp(-seconds(passed) / seconds(kMemory));
  const double share
      = salient ? 1 - std::exp(-seconds(std::min(passed, kLongestShare)) / seconds(kMemory)) : 0.0;
  // The maximum itself always counts, as in map_saliency().
  remember(map, std::min(threshold * peak, std::nextafter(peak, 0.0)), decay, share);
  if (time - last_salient_ >= kSilence) {
    weight_ = 0;
    horizontal_ = vertical_ = {};
  }

  const auto horizontal = span_of(horizontal_.first, horizontal_.second, weight_, kPrior);
  const auto vertical = span_of(vertical_.first, vertical_.second, weight_, kPrior);
  const double reach = kSpeed * seconds(passed);
  const double right = approach(viewport_.left + viewport_.width, horizontal.end, reach);
  const double bottom = approach(viewport_.top + viewport_.height, vertical.end, reach);
  viewport_.left = approach(viewport_.left, horizontal.begin, reach);
  viewport_.top = approach(viewport_.top, vertical.begin, reach);
  viewport_.width = right - viewport_.left;
  viewport_.height = bottom - viewport_.top;
  return viewport_;
}

void
AdaptiveViewport::reset()
{
  *this = {};
}

} // namespace tactile
