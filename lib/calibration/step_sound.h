// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/growth_curve.h"
#include "calibration/recording.h"
#include "calibration/step.h"

#include <span>
#include <vector>

namespace tactor {

/// Samples at one rate; times are in seconds after a step's command.
struct Window
{
  double rate = 0;
  double first_s = 0;
  std::vector<double> samples{};

  /// Index of the sample at `at_s`, clamped to [0, samples.size()].
  std::size_t index(double at_s) const;
  double time(std::size_t index) const;
  std::span<const double> part(double from_s, double to_s) const;
};

/// The part of a channel around a step, from the rest before it to the rest after it.
class StepSound
{
public:
  StepSound(const Recording &recording, int channel, const Step &step);

  /// The recorded samples.
  const Window &raw() const;
  /// Whether the step is not entirely recorded.
  bool is_truncated() const;
  /// Whether samples are missing: 10 ms of exact zeros between nonzero samples of [from, to).
  bool has_dropout(double from_s, double to_s) const;
  /// Whether crests are clipped: at least three times three samples in a row at the limit of the
  /// sensor's range or, if that is unknown, at the largest sample.
  bool is_clipped(double from_s, double to_s) const;
  /// The height of flat crests in a steady part, or 0 if there are none: more samples near the
  /// extreme than a sine has. An amplifier before the sensor causes them; a motor may, too.
  double flat_crest(double from_s, double to_s) const;

  /// Selects a band: removes trend and mains hum, then computes the Hilbert envelope. Required by
  /// all that follow.
  void listen(Band band);
  /// RMS of the hum that was removed.
  double hum() const;
  /// Mean square of the envelope at rest.
  double noise() const;
  /// Maximum of the envelope.
  double loudest() const;
  /// RMS amplitude in [from, to), with the noise power subtracted.
  double amplitude(double from_s, double to_s) const;
  /// How far two such amplitudes may differ due to noise (3 σ), for a stretch of this duration.
  double uncertainty(double seconds) const;
  /// Fits the transition between two levels in [from, to), up or down. The curve is passed through
  /// the band-pass and the Hilbert transform, which smear it, before comparison.
  GrowthCurve fit(double from_s, double to_s, double before, double after,
                  const GrowthPrior &prior) const;
  /// The envelope resampled to the recording's rate, for plots.
  std::vector<double> plotted() const;

private:
  Step step_;
  double full_scale_;
  bool truncated_;
  Window raw_{};
  Band band_{};
  Window passed_{}; ///< band-passed, without hum, at a lower rate
  Window envelope_{};
  double hum_ = 0;
  double noise_ = 0;
};

} // namespace tactor
