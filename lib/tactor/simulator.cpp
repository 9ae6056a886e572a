// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/simulator.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tactor {

namespace {

constexpr Time kStep = std::chrono::milliseconds(5);
constexpr Time kTail = std::chrono::seconds(1); ///< every motor has settled by then
constexpr std::size_t kFewestColumns = 9;

} // namespace

tl::expected<void, DriverError>
Simulator::open(const DriverConfig &config)
{
  close();
  if (config.max_tactors < 1 || config.max_tactors > 4096)
    return tl::unexpected(
        DriverError{ DriverError::Kind::settings,
                     "a chair has 1 to 4096 tactors, not " + std::to_string(config.max_tactors) });
  if (!config.device.empty()) {
    tl::expected<CsvWriter, DriverError> csv = CsvWriter::create(config.device);
    if (!csv)
      return tl::unexpected(csv.error());
    csv_ = std::move(*csv);
  }
  tactors_ = config.max_tactors;
  return {};
}

int
Simulator::tactors() const
{
  return tactors_;
}

double
Simulator::resolution() const
{
  return 0;
}

Time
Simulator::transport_latency() const
{
  return Time(0);
}

tl::expected<void, DriverError>
Simulator::write(std::span<const double> volts, Time now)
{
  if (last_write_ && now < *last_write_) {
    // Running time restarted.
    motors_.clear();
    last_write_.reset();
  }
  if (csv_ && last_write_)
    for (Time time = *last_write_ + kStep; time < std::min(now, *last_write_ + kTail);
         time += kStep)
      record(time);

  motors_.resize(
      std::max(motors_.size(), std::min(volts.size(), static_cast<std::size_t>(tactors_))));
  for (std::size_t i = 0; i < motors_.size(); i++)
    motors_[i].set(now, i < volts.size() ? volts[i] : 0.0);
  last_write_ = now;
  if (csv_) {
    record(now);
    if (csv_->failed())
      return tl::unexpected(DriverError{
          DriverError::Kind::failed, "cannot write the predicted amplitudes: is the disk full?" });
  }
  return {};
}

void
Simulator::record(Time time)
{
  if (columns_ == 0) {
    columns_ = std::max(motors_.size(), kFewestColumns);
    csv_->field("time_ns");
    for (std::size_t i = 0; i < columns_; i++)
      csv_->field("tactor_" + std::to_string(i));
    csv_->end_line();
  }
  csv_->field(std::int64_t{ time.count() });
  for (std::size_t i = 0; i < columns_; i++)
    csv_->field(amplitude(static_cast<int>(i), time));
  csv_->end_line();
}

void
Simulator::close() noexcept
{
  csv_.reset();
  motors_.clear();
  last_write_.reset();
  columns_ = 0;
  tactors_ = 0;
}

DriverStatus
Simulator::status() const
{
  DriverStatus status;
  status.board = "simulator";
  return status;
}

double
Simulator::amplitude(int tactor, Time time) const
{
  const auto index = static_cast<std::size_t>(tactor);
  return index < motors_.size() ? motors_[index].amplitude(time) : 0.0;
}

} // namespace tactor
