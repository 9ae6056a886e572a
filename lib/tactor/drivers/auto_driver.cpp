// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/auto_driver.h"

#include "tactor/drivers/last_device.h"

#include <mutex>
#include <set>
#include <utility>

namespace tactor {

namespace {

/// Whether this was not yet said in this process: a device that is no board may be plugged in for
/// good.
bool
is_news(const std::string &text)
{
  struct Said
  {
    std::mutex mutex;
    std::set<std::string> texts; ///< guarded by the mutex
  };
  static auto *said = new Said; // never destroyed, as threads may play while the process exits
  const std::lock_guard lock(said->mutex);
  return said->texts.insert(text).second;
}

} // namespace

AutoDriver::AutoDriver(std::unique_ptr<Driver> board, std::unique_ptr<Driver> simulator)
    : board_(std::move(board)), simulator_(std::move(simulator)), chosen_(board_.get())
{
}

AutoDriver::~AutoDriver()
{
  AutoDriver::close();
}

tl::expected<void, DriverError>
AutoDriver::open(const DriverConfig &config)
{
  close();
  chosen_ = board_.get();
  DriverConfig careful = config;
  careful.asks_a_stranger = false; // the user has not said that there is a board
  const tl::expected<void, DriverError> board = board_->open(careful);
  if (board)
    return {};
  const auto &[kind, why] = board.error();
  if (!config.device.empty() && kind == DriverError::Kind::not_found)
    return tl::unexpected(DriverError{
        kind, why + "; to have predicted amplitudes written to a file, set driver=simulator" });
  if (!config.device.empty() || kind == DriverError::Kind::settings || config.stop.stop_requested())
    return tl::unexpected(board.error());
  chosen_ = simulator_.get();
  if (tl::expected<void, DriverError> simulated = simulator_->open(config); !simulated)
    return simulated;
  // A device that cannot be used, or was not probed, may or may not be the one meant.
  const bool may_be_there
      = kind == DriverError::Kind::not_asked ? is_news(why) : kind != DriverError::Kind::not_found;
  const std::optional<LastDevice> last = last_device();
  if (config.notify)
    config.notify({ may_be_there ? DriverEvent::Kind::warning : DriverEvent::Kind::opened,
                    "the motors are simulated: " + why
                        + (last ? "; the last device was " + last->board : "") });
  return {};
}

int
AutoDriver::tactors() const
{
  return chosen_.load()->tactors();
}

Layout
AutoDriver::layout() const
{
  return chosen_.load()->layout();
}

double
AutoDriver::resolution() const
{
  return chosen_.load()->resolution();
}

Time
AutoDriver::transport_latency() const
{
  return chosen_.load()->transport_latency();
}

Time
AutoDriver::longest_latency() const
{
  return chosen_.load()->longest_latency();
}

LineTime
AutoDriver::line() const
{
  return chosen_.load()->line();
}

std::shared_ptr<DeviceAccount>
AutoDriver::account() const
{
  return chosen_.load()->account();
}

Time
AutoDriver::refresh_interval() const
{
  return chosen_.load()->refresh_interval();
}

tl::expected<void, DriverError>
AutoDriver::write(std::span<const double> volts, Time now)
{
  return chosen_.load()->write(volts, now);
}

void
AutoDriver::close() noexcept
{
  board_->close();
  simulator_->close();
}

DriverStatus
AutoDriver::status() const
{
  return chosen_.load()->status();
}

} // namespace tactor
