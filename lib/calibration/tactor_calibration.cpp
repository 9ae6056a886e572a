// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/tactor_calibration.h"

#include "calibration/median.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>

namespace tactor {

namespace {

/// Limits for outliers: in milliseconds, and in median absolute deviations (× 1.48: standard
/// deviations).
constexpr double kOutlierMs = 15;
constexpr double kOutlierDeviations = 5 * 1.4826;
constexpr double kClearSnrDb = 15;

/// Whether the step shows if the motor moved.
bool
shows_motion(const StepResponse &response)
{
  return response.fault == StepFault::none || response.fault == StepFault::no_motion
         || response.fault == StepFault::noisy || response.fault == StepFault::irregular
         || response.fault == StepFault::clipped;
}

/// The lowest voltage at which, and above which, most steps of a kind moved the motor. None if
/// there is none.
std::optional<double>
threshold(const std::vector<StepResponse> &responses, bool (*is_of_kind)(const Step &))
{
  std::map<double, int, std::greater<>> votes;
  for (const StepResponse &response : responses)
    if (is_of_kind(response.step) && shows_motion(response))
      votes[response.step.target_volts] += response.fault == StepFault::no_motion ? -1 : 1;
  // A single voltage without motion between voltages with motion is not the threshold.
  std::optional<double> least;
  int still = 0;
  for (const auto &[volts, vote] : votes) {
    still = vote > 0 ? 0 : still + 1;
    if (vote > 0)
      least = volts;
    if (still == 2)
      break;
  }
  return least;
}

void
mark_missed(std::vector<StepResponse> &responses, double start_volts, double hold_volts)
{
  for (StepResponse &response : responses) {
    const double least = response.step.start_volts > 0 ? hold_volts : start_volts;
    if (response.fault == StepFault::no_motion && response.step.target_volts >= least)
      response.fault = StepFault::missed;
  }
}

std::vector<StepResponse *>
rises_of(std::vector<StepResponse> &responses)
{
  std::vector<StepResponse *> rises;
  for (StepResponse &response : responses)
    if (response.fault == StepFault::none && response.step.rises())
      rises.push_back(&response);
  return rises;
}

std::vector<RiseTimeSample>
samples_of(const std::vector<StepResponse *> &rises, double latency_ms, double start_volts)
{
  std::vector<RiseTimeSample> samples;
  samples.reserve(rises.size());
  for (const StepResponse *rise : rises)
    samples.push_back(
        { .start_volts = rise->step.start_volts < start_volts - 1e-6 ? 0 : rise->step.start_volts,
          .target_volts = rise->step.target_volts,
          .milliseconds = std::max(0.0, rise->risen_ms - latency_ms) });
  return samples;
}

/// Marks steps far from their repetitions or, where there are few, from the fit.
void
mark_outliers(std::vector<StepResponse> &responses)
{
  std::map<std::pair<double, double>, std::vector<StepResponse *>> repeated;
  for (StepResponse *rise : rises_of(responses))
    repeated[{ rise->step.start_volts, rise->step.target_volts }].push_back(rise);
  for (auto &[volts, rises] : repeated) {
    std::vector<double> times;
    for (const StepResponse *rise : rises)
      times.push_back(rise->risen_ms);
    const double middle = median(times);
    for (StepResponse *rise : rises)
      if (rises.size() >= 3 && std::abs(rise->risen_ms - middle) > kOutlierMs)
        rise->fault = StepFault::outlier;
  }
  const std::vector<StepResponse *> rises = rises_of(responses);
  const std::vector<RiseTimeSample> samples = samples_of(rises, 0, 0);
  const std::optional<QuadraticRiseTime> fit = fit_quadratic(samples);
  if (!fit || samples.size() < 12)
    return;
  std::vector<double> left;
  left.reserve(samples.size());
  for (const RiseTimeSample &sample : samples)
    left.push_back(
        std::abs(sample.milliseconds
                 - (*fit)(sample.start_volts, sample.target_volts - sample.start_volts)));
  const double limit = std::max(kOutlierMs, kOutlierDeviations * median(left));
  for (std::size_t i = 0; i < rises.size(); i++)
    if (left[i] > limit)
      rises[i]->fault = StepFault::outlier;
}

double
latency_of(const std::vector<StepResponse *> &rises)
{
  double strongest = 0;
  for (const StepResponse *rise : rises)
    strongest = std::max(strongest, rise->step.target_volts);
  std::vector<double> onsets;
  for (const StepResponse *rise : rises)
    if (rise->step.start_volts == 0 && rise->step.target_volts >= strongest / 2
        && rise->snr_db >= kClearSnrDb)
      onsets.push_back(rise->onset_ms);
  return median(onsets);
}

std::vector<VibrationPoint>
vibration_of(const std::vector<StepResponse> &responses)
{
  std::map<double, std::vector<double>> heard;
  for (const StepResponse &response : responses)
    if (response.fault == StepFault::none && response.steady > 0)
      heard[response.step.target_volts].push_back(response.steady);
  std::vector<double> volts;
  std::vector<double> amplitudes;
  for (const auto &[v, values] : heard) {
    volts.push_back(v);
    amplitudes.push_back(median(values));
  }
  const std::vector<double> rising = isotonic(amplitudes);
  std::vector<VibrationPoint> points;
  for (std::size_t i = 0; i < volts.size(); i++)
    points.push_back({ volts[i], rising[i] });
  return points;
}

} // namespace

std::optional<TactorCalibration>
calibrate_tactor(std::vector<StepResponse> &responses, bool latency_known)
{
  const std::optional<double> start = threshold(
      responses, [](const Step &step) { return step.start_volts == 0 && step.rises(); });
  const std::optional<double> hold
      = threshold(responses, [](const Step &step) { return !step.rises(); });
  TactorCalibration tactor;
  tactor.start_volts = start.value_or(kStartVolts);
  tactor.hold_volts = std::min(hold.value_or(tactor.start_volts), tactor.start_volts);
  mark_missed(responses, tactor.start_volts, tactor.hold_volts);
  mark_outliers(responses);

  const std::vector<StepResponse *> rises = rises_of(responses);
  if (rises.empty())
    return std::nullopt;
  // A rise begins at the first motion even without a common clock; only the latency is unknown
  // then.
  const double latency_ms = std::max(0.0, latency_of(rises));
  if (latency_known)
    tactor.latency = Time(std::llround(latency_ms * 1e6));
  const std::vector<RiseTimeSample> samples
      = samples_of(rises, latency_known ? latency_ms : latency_of(rises), tactor.start_volts);
  double volts_max = 0;
  for (const RiseTimeSample &sample : samples)
    volts_max = std::max(volts_max, sample.target_volts);
  tactor.quadratic = fit_quadratic(samples);
  tactor.table = monotone_table(samples, volts_max);
  // The table is monotone, so it fits badly if the measured rise times are not.
  double table_squares = 0;
  double quadratic_squares = 0;
  for (const RiseTimeSample &sample : samples) {
    const double s = sample.start_volts;
    const double t = sample.target_volts;
    const double table_ms = static_cast<double>(RiseTime(*tactor.table)(s, t).count()) / 1e6;
    table_squares += std::pow(sample.milliseconds - table_ms, 2);
    if (tactor.quadratic)
      quadratic_squares += std::pow(sample.milliseconds - (*tactor.quadratic)(s, t - s), 2);
  }
  tactor.prefers_quadratic = tactor.quadratic && quadratic_squares < table_squares;
  tactor.vibration = vibration_of(responses);
  std::vector<double> falls;
  for (const StepResponse &response : responses)
    if (response.fault == StepFault::none && std::isfinite(response.fallen_ms))
      falls.push_back(response.fallen_ms - latency_ms);
  if (!falls.empty())
    tactor.fall_time = Time(std::llround(std::max(1.0, median(falls)) * 1e6));
  for (const StepResponse &response : responses) {
    // No motion below the start voltage is a valid measurement.
    const bool used = response.fault == StepFault::none || response.fault == StepFault::no_motion;
    (used ? tactor.steps_used : tactor.steps_refused)++;
  }
  return tactor;
}

std::vector<RiseTimeSample>
rise_time_samples(const std::vector<StepResponse> &responses, const TactorCalibration &tactor)
{
  std::vector<StepResponse> own = responses;
  const std::vector<StepResponse *> rises = rises_of(own);
  const double latency_ms
      = tactor.latency ? static_cast<double>(tactor.latency->count()) / 1e6 : latency_of(rises);
  return samples_of(rises, latency_ms, tactor.start_volts);
}

Calibration
calibrate(std::vector<StepResponse> &responses, bool latency_known)
{
  std::map<int, std::vector<StepResponse>> tactors;
  for (const StepResponse &response : responses)
    tactors[response.step.tactor].push_back(response);
  Calibration calibration;
  responses.clear();
  for (auto &[index, own] : tactors) {
    if (const std::optional<TactorCalibration> tactor = calibrate_tactor(own, latency_known))
      calibration.tactors[index] = *tactor;
    responses.insert(responses.end(), own.begin(), own.end());
  }
  std::ranges::stable_sort(responses, {},
                           [](const StepResponse &response) { return response.step.at; });
  return calibration;
}

} // namespace tactor
