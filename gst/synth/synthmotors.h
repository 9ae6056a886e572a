// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "nanoseconds.h"
#include "synthsettings.h"

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

/// The shakers of the channels: those of the calibration, and others with the time of `rise-time`.
class SynthMotors
{
public:
  /// Reads the calibration, if there is one. The error is one line.
  static tl::expected<SynthMotors, std::string> read(const SynthSettings &settings);

  std::vector<tactor::MotorParameters> of_channels(int channels) const;
  /// The tunings of the measured channels, up to the last one and to `most`.
  std::vector<synth::Tuning> tunings(int most) const;

  /// For tactor::PlannerSettings::max_lead.
  synth::Time max_lead() const;
  /// How much earlier than its map a sample may have to change; as synth::Play::lead().
  synth::Time lead() const;

private:
  tactor::MotorParameters other_;
  std::optional<tactor::Calibration> calibration_;
  std::vector<tactor::MotorParameters> measured_;
  synth::Time max_lead_{ 0 };
};
