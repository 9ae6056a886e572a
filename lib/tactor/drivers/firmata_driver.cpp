// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/firmata_driver.h"

#include "tactor/unlocked.h"

#include <algorithm>
#include <utility>

namespace tactor {

namespace {

constexpr Time kTryBusyAgain = std::chrono::milliseconds(50);

} // namespace

FirmataDriver::FirmataDriver(Firmware firmware, MakeBus make_bus)
    : FirmataDriver(firmware, std::move(make_bus), Settings{})
{
}

FirmataDriver::FirmataDriver(Firmware firmware, MakeBus make_bus, Settings settings)
    : firmware_(firmware), make_bus_(std::move(make_bus)), settings_(std::move(settings)),
      known_boards_(settings_.known_boards)
{
}

FirmataDriver::~FirmataDriver()
{
  FirmataDriver::close();
}

/* ---- the caller's side ---- */

void
FirmataDriver::reset()
{
  bus_changed_ = false;
  opening_ = std::stop_source();
  bytes_before_ = 0;
  resolution_ = 0;
  line_ = {};
}

void
FirmataDriver::wake(Lock &lock)
{
  std::stop_source opening = opening_;
  lock.unlock();
  opening.request_stop();
}

double
FirmataDriver::resolution() const
{
  std::lock_guard lock(mutex_);
  return resolution_;
}

Time
FirmataDriver::transport_latency() const
{
  std::lock_guard lock(mutex_);
  return line_.all();
}

LineTime
FirmataDriver::line() const
{
  std::lock_guard lock(mutex_);
  return line_;
}

Time
FirmataDriver::refresh_interval() const
{
  return settings_.patience.keepalive;
}

DriverStatus
FirmataDriver::status() const
{
  std::lock_guard lock(mutex_);
  DriverStatus status = status_now();
  status.bytes = bytes_before_ + (board_ ? board_->bytes_sent() : 0);
  return status;
}

/* ---- the driver's thread ---- */

void
FirmataDriver::run(Lock &lock)
{
  may_run_ = false;
  std::unique_ptr<SerialBus> bus;
  std::unique_ptr<SerialPort> port;
  const tl::expected<void, DriverError> connected
      = watched_bus(lock)
            .and_then([&](std::unique_ptr<SerialBus> &&watched) {
              bus = std::move(watched);
              return connect_first(lock, *bus);
            })
            .map([&](std::unique_ptr<SerialPort> &&first) { port = std::move(first); });
  if (connected)
    opened();
  else
    refuse(connected.error());
  if (port)
    realtime_.emplace(config_.realtime);

  while (port) {
    converse(lock, *port, &FirmataDriver::is_quitting);
    const std::string why = lost_.value_or("");
    release(lock, std::exchange(port, nullptr));
    if (quit_)
      break;
    status_.is_there = false;
    const bool was_guarded = guardian_.has_value();
    // Devices in other sockets now are other boards.
    identity_->look_at(list(lock, *bus).value_or(std::vector<SerialDevice>()));
    tell(lock, DriverEvent::Kind::lost,
         describe(device_) + ": " + why
             + (may_run_ ? "; its motors may still be on if it has a supply of its own" : "")
             + (identity_->is_of_its_socket()
                    ? "; it is looked for at " + device_.bus_path + " alone"
                    : ""));
    while (!quit_ && !port)
      port = connect_again(lock, *bus);
    if (!port)
      break;
    status_.reconnects++;
    tell(lock, DriverEvent::Kind::returned, status_.board + " is back");
    if (was_guarded && !guardian_)
      tell_no_watchdog(lock);
  }

  realtime_.reset();
  if (bus)
    make_sure(lock, *bus);
  {
    const Unlocked unlocked(lock);
    if (bus)
      (void)bus->watch(nullptr);
    bus.reset();
  }
}

tl::expected<std::unique_ptr<SerialBus>, DriverError>
FirmataDriver::watched_bus(Lock &lock)
{
  const Unlocked unlocked(lock);
  tl::expected<std::unique_ptr<SerialBus>, DriverError> bus = make_bus_();
  if (!bus)
    return bus;
  const tl::expected<void, DriverError> watched = (*bus)->watch([this] {
    std::lock_guard changed(mutex_);
    bus_changed_ = true;
    changed_.notify_all();
  });
  if (!watched)
    return tl::unexpected(watched.error());
  return bus;
}

tl::expected<std::vector<SerialDevice>, DriverError>
FirmataDriver::list(Lock &lock, SerialBus &bus)
{
  return without(lock, [&] { return bus.list(); });
}

tl::expected<std::unique_ptr<SerialPort>, DriverError>
FirmataDriver::connect_first(Lock &lock, SerialBus &bus)
{
  tl::expected<std::vector<SerialDevice>, DriverError> listed = list(lock, bus);
  if (!listed)
    return tl::unexpected(listed.error());
  std::vector<SerialDevice> devices = std::move(*listed);
  // Known boards are in a file, whose disk may be slow.
  const BoardChoice choice = without(lock, [&] {
    return choose_boards(devices, config_.device, config_.asks_a_stranger, known_boards_);
  });
  std::vector<SerialDevice> asked = choice.wanted;
  if (choice.stranger)
    asked.push_back(*choice.stranger);
  std::vector<DriverError> refusals;
  if (asked.empty())
    refusals.push_back(refusal_of_none(config_.device, devices, choice.may_lack_one));
  for (const SerialDevice &device : asked) {
    tl::expected<std::unique_ptr<SerialPort>, DriverError> port
        = connect(lock, bus, device, choice.stranger.has_value());
    if (port) {
      tactors_ = std::min(config_.max_tactors, static_cast<int>(status_.pins.size()));
      resolution_ = board_->resolution() * config_.full_scale_volts;
      line_ = board_->line();
      identity_.emplace(device, config_.device, devices);
      use_account(identity_->is_of_its_socket() ? "USB " + device.bus_path : device.serial);
      return_refusals_.clear();
      std::erase(devices, device);
      const bool is_known = without(lock, [&] { return known_boards_.has(device); });
      tell(lock, DriverEvent::Kind::opened,
           status_.board + ": " + status_.firmware + ", tactors on pins " + describe(status_.pins)
               + (is_known ? "" : "; it cannot be remembered for the next play")
               + (devices.empty() ? ""
                                  : "; another is chosen by device=SERIAL or device=BUS-PATH: "
                                        + describe(devices)));
      tell_no_watchdog(lock);
      return port;
    }
    if (quit_)
      return port;
    refusals.push_back(port.error());
  }
  DriverError refusal = summary(refusals);
  refusal.text += advice(choice.passed_over);
  return tl::unexpected(refusal);
}

/// A warning about a board whose motors run on without this process.
void
FirmataDriver::tell_no_watchdog(Lock &lock)
{
  if (!status_.has_watchdog)
    tell(lock, DriverEvent::Kind::warning,
         status_.board + ": " + status_.firmware
             + " has no watchdog: motors run on if this computer hangs"
             + (guardian_          ? ""
                : config_.guardian ? " or the player is killed, as " + status_.guardian
                                   : " or the player is killed")
             + "; the seat firmware has one (docs/hardware)");
}

/// Waits until a search is due and searches for the lost board. Null: missing or not usable.
std::unique_ptr<SerialPort>
FirmataDriver::connect_again(Lock &lock, SerialBus &bus)
{
  const auto is_due = [this] {
    return quit_ || bus_changed_;
  };
  if (return_refusals_.is_final())
    changed_.wait(lock, is_due);
  else
    changed_.wait_for(lock, settings_.look_again, is_due);
  if (quit_)
    return nullptr;
  bus_changed_ = false;
  const std::optional<SerialDevice> found
      = identity_->find(list(lock, bus).value_or(std::vector<SerialDevice>()));
  if (!found) {
    return_refusals_.clear();
    return nullptr;
  }
  tl::expected<std::unique_ptr<SerialPort>, DriverError> port = connect(lock, bus, *found, false);
  if (!port) {
    if (!quit_ && return_refusals_.add(port.error()))
      tell(lock, DriverEvent::Kind::refused,
           "the tactor board is back, but cannot be used: " + port.error().text);
    return nullptr;
  }
  identity_->is_now(*found);
  return_refusals_.clear();
  return std::move(*port);
}

/// Opens and probes a device and hands it the current levels. An unknown device is not reset.
tl::expected<std::unique_ptr<SerialPort>, DriverError>
FirmataDriver::connect(Lock &lock, SerialBus &bus, const SerialDevice &device, bool is_stranger)
{
  const LineUse use = without(lock, [&] { return bus.use(device); });
  const bool is_wanted = config_.asks_a_stranger || !config_.device.empty();
  if (std::optional<DriverError> refusal = refusal_of_use(device, use, is_wanted))
    return tl::unexpected(*refusal);

  SerialPort::Events events;
  events.received = [this](std::span<const std::uint8_t> bytes) {
    std::lock_guard event(mutex_);
    board_->received(bytes);
    changed_.notify_all();
  };
  events.written = [this] {
    std::lock_guard event(mutex_);
    board_->written();
    changed_.notify_all();
  };
  events.lost = [this](const std::string &why) {
    std::lock_guard event(mutex_);
    lost_ = why;
    changed_.notify_all();
  };
  events.realtime = config_.realtime;
  events.raises_dtr = !is_stranger;

  lost_.reset();
  board_.emplace(steady_now(), settings_.patience);
  tl::expected<std::unique_ptr<SerialPort>, DriverError> port;
  const Time begun = steady_now();
  do {
    const std::stop_token stop = opening_.get_token();
    port = without(lock, [&] { return bus.open(device, events, stop); });
  } while (!port && port.error().kind == DriverError::Kind::busy
           && steady_now() < begun + settings_.busy
           && !changed_.wait_for(lock, kTryBusyAgain, [this] { return quit_; }));
  if (!port) {
    board_.reset();
    return port;
  }
  converse(lock, **port, &FirmataDriver::has_answered);

  std::optional<DriverError> refusal;
  if (quit_)
    refusal = { DriverError::Kind::failed, "the opening of the board was stopped" };
  else if (lost_)
    refusal = { DriverError::Kind::failed, describe(device) + ": " + *lost_ };
  else
    refusal = refusal_of_board(device, *board_, std::max(config_.min_tactors, tactors_),
                               firmware_ == Firmware::with_watchdog);
  if (board_->state() == FirmataBoard::State::running) {
    const Unlocked unlocked(lock);
    known_boards_.add(device);
  } else if (board_->state() == FirmataBoard::State::failed && !is_open_
             && remember_refusal(lock, device)) {
    refusal->text += "; it is probed again if it is named by device=" + device.bus_path;
  }
  if (refusal) {
    release(lock, std::move(*port));
    return tl::unexpected(*refusal);
  }

  device_ = device;
  status_.board = describe(device);
  status_.firmware = board_->firmware();
  status_.has_watchdog = board_->has_watchdog();
  status_.pins = board_->pins();
  status_.is_there = true;
  may_run_ = false; // it was reset
  guard(lock);
  return port;
}

/// Remembers that a device is no board. A known one with a serial number stays known: it was slow
/// or stuck this time. Without a number something else may be at its socket now.
bool
FirmataDriver::remember_refusal(Lock &lock, const SerialDevice &device)
{
  return without(lock, [&] {
    if (!device.serial.empty() && known_boards_.has(device))
      return false;
    known_boards_.refuse(device);
    return true;
  });
}

/// Talks to the board until `is_done` or the port is lost.
void
FirmataDriver::converse(Lock &lock, SerialPort &port, bool (FirmataDriver::*is_done)() const)
{
  while (!lost_ && !(this->*is_done)()) {
    if (realtime_)
      realtime_->turn();
    const Time now = steady_now();
    if (board_->state() == FirmataBoard::State::running && has_new_levels(now))
      board_->set_levels(levels(now), written_at_);
    const std::vector<std::uint8_t> bytes = board_->next(now);
    if (board_->state() == FirmataBoard::State::failed) {
      lost_ = board_->failure();
    } else if (!bytes.empty()) {
      const bool is_taken = without(lock, [&] { return port.write(bytes); });
      if (!is_taken && !lost_)
        lost_ = "it does not take what it is sent";
    } else if ((this->*is_done)()) {
      return;
    } else {
      const Time until
          = std::min(board_->deadline().value_or(Time::max()), levels_end().value_or(Time::max()));
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(until));
    }
  }
}

