// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/growth_curve.h"
#include "calibration/recording.h"
#include "calibration/step.h"
#include "nanoseconds.h"

#include <string_view>
#include <vector>

namespace tactor {

/// Why a step is excluded from the averages.
enum class StepFault
{
  none,
  no_motion,  ///< only noise after the command
  missed,     ///< no change, although other steps show that there should be one
  clipped,    ///< the vibration exceeds the sensor's range
  noisy,      ///< the steady vibration is less than 10 dB above the noise
  unsteady,   ///< the level drifts where it should be steady
  dropout,    ///< missing samples: 10 ms of zeros within the vibration
  truncated,  ///< not entirely within the recording
  overlapped, ///< another tactor was on in the same channel
  irregular,  ///< the envelope is not a rise to a level
  outlier,    ///< far from the other repetitions
};

/// One or two words, such as "no motion".
std::string_view fault_name(StepFault fault);

/// The envelope around a step, for plots.
struct StepEnvelope
{
  double rate = 0;    ///< samples per second
  double first_s = 0; ///< time of the first sample, in seconds after the command
  std::vector<double> raw{};
  std::vector<double> amplitude{};
};

/// Measurements of one step. Amplitudes are in the recording's unit, with the noise power
/// subtracted. Times are counted from the command and include the latency of the chain.
struct StepResponse
{
  Step step{};
  StepFault fault = StepFault::none;
  double before = 0;   ///< amplitude at the start voltage
  double steady = 0;   ///< amplitude at the target voltage
  double exponent = 1; ///< GrowthCurve::exponent; rising steps only
  double onset_ms = 0; ///< first motion
  double risen_ms = 0; ///< time to 90 % of the steady amplitude; rising steps only
  /// Time until 10 % of a fall is left; NaN if not seen. For a rising step it is the fall to rest
  /// at its end, counted from there.
  double fallen_ms = 0;
  double snr_db = 0;     ///< steady vibration relative to the noise at rest, within the band
  double hum = 0;        ///< RMS of the mains hum that was removed
  double flat_crest = 0; ///< StepSound::flat_crest() of the steady part
};

/// Measures a step in one channel of a recording. `picture`, if given, receives the envelope.
///
/// The recording is band-passed and mains hum is removed. A GrowthCurve is then fitted to the
/// Hilbert envelope of the whole rise or fall. The noise power is added to the curve, and it is
/// smeared like the envelope. Thus neither noise near the 90 % point nor the band-pass biases the
/// result.
StepResponse measure_step(const Recording &recording, int channel, const Step &step, Band band,
                          const GrowthPrior &prior = {}, StepEnvelope *picture = nullptr);

/// Prior for a second pass over the steps of one motor: onset and exponent of the rises with a
/// good signal-to-noise ratio. It makes the fits of the others robust against noise.
GrowthPrior prior_of(const std::vector<StepResponse> &responses);

/// A recording and the steps played during it.
struct RecordedRun
{
  Recording recording{};
  std::vector<Step> steps{};
};

/// Responses to all steps, ordered by tactor, with two passes per motor. `tactors`: the chair's
/// number of tactors (Recording::channel_of()).
std::vector<StepResponse> measure_steps(const std::vector<RecordedRun> &runs, int tactors,
                                        Band band);

/// A band for all steps: from a quarter to twice the frequency at which the motors vibrate at the
/// highest voltages.
Band band_of(const std::vector<RecordedRun> &runs, int tactors);

} // namespace tactor
