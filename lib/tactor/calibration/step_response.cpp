// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/calibration/step_response.h"

#include "tactor/calibration/mains_hum.h"
#include "tactor/calibration/median.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>

namespace tactor {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Of the rest before and after a step, this much is listened to.
constexpr double kRestS = 0.5;
/// A motor may still run out for so long after its end.
constexpr double kRunOutS = 0.25;
/// The band-pass is not to be trusted this near to the ends.
constexpr double kMarginS = 0.05;
constexpr double kDropoutS = 0.01;
constexpr double kLeastSnrDb = 10;
constexpr double kMotionSnrDb = 3;
/// Of the time at the target, this much counts as steady, and may differ between its halves by so much.
constexpr double kSteadyShare = 0.4;
constexpr double kSteadyChange = 0.05;
constexpr double kLeastChange = 0.04;
constexpr double kIrregular = 0.12;
/// Motors are not more alike from step to step than this.
constexpr double kLeastOnsetDeviationS = 0.001;
constexpr double kLeastRoundnessDeviation = 0.03;
constexpr std::size_t kFewestInCommon = 5;
constexpr double kLowestHz = 8;
constexpr std::size_t kLinesForBand = 9;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// The part of a channel around a step; times in seconds after the command.
struct Window
{
  double rate = 0;
  double first_s = 0;
  std::vector<double> samples{};
  bool truncated = false;

