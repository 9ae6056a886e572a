// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthmotors.h"

#include "synth/play.h"

#include <algorithm>
#include <utility>

using synth::Time;

tl::expected<SynthMotors, std::string>
SynthMotors::read(const SynthSettings &settings)
{
  SynthMotors motors;
  motors.other_ = synth::shaker(settings.rise_time, settings.volts_max);
  motors.max_lead_ = settings.rise_time;
  if (settings.calibration.empty())
    return motors;
  tl::expected<tactor::Calibration, std::string> calibration
      = tactor::read_calibration(settings.calibration);
  if (!calibration)
    return tl::unexpected(calibration.error());
  motors.measured_ = calibration->motors(settings.volts_max);
  motors.max_lead_
      = std::clamp(calibration->longest_lead(), motors.max_lead_, Time(std::chrono::seconds(1)));
  motors.calibration_ = std::move(*calibration);
  return motors;
}

std::vector<tactor::MotorParameters>
SynthMotors::of_channels(int channels) const
{
  std::vector<tactor::MotorParameters> motors(static_cast<std::size_t>(channels), other_);
  for (std::size_t i = 0; i < std::min(motors.size(), measured_.size()); i++)
    if (calibration_->tactors.contains(static_cast<int>(i)))
      motors[i] = measured_[i];
  return motors;
}

Time
SynthMotors::max_lead() const
{
  return max_lead_;
}

Time
SynthMotors::lead() const
{
  Time slowest{ 0 };
  for (const tactor::MotorParameters &motor : measured_)
    slowest = std::max(slowest, motor.latency.value_or(Time(0)));
  return max_lead_ + slowest + synth::Play::kRamp / 2;
}
