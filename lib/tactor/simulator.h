// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/csv_writer.h"
#include "tactor/driver.h"
#include "tactor/motor_model.h"

#include <optional>
#include <vector>

namespace tactor {

/// A chair without hardware: any number of tactors, each a MotorModel with the paper's parameters,
/// without latency or steps of voltage. With DriverConfig::device set, amplitudes are written to
/// that file as CSV (`time_ns,tactor_0,…`, volts): a line at each write, and one every 5 ms for at
/// most a second after a write. The columns are those of the first write, 9 at least.
class Simulator : public Driver
{
public:
  [[nodiscard]] tl::expected<void, DriverError> open(const DriverConfig &config) override;
  int tactors() const override;
  double resolution() const override;
  Time transport_latency() const override;
  [[nodiscard]] tl::expected<void, DriverError> write(std::span<const double> volts,
                                                      Time now) override;
  void close() noexcept override;
  DriverStatus status() const override;

  /// Amplitude of a tactor in volts; 0 for one that was never written.
  double amplitude(int tactor, Time time) const;

private:
  void record(Time time);

  int tactors_ = 0;
  std::vector<MotorModel> motors_; ///< as many as were written
  std::optional<Time> last_write_;
  std::optional<CsvWriter> csv_;
  std::size_t columns_ = 0;
};

} // namespace tactor
