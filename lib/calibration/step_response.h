// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/growth_curve.h"
#include "calibration/recording.h"
#include "calibration/step.h"
#include "tactor/time.h"

#include <string_view>
#include <vector>

namespace tactor {

/// Why a step is not averaged in.
enum class StepFault
{
  none,
  no_motion,  ///< nothing but noise is heard after the command
  missed,     ///< nothing changed with the command, though other steps say that it should have
  clipped,    ///< the sensor's range ended before the vibration did
  noisy,      ///< the steady vibration is less than 10 dB above the noise
  unsteady,   ///< the level drifts where it should be steady
  dropout,    ///< samples are missing: 10 ms of zeros amid the vibration
  truncated,  ///< the recording does not hold all of it
  overlapped, ///< another tactor was on meanwhile and heard by the same channel
  irregular,  ///< the envelope is no rise to a level
  outlier,    ///< far from the other repetitions
};

/// One or two words, as in `clipped`.
std::string_view fault_name(StepFault fault);

/// The envelope around a step, for pictures.
struct StepEnvelope
{
  double rate = 0;    ///< samples per second
  double first_s = 0; ///< time of the first sample after the command, in seconds
  std::vector<double> raw{};
  std::vector<double> amplitude{};
};

/// What a recording tells of one step. Amplitudes are in the recording's unit, noise taken off;
/// times count from when the driver was told, latency of the chain included.
struct StepResponse
{
  Step step{};
  StepFault fault = StepFault::none;
  double before = 0;    ///< amplitude at the start voltage
  double steady = 0;    ///< amplitude at the target voltage
  double roundness = 1; ///< GrowthCurve::roundness; rising steps only
  double onset_ms = 0;  ///< first motion towards it
  double risen_ms = 0;  ///< 90 % of the steady amplitude; rising steps only
  /// 10 % of a fall left: of a falling step's own, of the one to rest at a rising step's end,
  /// counted from there; NaN where not seen.
  double fallen_ms = 0;
  double snr_db = 0;     ///< of the steady vibration to what is heard at rest, within the band
  double hum = 0;        ///< RMS of the mains hum that was taken out
  double flat_crest = 0; ///< StepSound::flat_crest() of the steady part
};

/// Measures a step in one channel of a recording. `picture`, if given, gets the envelope.
///
/// The recording is band-passed, mains hum that is heard at rest is taken out, and to its Hilbert
/// envelope a GrowthCurve is fitted from the whole rise or fall, noise added in power and smeared
/// as the envelope is, so that neither noise at the moment of the 90 % nor the band-pass matters.
StepResponse measure_step(const Recording &recording, int channel, const Step &step, Band band,
                          const GrowthPrior &prior = {}, StepEnvelope *picture = nullptr);

/// What the steps of one motor have in common: latency and roundness of the rises that are clear.
/// For a second look at all of them, which is then less at the mercy of noise.
GrowthPrior prior_of(const std::vector<StepResponse> &responses);

/// A recording and what was played meanwhile.
struct RecordedRun
{
  Recording recording{};
  std::vector<Step> steps{};
};

/// The responses to all steps, tactor by tactor, each motor's looked at twice. `tactors` is how
/// many the chair has (Recording::channel_of()).
std::vector<StepResponse> measure_steps(const std::vector<RecordedRun> &runs, int tactors,
                                        Band band);

/// A band for all steps: from a quarter of the frequency at which the strongest driven motors
/// vibrate to twice that.
Band band_of(const std::vector<RecordedRun> &runs, int tactors);

} // namespace tactor
