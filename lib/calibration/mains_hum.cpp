// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/mains_hum.h"

#include <opencv2/core.hpp>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>

namespace tactor {

namespace {

constexpr double kSearchHz = 0.3;
constexpr double kSearchStepHz = 0.03;
constexpr double kExactHz = 0.002;
/// Smallest share of the power at rest that counts as hum: noise has spectral lines, too.
constexpr double kLeastShare = 0.3;

struct Hum
{
  double hz = 0;
  cv::Mat amplitudes{}; ///< cosine and sine of each harmonic
  double power = 0;     ///< summed over the samples at rest
};

/// Cosine and sine of each harmonic at a time.
void
waves(double hz, double seconds, int harmonics, double *row)
{
  for (int h = 1; h <= harmonics; h++) {
    const double phase = 2 * std::numbers::pi * hz * h * seconds;
    *row++ = std::cos(phase);
    *row++ = std::sin(phase);
  }
}

Hum
fit(std::span<const double> signal, std::span<const int> at, double rate, double hz, int harmonics)
{
  cv::Mat regressors(static_cast<int>(at.size()), 2 * harmonics, CV_64F);
  cv::Mat heard(static_cast<int>(at.size()), 1, CV_64F);
  for (int i = 0; i < regressors.rows; i++) {
    const int sample = at[static_cast<std::size_t>(i)];
    waves(hz, sample / rate, harmonics, regressors.ptr<double>(i));
    heard.at<double>(i) = signal[static_cast<std::size_t>(sample)];
  }
  Hum hum{ .hz = hz };
  cv::solve(regressors, heard, hum.amplitudes, cv::DECOMP_NORMAL | cv::DECOMP_SVD);
  const cv::Mat explained = regressors * hum.amplitudes;
  hum.power = explained.dot(explained);
  return hum;
}

} // namespace

double
remove_mains_hum(std::vector<double> &signal, const std::vector<bool> &rests, double rate,
                 double highest_hz)
{
  std::vector<int> at;
  double power = 0;
  for (std::size_t i = 0; i < signal.size(); i++)
    if (rests[i]) {
      at.push_back(static_cast<int>(i));
      power += signal[i] * signal[i];
    }
  std::optional<Hum> best;
  for (const double mains : { 50.0, 60.0 }) {
    const int harmonics = static_cast<int>(highest_hz / (mains + kSearchHz));
    if (harmonics < 1 || std::ssize(at) < std::ptrdiff_t{ 20 } * harmonics)
      continue;
    const auto consider = [&](double hz) {
      Hum hum = fit(signal, at, rate, hz, harmonics);
      if (!best || hum.power > best->power)
        best = std::move(hum);
    };
    for (double hz = mains - kSearchHz; hz <= mains + kSearchHz; hz += kSearchStepHz)
      consider(hz);
    if (std::abs(best->hz - mains) > kSearchHz)
      continue; // belongs to the other mains frequency
    for (double step = kSearchStepHz / 2; step > kExactHz; step /= 2) {
      const double middle = best->hz;
      consider(middle - step);
      consider(middle + step);
    }
  }
  if (!best || best->power < kLeastShare * power)
    return 0;
  const int harmonics = best->amplitudes.rows / 2;
  std::vector<double> row(static_cast<std::size_t>(2 * harmonics));
  for (std::size_t i = 0; i < signal.size(); i++) {
    waves(best->hz, static_cast<double>(i) / rate, harmonics, row.data());
    signal[i] -= cv::Mat(1, 2 * harmonics, CV_64F, row.data()).dot(best->amplitudes.t());
  }
  return std::sqrt(best->power / static_cast<double>(at.size()));
}

} // namespace tactor
