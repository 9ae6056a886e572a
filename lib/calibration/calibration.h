// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "synth/equalizer.h"
#include "tactor/motor_model.h"
#include "tactor/rise_time.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// Rise times as a quadratic form of start voltage s and offset d = target − start, in the order of
/// the paper's Eq. 1: coefficients in milliseconds of 1, d, s, d², d·s, s².
struct QuadraticRiseTime
{
  std::array<double, 6> coefficients{};
  std::array<double, 6> confidence{}; ///< half width of each coefficient's 95 % confidence interval
  double r_squared = 0;
  double residual_ms = 0; ///< root mean square of the residuals

  /// The fitted value in milliseconds, neither clamped nor monotone.
  double operator()(double start_volts, double offset_volts) const;
  /// The form on a grid of 0…volts_max, clamped at 0.
  RiseTimeTable table(double volts_max) const;
};

/// Steady vibration at a voltage, in the recording's unit.
struct VibrationPoint
{
  double volts = 0;
  double amplitude = 0;
};

/// The measured parameters of one tactor. Rise times come from the table or the quadratic form;
/// prefers_quadratic decides if there are both. Without either, the paper's are used.
struct TactorCalibration
{
  /// From the command to the first motion; unknown without a common clock.
  std::optional<Time> latency{};
  double start_volts = kStartVolts;
  double hold_volts = kStartVolts;
  Time fall_time = kFallTime;
  std::optional<RiseTimeTable> table{};
  std::optional<QuadraticRiseTime> quadratic{};
  bool prefers_quadratic = false;          ///< it fits the measurements better than the table
  std::vector<VibrationPoint> vibration{}; ///< both values rise; empty: proportional to the voltage
  /// Gain and equalizer of a channel of sound. No measurement sets them.
  double gain_db = 0;
  std::vector<synth::EqualizerBand> equalizer{};
  int steps_used = 0;
  int steps_refused = 0;

  /// Rise times for a planner; the paper's if none were measured.
  RiseTime rise_time() const;
};

/// The measured parameters of a chair's motors, and how they were measured. Stored as a key file
/// (docs/guide/calibration.md).
struct Calibration
{
  static constexpr int kVersion = 1;

  std::string motor{};  ///< type of motors, free text
  std::string date{};   ///< ISO 8601
  std::string method{}; ///< sensor, band and steps, free text
  /// Felt intensity is vibration amplitude to this power: 0.95 at 60 Hz, 0.6 at 250 Hz (Stevens
  /// 1959, on the finger).
  double perception_exponent = 0.95;
  std::map<int, TactorCalibration> tactors{}; ///< by index

  /// Motor parameters for a planner, for tactors 0…n − 1 where n − 1 is the last one measured.
  /// Tactors in between that were not measured get the paper's parameters. Levels map to volts so
  /// that felt intensity is linear in the level and equal on all tactors: level 1 is the intensity
  /// of the weakest tactor at `volts_max`.
  std::vector<MotorParameters> motors(double volts_max) const;

  /// The longest time from a command to 90 % of any motor.
  Time longest_lead() const;
};

/// Reads a key file of at most 64 MiB. An error is one line with file, group, key, what was
/// expected and what was found.
tl::expected<Calibration, std::string> read_calibration(const std::string &path);

/// Writes a key file atomically. An error is one line with the file and the reason.
tl::expected<void, std::string> write_calibration(const Calibration &calibration,
                                                  const std::string &path);

} // namespace tactor
