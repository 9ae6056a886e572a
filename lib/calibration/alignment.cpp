// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/alignment.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

namespace tactor {

namespace {

constexpr double kRate = 200; ///< samples per second for the correlation

void
subtract_mean(std::vector<double> &values)
{
  const double mean = std::accumulate(values.begin(), values.end(), 0.0)
                      / static_cast<double>(std::max<std::size_t>(values.size(), 1));
  for (double &value : values)
    value -= mean;
}

/// The sum of all tactors' commanded volts from `start` on.
std::vector<double>
commanded_volts(std::span<const IssuedCommand> trace, Time start, double seconds)
{
  std::vector<double> values;
  std::map<int, double> volts;
  std::size_t next = 0;
  for (int i = 0; i < seconds * kRate; i++) {
    const Time now = start + Time(std::llround(i / kRate * 1e9));
    for (; next < trace.size() && trace[next].issued <= now; next++)
      volts[trace[next].command.tactor] = trace[next].command.volts;
    double sum = 0;
    for (const auto &[tactor, own] : volts)
      sum += own;
    values.push_back(sum);
  }
  return values;
}

} // namespace

Time
align(const Recording &recording, std::span<const IssuedCommand> trace, Band band)
{
  if (trace.empty() || recording.size() == 0)
    return recording.start;
  const std::vector<double> amplitude = envelope(recording.channels.front(), recording.rate, band);
  const double every = recording.rate / kRate;
  std::vector<double> heard;
  for (double from = 0; from + every <= static_cast<double>(amplitude.size()); from += every) {
    const auto begin = amplitude.begin() + static_cast<std::ptrdiff_t>(from);
    const auto count = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(every));
    heard.push_back(std::accumulate(begin, begin + count, 0.0) / static_cast<double>(count));
  }
  const Time first = trace.front().issued;
  std::vector<double> expected = commanded_volts(
      trace, first, std::chrono::duration<double>(trace.back().issued - first).count() + 1);
  subtract_mean(heard);
  subtract_mean(expected);

  const int size = cv::getOptimalDFTSize(static_cast<int>(heard.size() + expected.size()));
  const auto spectrum = [size](const std::vector<double> &values) {
    cv::Mat padded = cv::Mat::zeros(1, size, CV_64F);
    std::ranges::copy(values, padded.ptr<double>());
    cv::dft(padded, padded, 0);
    return padded;
  };
  cv::Mat likeness;
  cv::mulSpectrums(spectrum(heard), spectrum(expected), likeness, 0, true);
  cv::dft(likeness, likeness, cv::DFT_INVERSE | cv::DFT_SCALE);
  cv::Point best;
  cv::minMaxLoc(likeness, nullptr, nullptr, nullptr, &best);
  // The correlation is circular: larger shifts mean that the recording begins after the first
  // command.
  const int later = best.x < static_cast<int>(heard.size()) ? best.x : best.x - size;
  return first - Time(std::llround(later / kRate * 1e9));
}

} // namespace tactor
