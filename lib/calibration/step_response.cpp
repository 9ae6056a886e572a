// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/step_response.h"

#include "calibration/median.h"
#include "calibration/step_sound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tactor {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr double kLeastSnrDb = 10;
constexpr double kMotionSnrDb = 3;
/// The steady part is this last share of the time at the target; its halves may differ by
/// kSteadyChange.
constexpr double kSteadyShare = 0.4;
constexpr double kSteadyChange = 0.05;
constexpr double kLeastChange = 0.04;
constexpr double kIrregular = 0.12;
constexpr double kFitFromS = -0.1;
constexpr double kSmearS = 0.05;
constexpr double kSmeared = 0.02; ///< largest share of the maximum that may leak into rest
constexpr double kFallS = 0.4;
constexpr double kSameCrest = 0.02;
constexpr double kOtherVolts = 0.15;
/// Lower limits on the prior's deviations: a motor varies this much from step to step.
constexpr double kLeastOnsetDeviationS = 0.001;
constexpr double kLeastExponentDeviation = 0.03;
constexpr std::size_t kFewestInCommon = 5;
constexpr double kLowestHz = 8;
constexpr std::size_t kLinesForBand = 9;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

double
decibels(double power, double reference)
{
  return 10 * std::log10(std::max(power, 1e-30) / std::max(reference, 1e-30));
}

/// Marks clipped steps. A motor may have flat crests, but crests of the same height at different
/// voltages are the limit of an amplifier.
void
mark_clipped(std::vector<StepResponse> &responses)
{
  std::vector<StepResponse *> clipped;
  for (StepResponse &one : responses)
    for (const StepResponse &other : responses)
      if (one.flat_crest > 0 && std::abs(one.flat_crest / other.flat_crest - 1) < kSameCrest
          && std::abs(one.step.target_volts - other.step.target_volts)
                 > kOtherVolts * one.step.target_volts) {
        clipped.push_back(&one);
        break;
      }
  for (StepResponse *response : clipped)
    response->fault = StepFault::clipped;
}

} // namespace

std::string_view
fault_name(StepFault fault)
{
  switch (fault) {
  case StepFault::none:
    return "none";
  case StepFault::no_motion:
    return "no motion";
  case StepFault::missed:
    return "missed";
  case StepFault::clipped:
    return "clipped";
  case StepFault::noisy:
    return "noisy";
  case StepFault::unsteady:
    return "unsteady";
  case StepFault::dropout:
    return "dropout";
  case StepFault::truncated:
    return "truncated";
  case StepFault::overlapped:
    return "overlapped";
  case StepFault::irregular:
    return "irregular";
  case StepFault::outlier:
    return "outlier";
  }
  return "unknown";
}

StepResponse
measure_step(const Recording &recording, int channel, const Step &step, Band band,
             const GrowthPrior &prior, StepEnvelope *picture)
{
  StepResponse response{ .step = step, .fallen_ms = kNan };
  const auto finish = [&response](StepFault fault) {
    response.fault = fault;
    return response;
  };
  if (step.overlapped && recording.channels.size() == 1)
    return finish(StepFault::overlapped);
  StepSound sound(recording, channel, step);
  if (sound.is_truncated())
    return finish(StepFault::truncated);
  const double end = seconds(step.end - step.at);
  if (sound.has_dropout(0, end))
    return finish(StepFault::dropout);
  sound.listen(band);
  if (picture)
    *picture = { .rate = sound.raw().rate,
                 .first_s = sound.raw().first_s,
                 .raw = sound.raw().samples,
                 .amplitude = sound.plotted() };

  // The envelope after the end leaks into the time before it.
  const double steady_from = end * (1 - kSteadyShare);
  const double steady_to = end - kSmearS;
  response.hum = sound.hum();
  response.steady = sound.amplitude(steady_from, steady_to);
  response.before = step.start_volts > 0 ? sound.amplitude(-0.15, -0.005) : 0;
  response.snr_db = decibels(response.steady * response.steady, sound.noise());
  response.flat_crest = sound.flat_crest(steady_from, steady_to);
  if (sound.is_clipped(-0.1, end))
    return finish(StepFault::clipped);
  if (response.snr_db < kMotionSnrDb || response.steady < kSmeared * sound.loudest())
    return finish(StepFault::no_motion);
  if (response.snr_db < kLeastSnrDb)
    return finish(StepFault::noisy);
  // The noise limits how well the level of a stretch is known.
  const double middle = (steady_from + steady_to) / 2;
  const double uncertainty = sound.uncertainty(steady_to - middle);
  const double change
      = std::abs(sound.amplitude(steady_from, middle) - sound.amplitude(middle, steady_to));
  if (change > kSteadyChange * response.steady + uncertainty)
    return finish(StepFault::unsteady);
  const double strongest = std::max(response.steady, response.before);
  if ((response.steady - response.before) * (step.rises() ? 1 : -1)
      < std::max(kLeastChange * strongest, uncertainty))
    return finish(StepFault::missed);

  const GrowthCurve curve
      = sound.fit(kFitFromS, end - 0.01, response.before, response.steady, prior);
  response.onset_ms = 1e3 * curve.onset_s;
  response.exponent = curve.exponent;
  (step.rises() ? response.risen_ms : response.fallen_ms)
      = 1e3
        * curve.time_of(step.rises() ? 0.9 * curve.steady
                                     : std::lerp(curve.before, curve.steady, 0.9));
  if (!std::isfinite(response.onset_ms + response.risen_ms)
      || curve.rms > kIrregular * strongest + 2 * std::sqrt(sound.noise()))
    return finish(StepFault::irregular);
  response.steady = curve.steady;

  if (step.rises() && step.next > step.off) {
    const double to = seconds(step.next - step.at) - kSmearS;
    const GrowthCurve fall
        = sound.fit(end + kFitFromS, std::min(to, end + kFallS), response.steady, 0, {});
    const bool regular = fall.rms <= kIrregular * response.steady + 2 * std::sqrt(sound.noise());
    response.fallen_ms = regular ? 1e3 * (fall.time_of(0.1 * response.steady) - end) : kNan;
  }
  return response;
}

