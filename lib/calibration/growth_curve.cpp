// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/growth_curve.h"

#include <opencv2/core/optim.hpp>

#include <algorithm>
#include <cmath>

namespace tactor {

namespace {

/// Relative accuracy of the envelope, as a share of the level.
constexpr double kExactness = 0.005;
constexpr double kOnsetScale = 0.05;

/// The curve for the solver's parameters, all of the order of 1: steady / its guess, onset, log
/// tau, log exponent.
GrowthCurve
curve_of(const double *x, double before, double steady)
{
  return { .before = before,
           .steady = steady * x[0],
           .onset_s = kOnsetScale * x[1],
           .tau_s = std::exp(std::clamp(x[2], -9.0, 3.0)),
           .exponent = std::exp(std::clamp(x[3], -1.5, 1.5)) };
}

constexpr double kFarthest = 1e300; ///< upper limit of the misfit

class Misfit : public cv::MinProblemSolver::Function
{
public:
  Misfit(std::span<const double> envelope, double rate, double first_s, double before,
         double steady, double noise, double independence, const GrowthPrior &prior,
         const GrowthLens &lens)
      : envelope_(envelope), rate_(rate), first_s_(first_s), before_(before), steady_(steady),
        noise_(noise), prior_(prior), lens_(lens),
        weight_(independence / (0.5 * noise + std::pow(kExactness * std::max(before, steady), 2)))
  {
  }

  int getDims() const override
  {
    return 4;
  }

  double sum(const GrowthCurve &curve) const
  {
    std::vector<double> amplitude = curve.sample(first_s_, rate_, envelope_.size());
    if (lens_)
      lens_(amplitude);
    double total = 0;
    for (std::size_t i = 0; i < envelope_.size(); i++) {
      const double difference = envelope_[i] - std::sqrt(amplitude[i] * amplitude[i] + noise_);
      total += difference * difference;
    }
    return total;
  }

  double calc(const double *x) const override
  {
    const GrowthCurve curve = curve_of(x, before_, steady_);
    const double early = (curve.onset_s - prior_.onset_s) / prior_.onset_deviation_s;
    const double power = (x[3] - prior_.log_exponent) / prior_.log_exponent_deviation;
    const double misfit = weight_ * sum(curve) + early * early + power * power;
    // The solver throws on NaN, so an impossible curve gets the largest misfit.
    return std::isfinite(misfit) ? misfit : kFarthest;
  }

private:
  std::span<const double> envelope_;
  double rate_;
  double first_s_;
  double before_;
  double steady_;
  double noise_;
  GrowthPrior prior_;
  const GrowthLens &lens_;
  double weight_;
};

/// When the envelope, smoothed over 10 ms, crosses a level.
double
crossing(std::span<const double> envelope, double rate, double first_s, double level, bool rises)
{
  const auto width = static_cast<std::size_t>(std::max(1.0, 0.01 * rate));
  double sum = 0;
  for (std::size_t i = 0; i < envelope.size(); i++) {
    sum += envelope[i] - (i >= width ? envelope[i - width] : 0);
    const double smooth = sum / static_cast<double>(width);
    if (i + 1 >= width && (rises ? smooth >= level : smooth <= level))
      return first_s + (static_cast<double>(i) - 0.5 * static_cast<double>(width - 1)) / rate;
  }
  return first_s + static_cast<double>(envelope.size()) / rate;
}

} // namespace

std::vector<double>
GrowthCurve::sample(double first_s, double rate, std::size_t count) const
{
  const double from = std::pow(before, 1 / exponent);
  const double to = std::pow(steady, 1 / exponent);
  std::vector<double> amplitudes(count, before);
  const auto still = static_cast<std::size_t>(
      std::clamp(std::ceil((onset_s - first_s) * rate), 0.0, static_cast<double>(count)));
  double left
      = (to - from) * std::exp(-(first_s + static_cast<double>(still) / rate - onset_s) / tau_s);
  const double slower = std::exp(-1 / (rate * tau_s));
  for (std::size_t i = still; i < count; i++) {
    amplitudes[i] = std::pow(to - left, exponent);
    left *= slower;
  }
  return amplitudes;
}

double
GrowthCurve::time_of(double amplitude) const
{
  if ((amplitude - before) * (steady - before) <= 0)
    return onset_s;
  const double from = std::pow(before, 1 / exponent);
  const double to = std::pow(steady, 1 / exponent);
  return onset_s + tau_s * std::log((to - from) / (to - std::pow(amplitude, 1 / exponent)));
}

GrowthCurve
fit_growth(std::span<const double> envelope, double rate, double first_s, double before,
           double steady, double noise, double independence, const GrowthPrior &prior,
           const GrowthLens &lens)
{
  const auto level = [&](double share) {
    const double amplitude = std::lerp(before, steady, share);
    return std::sqrt(amplitude * amplitude + noise);
  };
  const double early = crossing(envelope, rate, first_s, level(0.3), steady > before);
  const double late = crossing(envelope, rate, first_s, level(0.7), steady > before);
  // An exponential reaches 30 % after 0.36 τ and 70 % after 1.20 τ.
  const double tau = std::max((late - early) / 0.847, 0.002);

  const auto misfit = cv::makePtr<Misfit>(envelope, rate, first_s, before, steady, noise,
                                          independence, prior, lens);
  cv::Mat best
      = (cv::Mat_<double>(1, 4) << 1, (early - 0.357 * tau) / kOnsetScale, std::log(tau), 0);
  cv::Mat step = (cv::Mat_<double>(1, 4) << 0.05, 0.2, 0.3, 0.2);
  const auto solver = cv::DownhillSolver::create(
      misfit, step,
      cv::TermCriteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 1000, 1e-6));
  solver->minimize(best);
  GrowthCurve curve = curve_of(best.ptr<double>(), before, steady);
  curve.rms = std::sqrt(misfit->sum(curve)
                        / static_cast<double>(std::max<std::size_t>(envelope.size(), 1)));
  return curve;
}

} // namespace tactor
