// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/step_sound.h"

#include "calibration/mains_hum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace tactor {

namespace {

/// Longest rest before and after a step to analyze.
constexpr double kRestS = 0.5;
/// How long a motor may take to run down after the end of a step.
constexpr double kRunOutS = 0.25;
/// The band-pass is unreliable this close to the ends.
constexpr double kMarginS = 0.05;
/// Samples farther away do not affect the envelope.
constexpr double kReachS = 0.2;
constexpr double kDropoutS = 0.01;
/// Sampling rate relative to the band's upper edge: twice the Nyquist rate, for the band-pass's
/// edge.
constexpr double kOversampling = 4;
/// Samples are near the extreme if they are within kLeastCrest of it, relatively, or within the
/// noise, but at most kMostCrest…
constexpr double kLeastCrest = 0.002;
constexpr double kMostCrest = 0.02;
constexpr double kNoiseDeviations = 7;
/// …and form a flat crest if there are this many times more than in a sine.
constexpr double kFlat = 2.2;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

double
mean_square(std::span<const double> samples)
{
  const double sum = std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0);
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

/// Removes the trend of a drifting sensor.
void
level_out(std::vector<double> &samples, double rate)
{
  const auto part = std::min(static_cast<std::size_t>(kMarginS * rate) + 1, samples.size());
  if (part == 0)
    return;
  const auto mean = [&](auto begin) {
    return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(part), 0.0)
           / static_cast<double>(part);
  };
  const double first = mean(samples.begin());
  const double last = mean(samples.end() - static_cast<std::ptrdiff_t>(part));
  for (std::size_t i = 0; i < samples.size(); i++)
    samples[i]
        -= std::lerp(first, last, static_cast<double>(i) / static_cast<double>(samples.size()));
}

} // namespace

std::size_t
Window::index(double at_s) const
{
  return static_cast<std::size_t>(
      std::clamp((at_s - first_s) * rate, 0.0, static_cast<double>(samples.size())));
}

double
Window::time(std::size_t index) const
{
  return first_s + static_cast<double>(index) / rate;
}

std::span<const double>
Window::part(double from_s, double to_s) const
{
  const std::size_t from = index(from_s);
  return std::span(samples).subspan(from, std::max(index(to_s), from) - from);
}

StepSound::StepSound(const Recording &recording, int channel, const Step &step)
    : step_(step), full_scale_(recording.full_scale)
{
  const std::vector<double> &samples = recording.channels.at(static_cast<std::size_t>(channel));
  const double rest
      = seconds(std::max(step.rest_begin, step.rest_end - Time(std::chrono::seconds(1))) - step.at);
  const double from = std::max(rest, seconds(step.rest_end - step.at) - kRestS - kRunOutS);
  const double to
      = std::min(seconds(step.next - step.at), seconds(step.off - step.at) + kRunOutS + kRestS);
  const double at = seconds(step.at - recording.start) * recording.rate;
  const auto sample = [&](double s) {
    return static_cast<long>(std::floor(at + s * recording.rate));
  };
  const long size = std::ssize(samples);
  const long first = std::clamp(sample(from), 0L, size);
  const long last = std::clamp(sample(to), first, size);
  raw_ = { .rate = recording.rate, .first_s = (static_cast<double>(first) - at) / recording.rate };
  raw_.samples.assign(samples.begin() + first, samples.begin() + last);
  truncated_ = sample(seconds(step.rest_end - step.at) - kMarginS) < 0
               || sample(seconds(step.end - step.at)) > size;
}

const Window &
StepSound::raw() const
{
  return raw_;
}

bool
StepSound::is_truncated() const
{
  return truncated_;
}

bool
StepSound::has_dropout(double from_s, double to_s) const
{
  const auto longest = static_cast<std::size_t>(std::max(3.0, kDropoutS * raw_.rate));
  std::size_t silent = 0;
  bool heard = false;
  for (const double sample : raw_.part(from_s, to_s)) {
    if (sample == 0) {
      silent++;
      continue;
    }
    if (heard && silent > longest)
      return true;
    heard = true;
    silent = 0;
  }
  return false;
}

bool
StepSound::is_clipped(double from_s, double to_s) const
{
  const std::span<const double> samples = raw_.part(from_s, to_s);
  double limit = full_scale_ * 0.999;
  if (full_scale_ <= 0)
    for (const double sample : samples)
      limit = std::max(limit, std::abs(sample) * (1 - 1e-9));
  int crests = 0;
  int run = 0;
  for (const double sample : samples) {
    run = limit > 0 && std::abs(sample) >= limit ? run + 1 : 0;
    crests += run == 3;
  }
  return crests >= 3;
}