GrowthPrior
prior_of(const std::vector<StepResponse> &responses)
{
  std::vector<double> signals;
  for (const StepResponse &response : responses)
    if (response.fault == StepFault::none && response.step.rises())
      signals.push_back(response.snr_db);
  const double clear = median(signals);
  std::vector<double> onsets;
  std::vector<double> log_exponents;
  for (const StepResponse &response : responses)
    if (response.fault == StepFault::none && response.step.rises() && response.snr_db >= clear) {
      onsets.push_back(response.onset_ms / 1e3);
      // Rises from a level above 0 hardly depend on the exponent.
      if (response.step.start_volts == 0)
        log_exponents.push_back(std::log(response.exponent));
    }
  if (log_exponents.size() < kFewestInCommon)
    return {};
  const auto deviation = [](const std::vector<double> &values) {
    const double middle = median(values);
    std::vector<double> left;
    left.reserve(values.size());
    for (const double value : values)
      left.push_back(std::abs(value - middle));
    return 1.4826 * median(left);
  };
  return { .onset_s = median(onsets),
           .onset_deviation_s = std::max(deviation(onsets), kLeastOnsetDeviationS),
           .log_exponent = median(log_exponents),
           .log_exponent_deviation
           = std::max(1.2533 * deviation(log_exponents)
                          / std::sqrt(static_cast<double>(log_exponents.size())),
                      kLeastExponentDeviation) };
}

std::vector<StepResponse>
measure_steps(const std::vector<RecordedRun> &runs, int tactors, Band band)
{
  struct Look
  {
    const Recording *recording;
    StepResponse response;
  };
  const auto look = [&](const Recording &recording, const Step &step, const GrowthPrior &prior) {
    return measure_step(recording, recording.channel_of(step.tactor, tactors), step, band, prior);
  };
  std::map<int, std::vector<Look>> motors;
  for (const RecordedRun &run : runs)
    for (const Step &step : run.steps)
      motors[step.tactor].push_back({ &run.recording, look(run.recording, step, {}) });

  std::vector<StepResponse> responses;
  for (const auto &[tactor, looks] : motors) {
    std::vector<StepResponse> own;
    for (const Look &first : looks)
      own.push_back(first.response);
    mark_clipped(own);
    const GrowthPrior prior = prior_of(own);
    for (std::size_t i = 0; i < own.size(); i++)
      responses.push_back(own[i].fault == StepFault::none && own[i].step.rises()
                              ? look(*looks[i].recording, own[i].step, prior)
                              : own[i]);
  }
  return responses;
}

Band
band_of(const std::vector<RecordedRun> &runs, int tactors)
{
  double strongest = 0;
  double rate = 0;
  for (const RecordedRun &run : runs)
    for (const Step &step : run.steps) {
      strongest = std::max(strongest, step.target_volts);
      rate = run.recording.rate;
    }
  std::vector<double> lines;
  for (const RecordedRun &run : runs)
    for (const Step &step : run.steps) {
      if (step.target_volts < 0.9 * strongest || lines.size() >= kLinesForBand)
        continue;
      const int channel = run.recording.channel_of(step.tactor, tactors);
      const StepSound sound(run.recording, channel, step);
      const Window &window = sound.raw();
      const double end = seconds(step.end - step.at);
      const std::vector<double> passed
          = band_pass(window.part(0.6 * end, end), window.rate, { kLowestHz, 0.45 * window.rate });
      if (const double line = strongest_frequency(passed, window.rate); line > 0)
        lines.push_back(line);
    }
  if (lines.empty())
    return {};
  const double line = median(lines);
  return { .low_hz = std::max(line / 4, kLowestHz),
           .high_hz = std::max(std::min(2 * line, 0.45 * rate), 3 * kLowestHz) };
}

} // namespace tactor
