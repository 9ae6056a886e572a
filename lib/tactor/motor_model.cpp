// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/motor_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactor {

namespace {

/// Shares of a step at which a rise and a fall are over (paper, Section 4).
constexpr double kRisen = 0.9;
constexpr double kLeft = 1 - kRisen;

/// A motor below this share of its hold volts has stopped.
constexpr double kTurns = 0.5;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

} // namespace

MotorModel::MotorModel(MotorParameters parameters) : parameters_(std::move(parameters))
{
}

MotorModel::MotorModel(RiseTime rise_time)
    : MotorModel(MotorParameters{ .rise_time = std::move(rise_time) })
{
}

void
MotorModel::set(Time time, double volts)
{
  if (volts == volts_)
    return;
  from_ = amplitude(time);
  since_ = std::max(time, since_);
  volts_ = volts;
  const bool turns = from_ > 0 && from_ >= kTurns * parameters_.hold_volts;
  steady_ = volts >= (turns ? parameters_.hold_volts : parameters_.start_volts) ? volts : 0;

  if (from_ < kRisen * steady_) {
    const double rise = seconds(parameters_.rise_time(from_, steady_));
    if (rise > 0) {
      rate_ = std::log((steady_ - from_) / (kLeft * steady_)) / rise;
    } else {
      from_ = steady_;
      rate_ = 0;
    }
  } else {
    rate_ = -std::log(kLeft) / seconds(parameters_.fall_time);
  }
}

double
MotorModel::amplitude(Time time) const
{
  if (rate_ == 0 || time <= since_)
    return from_;
  return steady_ + (from_ - steady_) * std::exp(-rate_ * seconds(time - since_));
}

double
MotorModel::volts() const
{
  return volts_;
}

const MotorParameters &
MotorModel::parameters() const
{
  return parameters_;
}

Time
overdrive_time(const RiseTime &rise_time, double drive_volts, double volts)
{
  if (!(volts > 0 && volts < drive_volts))
    return Time(0);
  const double share = std::log10(drive_volts / (drive_volts - kRisen * volts));
  return Time(std::llround(share * static_cast<double>(rise_time(0, drive_volts).count())));
}

} // namespace tactor
