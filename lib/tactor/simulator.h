// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/csv_writer.h"
#include "tactor/driver.h"
#include "tactor/motor_model.h"

#include <optional>
#include <vector>

namespace tactor {

/// A chair without hardware, and the same whatever is known of a real one: a MotorModel of the
/// paper's per tactor, any number of them, no latency, no steps. With DriverConfig::device set, the
/// amplitude of every motor is written there as CSV (`time_ns,tactor_0,…`, volts): a line at each
/// write, and one every 5 ms in between, for at most one second after a write. The columns are
/// those of the first write, 9 at least. Threads as every Driver.
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

  /// Predicted amplitude of a tactor in volts; 0 for one that was never written to.
  double amplitude(int tactor, Time time) const;

private:
  void record(Time time);

  int tactors_ = 0;
  std::vector<MotorModel> motors_; ///< as many as were written to
  std::optional<Time> last_write_;
  std::optional<CsvWriter> csv_;
  std::size_t columns_ = 0;
};

} // namespace tactor