/// Motors to zero, if the board can still be reached, and the port closed.
void
FirmataDriver::release(Lock &lock, std::unique_ptr<SerialPort> port)
{
  const bool was_still = board_->is_still(steady_now());
  board_->close(steady_now());
  stand();
  converse(lock, *port, &FirmataDriver::has_left);
  {
    const Unlocked unlocked(lock);
    port.reset();
  }
  may_run_ = !board_->is_stopped() && (may_run_ || (!was_still && !board_->has_watchdog()));
  bytes_before_ += board_->bytes_sent();
  board_.reset();
}

/// Has a guardian watch over the board that was just connected, instead of the last one.
void
FirmataDriver::guard(Lock &lock)
{
  if (guardian_)
    guardian_->dismiss();
  guardian_.reset();
  status_.guardian = status_.has_watchdog || config_.guardian ? "" : "off";
  if (status_.has_watchdog || !config_.guardian)
    return;
  tl::expected<Guardian, std::string> started
      = without(lock, [&] { return Guardian::start(device_.bus_path); });
  status_.guardian = started ? "running" : started.error();
  if (started)
    guardian_ = std::move(*started);
}

/// After the last conversation: tries again to stop motors that may be on, and reports if they
/// still may.
void
FirmataDriver::make_sure(Lock &lock, SerialBus &bus)
{
  if (may_run_) {
    const tl::expected<void, DriverError> stopped = without(lock, [&] {
      bool may_pulse = true;
      return stop_board(bus, device_, &may_pulse, settings_.stop_patience);
    });
    may_run_ = !stopped;
    if (!stopped) {
      status_.may_run = true;
      tell(lock, DriverEvent::Kind::not_stopped, advice_after(stopped.error()));
    }
  }
  if (guardian_ && !may_run_)
    guardian_->dismiss();
  guardian_.reset(); // it goes on trying
}

bool
FirmataDriver::has_answered() const
{
  return quit_ || board_->state() == FirmataBoard::State::running;
}

bool
FirmataDriver::is_quitting() const
{
  return quit_;
}

bool
FirmataDriver::has_left() const
{
  return board_->state() == FirmataBoard::State::closed;
}

} // namespace tactor