  std::size_t index(double at_s) const
  {
    return static_cast<std::size_t>(
        std::clamp((at_s - first_s) * rate, 0.0, static_cast<double>(samples.size())));
  }
  std::span<const double> part(double from_s, double to_s) const
  {
    const std::size_t from = index(from_s);
    return std::span(samples).subspan(from, std::max(index(to_s), from) - from);
  }
};

Window
cut(const Recording &recording, std::span<const double> channel, const Step &step)
{
  const double rest
      = seconds(std::max(step.rest_begin, step.rest_end - Time(std::chrono::seconds(1))) - step.at);
  const double from = std::max(rest, seconds(step.rest_end - step.at) - kRestS - kRunOutS);
  const double to
      = std::min(seconds(step.next - step.at), seconds(step.off - step.at) + kRunOutS + kRestS);
  const double at = seconds(step.at - recording.start) * recording.rate;
  const auto sample = [&](double s) {
    return static_cast<long>(std::floor(at + s * recording.rate));
  };
  const long size = std::ssize(channel);
  const long first = std::clamp(sample(from), 0L, size);
  const long last = std::clamp(sample(to), first, size);
  Window window{ .rate = recording.rate,
                 .first_s = (static_cast<double>(first) - at) / recording.rate };
  window.samples.assign(channel.begin() + first, channel.begin() + last);
  window.truncated = sample(seconds(step.rest_end - step.at) - kMarginS) < 0
                     || sample(seconds(step.end - step.at)) > size;
  return window;
}

/// Whether samples are missing from what was heard of a motor: silence of every bit between its first and last sound.
bool
has_dropout(std::span<const double> samples, double rate)
{
  const auto longest = static_cast<std::size_t>(std::max(3.0, kDropoutS * rate));
  std::size_t silent = 0;
  bool heard = false;
  for (const double sample : samples) {
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

/// Whether crests are cut off: three samples in a row at the sensor's limit.
bool
is_clipped(std::span<const double> samples, double full_scale)
{
  double limit = full_scale * 0.999;
  if (full_scale <= 0)
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

/// Takes the trend out that a drifting sensor has.
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

/// Fewer samples of what is in the band, for what follows costs by the sample.
Window
thin_out(const Window &window, Band band)
{
  const auto every = static_cast<std::size_t>(std::max(1.0, window.rate / (8 * band.high_hz)));
  const std::vector<double> passed = band_pass(window.samples, window.rate, band);
  Window thin{ .rate = window.rate / static_cast<double>(every), .first_s = window.first_s };
  for (std::size_t i = 0; i < passed.size(); i += every)
    thin.samples.push_back(passed[i]);
  return thin;
}

double
mean_square(std::span<const double> samples)
{
  double sum = 0;
  for (const double sample : samples)
    sum += sample * sample;
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

double
decibels(double power, double reference)
{
  return 10 * std::log10(std::max(power, 1e-30) / std::max(reference, 1e-30));
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
  Window window = cut(recording, recording.channels.at(static_cast<std::size_t>(channel)), step);
  if (window.truncated)
    return finish(StepFault::truncated);
  const double end = seconds(step.end - step.at);
  if (has_dropout(window.part(0, end), window.rate))
    return finish(StepFault::dropout);
  const bool clipped = is_clipped(window.part(-0.1, end), recording.full_scale);

  if (picture)
    *picture = {
      .rate = window.rate, .first_s = window.first_s, .raw = window.samples, .amplitude = {}
    };
  level_out(window.samples, window.rate);
  Window thin = thin_out(window, band);
  const double rest_end = seconds(step.rest_end - step.at);
  const double rest_begin
      = std::max(seconds(step.rest_begin - step.at) + kRunOutS, thin.first_s + kMarginS);
  const double second_rest = seconds(step.off - step.at) + kRunOutS;
  std::vector<bool> rests(thin.samples.size());
  for (std::size_t i = 0; i < rests.size(); i++) {
    const double at = thin.first_s + static_cast<double>(i) / thin.rate;
    rests[i] = (at >= rest_begin && at < rest_end - 0.01)
               || (at >= second_rest
                   && i + static_cast<std::size_t>(kMarginS * thin.rate) < rests.size());
  }
  response.hum = remove_mains_hum(thin.samples, rests, thin.rate, band.high_hz);
  Window heard = thin;
  heard.samples = envelope(thin.samples, thin.rate, band);
  double noise = 0;
  for (std::size_t i = 0; i < rests.size(); i++)
    noise += rests[i] ? heard.samples[i] * heard.samples[i] : 0;
  noise /= static_cast<double>(std::max<std::ptrdiff_t>(std::ranges::count(rests, true), 1));
  if (picture) {
    // The envelope at the recording's own rate, to be drawn over it.
    const double share = thin.rate / window.rate;
    for (std::size_t i = 0; i < window.samples.size(); i++) {
      const auto at = std::min(static_cast<std::size_t>(static_cast<double>(i) * share),
                               heard.samples.size() - 1);
      picture->amplitude.push_back(heard.samples[at]);
    }
  }

  const auto amplitude = [&](double from, double to) {
    return std::sqrt(std::max(mean_square(heard.part(from, to)) - noise, 0.0));
  };
  const double steady_from = end * (1 - kSteadyShare);
  response.steady = amplitude(steady_from, end);
  response.before = step.start_volts > 0 ? amplitude(-0.15, -0.005) : 0;
  response.snr_db = decibels(response.steady * response.steady, noise);
  if (clipped)
    return finish(StepFault::clipped);
  if (response.snr_db < kMotionSnrDb)
    return finish(StepFault::no_motion);
  if (response.snr_db < kLeastSnrDb)
    return finish(StepFault::noisy);
  const double middle = (steady_from + end) / 2;
  // The level of a stretch is known no better than its noise, averaged, allows.
  const double looseness
      = 3 * std::sqrt(noise / std::max(1.0, (band.high_hz - band.low_hz) * (end - middle)));
  const double change = std::abs(amplitude(steady_from, middle) - amplitude(middle, end));
  if (change > kSteadyChange * response.steady + looseness)
    return finish(StepFault::unsteady);

  if (step.off == step.end && step.next > step.off) {
    const double goal = 0.01 * response.steady * response.steady + noise;
    for (double at = end; at < seconds(step.next - step.at) - 0.01; at += 0.001)
      if (mean_square(heard.part(at - 0.004, at + 0.004)) <= goal) {
        response.fallen_ms = 1e3 * (at - end);
        break;
      }
  }
  if (!step.rises())
    return response;
  if (response.steady - response.before < std::max(kLeastChange * response.steady, looseness))
    return finish(StepFault::missed);

  const GrowthCurve curve = fit_growth(
      heard.part(-0.1, end - 0.01), heard.rate,
      thin.first_s + static_cast<double>(heard.index(-0.1)) / heard.rate, response.before,
      response.steady, noise, (band.high_hz - band.low_hz) / heard.rate, prior);
  response.onset_ms = 1e3 * curve.onset_s;
  response.roundness = curve.roundness;
  response.risen_ms = 1e3 * curve.time_of(0.9 * curve.steady);
  if (!std::isfinite(response.risen_ms)
      || curve.rms > kIrregular * curve.steady + 2 * std::sqrt(noise))
    return finish(StepFault::irregular);
  response.steady = curve.steady;
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
  std::vector<double> roundness;
  for (const StepResponse &response : responses)
    if (response.fault == StepFault::none && response.step.rises() && response.snr_db >= clear) {
      onsets.push_back(response.onset_ms / 1e3);
      roundness.push_back(std::log(response.roundness));
    }
  if (onsets.size() < kFewestInCommon)
    return {};
  const auto deviation = [](const std::vector<double> &values) {
    std::vector<double> left;
    for (const double value : values)
      left.push_back(std::abs(value - median(values)));
    return 1.4826 * median(left);
  };
  return { .onset_s = median(onsets),
           .onset_deviation_s = std::max(deviation(onsets), kLeastOnsetDeviationS),
           .log_roundness = median(roundness),
           .log_roundness_deviation = std::max(deviation(roundness), kLeastRoundnessDeviation) };
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
    const GrowthPrior prior = prior_of(own);
    for (const auto &[recording, response] : looks)
      responses.push_back(response.fault == StepFault::none && response.step.rises()
                              ? look(*recording, response.step, prior)
                              : response);
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
      const Window window
          = cut(run.recording, run.recording.channels[static_cast<std::size_t>(channel)], step);
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
