// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/growth_curve.h"
#include "calibration/recording.h"
#include "calibration/step.h"

#include <span>
#include <vector>

namespace tactor {

/// Samples of one rate; times in seconds after a step's command.
struct Window
{
  double rate = 0;
  double first_s = 0;
  std::vector<double> samples{};

  std::size_t index(double at_s) const;
  double time(std::size_t index) const;
  std::span<const double> part(double from_s, double to_s) const;
};

/// The part of a channel around a step, from the rest before to the rest after.
class StepSound
{
public:
  StepSound(const Recording &recording, int channel, const Step &step);

  /// As it was recorded.
  const Window &raw() const;
  /// It does not hold the whole step.
  bool is_truncated() const;
  /// Samples are missing: 10 ms of zeros of every bit between the first and the last sound of
  /// [from, to).
  bool has_dropout(double from_s, double to_s) const;
  /// Crests are cut off at the end of the sensor's range: three times three samples in a row. Where
  /// that is unknown, at the greatest sample.
  bool is_clipped(double from_s, double to_s) const;
  /// Where the crests of a steady part are flat, more samples being near the extreme than a sine
  /// has there; 0 if they are not. An amplifier before the sensor's own limit makes such; a motor
  /// may, too.
  double flat_crest(double from_s, double to_s) const;

  /// Looks at a band: takes trend and mains hum out, then the Hilbert envelope. What follows needs
  /// it.
  void listen(Band band);
  /// RMS of the hum that was taken out.
  double hum() const;
  /// Mean square of the envelope at rest.
  double noise() const;
  /// The envelope's maximum.
  double loudest() const;
  /// Amplitude in [from, to), root mean square, the noise's power taken off.
  double amplitude(double from_s, double to_s) const;
  /// How far two such amplitudes of a stretch so long may differ by the noise.
  double looseness(double seconds) const;
  /// How the amplitude gets from one level to another in [from, to), up or down. The curve is
  /// compared as band-pass and Hilbert transform, which smear it, would show it.
  GrowthCurve fit(double from_s, double to_s, double before, double after,
                  const GrowthPrior &prior) const;
  /// The envelope at the recording's own rate, to be drawn over it.
  std::vector<double> drawn() const;

private:
  Step step_;
  double full_scale_;
  bool truncated_;
  Window raw_{};
  Band band_{};
  Window passed_{}; ///< in the band, without hum, at a lower rate
  Window envelope_{};
  double hum_ = 0;
  double noise_ = 0;
};

} // namespace tactor
