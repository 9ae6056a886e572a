// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/calibration/growth_curve.h"

#include <opencv2/core/optim.hpp>

#include <algorithm>
#include <cmath>

namespace tactor {

namespace {

/// The envelope is taken to be no more exact than this share of the level.
constexpr double kExactness = 0.005;
constexpr double kOnsetScale = 0.05;

/// The curve's parameters as the solver moves them, all of the order of 1: steady / its guess, onset, log tau, log roundness.
GrowthCurve
curve_of(const double *x, double before, double steady)
{
  return { .before = before,
           .steady = steady * x[0],
           .onset_s = kOnsetScale * x[1],
           .tau_s = std::exp(std::clamp(x[2], -9.0, 3.0)),
           .roundness = std::exp(std::clamp(x[3], -1.5, 1.5)) };
}

class Misfit : public cv::MinProblemSolver::Function
{
public:
  Misfit(std::span<const double> envelope, double rate, double first_s, double before,
         double steady, double noise, double independence, const GrowthPrior &prior)
      : envelope_(envelope), rate_(rate), first_s_(first_s), before_(before), steady_(steady),
        noise_(noise), prior_(prior),
        weight_(independence / (0.5 * noise + kExactness * kExactness * steady * steady))
  {
  }

  int getDims() const override
  {
    return 4;
  }

  double sum(const GrowthCurve &curve) const
  {
    double total = 0;
    for (std::size_t i = 0; i < envelope_.size(); i++) {
      const double amplitude = curve(first_s_ + static_cast<double>(i) / rate_);
      const double difference = envelope_[i] - std::sqrt(amplitude * amplitude + noise_);
      total += difference * difference;
    }
    return total;
  }

  double calc(const double *x) const override
  {
    const GrowthCurve curve = curve_of(x, before_, steady_);
    const double early = (curve.onset_s - prior_.onset_s) / prior_.onset_deviation_s;
    const double round = (x[3] - prior_.log_roundness) / prior_.log_roundness_deviation;
    return weight_ * sum(curve) + early * early + round * round;
  }

private:
  std::span<const double> envelope_;
  double rate_;
  double first_s_;
  double before_;
  double steady_;
  double noise_;
  GrowthPrior prior_;
  double weight_;
};

/// When the envelope, smoothed over 10 ms, gets to a share of the way.
double
crossing(std::span<const double> envelope, double rate, double first_s, double level)
{
  const auto width = static_cast<std::size_t>(std::max(1.0, 0.01 * rate));
  double sum = 0;
  for (std::size_t i = 0; i < envelope.size(); i++) {
    sum += envelope[i] - (i >= width ? envelope[i - width] : 0);
    if (i + 1 >= width && sum / static_cast<double>(width) >= level)
      return first_s + (static_cast<double>(i) - 0.5 * static_cast<double>(width - 1)) / rate;
  }
  return first_s + static_cast<double>(envelope.size()) / rate;
}

} // namespace

double
GrowthCurve::operator()(double time_s) const
{
  if (time_s <= onset_s)
    return before;
  return steady - (steady - before) * std::exp(-std::pow((time_s - onset_s) / tau_s, roundness));
}

double
GrowthCurve::time_of(double amplitude) const
{
  if (amplitude <= before)
    return onset_s;
  return onset_s
         + tau_s * std::pow(std::log((steady - before) / (steady - amplitude)), 1 / roundness);
}

GrowthCurve
fit_growth(std::span<const double> envelope, double rate, double first_s, double before,
           double steady, double noise, double independence, const GrowthPrior &prior)
{
  const auto level = [&](double share) {
    const double amplitude = std::lerp(before, steady, share);
    return std::sqrt(amplitude * amplitude + noise);
  };
  const double early = crossing(envelope, rate, first_s, level(0.3));
  const double late = crossing(envelope, rate, first_s, level(0.7));
  // On an exponential 30 % are reached after 0.36 τ, 70 % after 1.20 τ.
  const double tau = std::max((late - early) / 0.847, 0.002);

  const auto misfit
      = cv::makePtr<Misfit>(envelope, rate, first_s, before, steady, noise, independence, prior);
  cv::Mat best
      = (cv::Mat_<double>(1, 4) << 1, (early - 0.357 * tau) / kOnsetScale, std::log(tau), 0);
  cv::Mat step = (cv::Mat_<double>(1, 4) << 0.05, 0.2, 0.3, 0.2);
  const auto solver = cv::DownhillSolver::create(
      misfit, step,
      cv::TermCriteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 1000, 1e-7));
  solver->minimize(best);
  GrowthCurve curve = curve_of(best.ptr<double>(), before, steady);
  curve.rms = std::sqrt(misfit->sum(curve)
                        / static_cast<double>(std::max<std::size_t>(envelope.size(), 1)));
  return curve;
}

} // namespace tactor
