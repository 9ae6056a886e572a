// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthmotors.h"

#include "synth/play.h"

#include <algorithm>
#include <cmath>
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
  for (std::size_t i = 0; i < std::min(motors.size(), measured_.size()); i++) {
    const auto found = calibration_->tactors.find(static_cast<int>(i));
    if (found == calibration_->tactors.end())
      continue;
    if (found->second.table || found->second.quadratic) {
      motors[i] = measured_[i];
    } else { // without rise times it is no coin motor
      motors[i].latency = measured_[i].latency;
      motors[i].level_volts = measured_[i].level_volts;
    }
  }
  return motors;
}

std::vector<synth::Tuning>
SynthMotors::tunings(int most) const
{
  std::vector<synth::Tuning> tunings;
  if (!calibration_)
    return tunings;
  for (const auto &[index, tactor] : calibration_->tactors) {
    if (index >= most)
      break;
    tunings.resize(static_cast<std::size_t>(index) + 1);
    tunings.back() = { .gain = std::pow(10, tactor.gain_db / 20), .equalizer = tactor.equalizer };
  }
  return tunings;
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
