// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/motor_model.h"
#include "tactor/rise_time.h"
#include "tactor/time.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// Rise times as a quadratic form of start voltage s and offset d = target − start, in the order of
/// the paper's Eq. 1: milliseconds for 1, d, s, d², d·s, s².
struct QuadraticRiseTime
{
  std::array<double, 6> coefficients{};
  std::array<double, 6> confidence{}; ///< half width of each one's 95 % interval
  double r_squared = 0;
  double residual_ms = 0; ///< root mean square of what the fit leaves

  /// As it is fitted: neither clamped nor monotone.
  double operator()(double start_volts, double offset_volts) const;
  /// The same on a grid, clamped at 0.
  RiseTimeTable table(double volts_max) const;
};

/// Steady vibration at a voltage, in the unit of the recording it comes from.
struct VibrationPoint
{
  double volts = 0;
  double amplitude = 0;
};

/// What was measured of one tactor. Its rise times are the table's or the quadratic's, whichever is
/// there or, of both, preferred; without either they are the paper's.
struct TactorCalibration
{
  /// From the driver's being told to the first motion; unknown where no common clock was.
  std::optional<Time> latency{};
  double start_volts = kStartVolts;
  double hold_volts = kStartVolts;
  Time fall_time = kFallTime;
  std::optional<RiseTimeTable> table{};
  std::optional<QuadraticRiseTime> quadratic{};
  bool prefers_quadratic = false;          ///< it is nearer to what was measured than the table
  std::vector<VibrationPoint> vibration{}; ///< rising in both; empty: linear in the voltage
  int steps_used = 0;
  int steps_refused = 0;

  RiseTime rise_time() const;
};

/// What was measured of a chair's motors, and how. As a file it is a key file
/// (docs/guide/calibration.md).
struct Calibration
{
  static constexpr int kVersion = 1;

  std::string motor{};  ///< which motors they are, in words
  std::string date{};   ///< ISO 8601
  std::string method{}; ///< sensor, band, steps, in words
  /// Felt intensity grows as vibration amplitude to this power: 0.95 at 60 Hz, 0.6 at 250 Hz
  /// (Stevens 1959, on the finger).
  double perception_exponent = 0.95;
  std::map<int, TactorCalibration> tactors{}; ///< by index

  /// Motors for the tactors 0…n − 1 as a planner wants them, n being one more than the last tactor
  /// measured; those between that were not measured are the paper's. Levels become volts so that
  /// what is felt is linear in the level, and equally strong on all tactors: level 1 is what the
  /// weakest of them makes of volts_max.
  std::vector<MotorParameters> motors(double volts_max) const;

  /// The longest that any motor takes from the driver's being told to 90 %.
  Time longest_lead() const;
};

/// Reads a key file of at most 64 MiB. An error is a line with file, group, key, what was expected
/// and what came.
tl::expected<Calibration, std::string> read_calibration(const std::string &path);

/// Writes a key file, whole or not at all. An error is a line with the file and the reason.
tl::expected<void, std::string> write_calibration(const Calibration &calibration,
                                                  const std::string &path);

} // namespace tactor
