// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"

#include <atomic>
#include <memory>

namespace tactor {

/// Opens a board if one can be used, else the simulator; a DriverEvent names it, and the reason.
/// Devices that are not known to be tactor boards are not opened (DriverConfig::asks_a_stranger).
/// Without a board it opens at once. It fails as the board's driver does if DriverConfig::device
/// names a board, or if the board does not fit the settings.
class AutoDriver : public Driver
{
public:
  AutoDriver(std::unique_ptr<Driver> board, std::unique_ptr<Driver> simulator);
  ~AutoDriver() override;

  [[nodiscard]] tl::expected<void, DriverError> open(const DriverConfig &config) override;
  int tactors() const override;
  Layout layout() const override;
  double resolution() const override;
  Time transport_latency() const override;
  Time longest_latency() const override;
  LineTime line() const override;
  Time refresh_interval() const override;
  std::shared_ptr<DeviceAccount> account() const override;
  [[nodiscard]] tl::expected<void, DriverError> write(std::span<const double> volts,
                                                      Time now) override;
  void close() noexcept override;
  DriverStatus status() const override;

private:
  const std::unique_ptr<Driver> board_;
  const std::unique_ptr<Driver> simulator_;
  std::atomic<Driver *> chosen_;
};

} // namespace tactor
