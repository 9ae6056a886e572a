// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/envelope.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactor {

namespace {

constexpr double kEdge = 0.2; ///< width of an edge relative to its frequency
constexpr double kLowestHz = 10;

/// 0 below, 1 above, a raised cosine in between.
double
edge(double hz, double at)
{
  const double place = std::clamp((hz / at - 1) / kEdge + 0.5, 0.0, 1.0);
  return 0.5 - 0.5 * std::cos(std::numbers::pi * place);
}

cv::Mat
spectrum(std::span<const double> signal)
{
  const int size = cv::getOptimalDFTSize(static_cast<int>(signal.size()));
  cv::Mat padded = cv::Mat::zeros(1, size, CV_64F);
  std::ranges::copy(signal, padded.ptr<double>());
  cv::Mat result;
  cv::dft(padded, result, cv::DFT_COMPLEX_OUTPUT);
  return result;
}

/// The analytic signal of the filtered signal; `gain(hz)` is the filter.
template <typename Gain>
cv::Mat
analytic(std::span<const double> signal, const Gain &gain)
{
  cv::Mat bins = spectrum(signal);
  auto *bin = bins.ptr<cv::Vec2d>();
  for (int i = 0; i < bins.cols; i++)
    bin[i] *= 2 * i > bins.cols ? 0.0 : 2 * gain(static_cast<double>(i) / bins.cols);
  cv::dft(bins, bins, cv::DFT_INVERSE | cv::DFT_SCALE);
  return bins;
}

cv::Mat
analytic(std::span<const double> signal, double rate, Band band)
{
  return analytic(signal, [&](double turns) {
    return edge(turns * rate, band.low_hz) * (1 - edge(turns * rate, band.high_hz));
  });
}

std::vector<double>
magnitude(const cv::Mat &signal, std::size_t size)
{
  std::vector<double> result(size);
  for (std::size_t i = 0; i < size; i++)
    result[i] = cv::norm(signal.ptr<cv::Vec2d>()[i]);
  return result;
}

} // namespace

std::vector<double>
band_pass(std::span<const double> signal, double rate, Band band)
{
  if (signal.empty())
    return {};
  const cv::Mat both = analytic(signal, rate, band);
  std::vector<double> result(signal.size());
  for (std::size_t i = 0; i < result.size(); i++)
    result[i] = both.ptr<cv::Vec2d>()[i][0];
  return result;
}

std::vector<double>
envelope(std::span<const double> signal, double rate, Band band)
{
  if (signal.empty())
    return {};
  return magnitude(analytic(signal, rate, band), signal.size());
}

std::vector<double>
envelope(std::span<const double> signal)
{
  if (signal.empty())
    return {};
  return magnitude(analytic(signal, [](double) { return 1.0; }), signal.size());
}

double
strongest_frequency(std::span<const double> signal, double rate)
{
  if (signal.empty())
    return 0;
  const cv::Mat bins = spectrum(signal);
  double strongest = 0;
  double hz = 0;
  for (int i = 1; 2 * i < bins.cols; i++) {
    const double magnitude = cv::norm(bins.ptr<cv::Vec2d>()[i]);
    if (i * rate / bins.cols >= kLowestHz && magnitude > strongest) {
      strongest = magnitude;
      hz = i * rate / bins.cols;
    }
  }
  return hz;
}

} // namespace tactor