double
StepSound::flat_crest(double from_s, double to_s) const
{
  const std::span<const double> samples = raw_.part(from_s, to_s);
  const std::span<const double> rest = raw_.part(raw_.first_s, seconds(step_.rest_end - step_.at));
  for (const double sign : { 1.0, -1.0 }) {
    double top = 0;
    for (const double sample : samples)
      top = std::max(top, sign * sample);
    const double near
        = std::max(kLeastCrest, kNoiseDeviations * std::sqrt(mean_square(rest)) / top);
    if (!(top > 0) || near > kMostCrest)
      continue;
    const auto count = static_cast<double>(std::ranges::count_if(
        samples, [&](double sample) { return sign * sample >= top * (1 - near); }));
    const double of_sine
        = std::acos(1 - near) / std::numbers::pi * static_cast<double>(samples.size());
    if (count > kFlat * of_sine)
      return top;
  }
  return 0;
}

void
StepSound::listen(Band band)
{
  band_ = band;
  std::vector<double> level = raw_.samples;
  level_out(level, raw_.rate);
  const auto every
      = static_cast<std::size_t>(std::max(1.0, raw_.rate / (kOversampling * band.high_hz)));
  const std::vector<double> all = band_pass(level, raw_.rate, band);
  passed_ = { .rate = raw_.rate / static_cast<double>(every), .first_s = raw_.first_s };
  for (std::size_t i = 0; i < all.size(); i += every)
    passed_.samples.push_back(all[i]);

  const double rest_end = seconds(step_.rest_end - step_.at);
  const double rest_begin
      = std::max(seconds(step_.rest_begin - step_.at) + kRunOutS, passed_.first_s + kMarginS);
  const double second_rest = seconds(step_.off - step_.at) + kRunOutS;
  std::vector<bool> rests(passed_.samples.size());
  for (std::size_t i = 0; i < rests.size(); i++) {
    const double at = passed_.time(i);
    rests[i] = (at >= rest_begin && at < rest_end - 0.01)
               || (at >= second_rest
                   && i + static_cast<std::size_t>(kMarginS * passed_.rate) < rests.size());
  }
  hum_ = remove_mains_hum(passed_.samples, rests, passed_.rate, band.high_hz);
  envelope_ = passed_;
  envelope_.samples = envelope(passed_.samples);
  noise_ = 0;
  for (std::size_t i = 0; i < rests.size(); i++)
    noise_ += rests[i] ? envelope_.samples[i] * envelope_.samples[i] : 0;
  noise_ /= static_cast<double>(std::max<std::ptrdiff_t>(std::ranges::count(rests, true), 1));
}

double
StepSound::hum() const
{
  return hum_;
}

double
StepSound::noise() const
{
  return noise_;
}

double
StepSound::loudest() const
{
  return envelope_.samples.empty() ? 0 : std::ranges::max(envelope_.samples);
}

double
StepSound::amplitude(double from_s, double to_s) const
{
  return std::sqrt(std::max(mean_square(envelope_.part(from_s, to_s)) - noise_, 0.0));
}

double
StepSound::uncertainty(double seconds) const
{
  return 3 * std::sqrt(noise_ / std::max(1.0, (band_.high_hz - band_.low_hz) * seconds));
}

GrowthCurve
StepSound::fit(double from_s, double to_s, double before, double after,
               const GrowthPrior &prior) const
{
  const std::size_t first = envelope_.index(from_s);
  const std::size_t last = std::max(first, envelope_.index(to_s));
  const auto near = static_cast<std::size_t>(kReachS * passed_.rate);
  const std::size_t begin = first - std::min(first, near);
  const std::size_t end = std::min(last + near, passed_.samples.size());
  const std::span<const double> around = std::span(passed_.samples).subspan(begin, end - begin);
  const GrowthLens lens = [&](std::vector<double> &amplitudes) {
    std::vector<double> seen(around.begin(), around.end());
    for (std::size_t i = 0; i < amplitudes.size(); i++)
      seen[first - begin + i] *= amplitudes[i] / std::max(envelope_.samples[first + i], 1e-30);
    seen = envelope(seen, passed_.rate, band_);
    std::copy_n(seen.begin() + static_cast<std::ptrdiff_t>(first - begin), amplitudes.size(),
                amplitudes.begin());
  };
  return fit_growth(std::span(envelope_.samples).subspan(first, last - first), envelope_.rate,
                    envelope_.time(first), before, after, noise_,
                    (band_.high_hz - band_.low_hz) / envelope_.rate, prior, lens);
}

std::vector<double>
StepSound::plotted() const
{
  std::vector<double> result;
  for (std::size_t i = 0; i < raw_.samples.size(); i++) {
    const double at = static_cast<double>(i) * envelope_.rate / raw_.rate;
    const auto last = static_cast<double>(envelope_.samples.size() - 1);
    const auto before = static_cast<std::size_t>(std::min(at, last));
    const std::size_t after = std::min(before + 1, envelope_.samples.size() - 1);
    result.push_back(std::lerp(envelope_.samples[before], envelope_.samples[after],
                               std::min(at - static_cast<double>(before), 1.0)));
  }
  return result;
}

} // namespace tactor
