// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/board_choice.h"
#include "tactor/drivers/board_refusals.h"
#include "tactor/drivers/firmata_board.h"
#include "tactor/drivers/guardian.h"
#include "tactor/drivers/known_boards.h"
#include "tactor/drivers/stop_board.h"
#include "tactor/drivers/threaded_driver.h"
#include "tactor/realtime/realtime_thread.h"
#include "tactor/serial/serial_port.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace tactor {

/// Any board with a Firmata sketch on a serial bus. Its tactors are the pins with pulse-width
/// modulation, in ascending order: on a Mega 2–13 and 44–46, on an Uno 3, 5, 6, 9, 10 and 11.
///
/// Without DriverConfig::device the first board that answers is taken. Only those devices are
/// touched that choose_boards() names, in that order, each for FirmataPatience::answer at most;
/// those that another program has open are skipped. The results of probes are remembered. A lost
/// board is searched for whenever a device is plugged in or out, and every `look_again`;
/// BoardIdentity recognizes it.
///
/// If a signal or exit() ends the process while a board is open, the motors are stopped first: see
/// TerminationGuard. If it is killed, a Guardian stops those of a board without a watchdog. A board
/// that does not confirm its zeros at the end is tried again by stop_board(); if that fails, the
/// event not_stopped says so.
///
/// A thread of the driver has bus, port and reconnection; write() hands it the levels and never
/// waits.
class FirmataDriver : public ThreadedDriver
{
public:
  enum class Firmware
  {
    any,
    with_watchdog, ///< others are refused
  };

  struct Settings
  {
    FirmataPatience patience{};
    StopPatience stop_patience{};
    Time look_again = std::chrono::seconds(1);
    /// For a board that is in use: the guardian of the last play may be stopping it.
    Time busy = std::chrono::seconds(1);
    std::filesystem::path known_boards = KnownBoards::default_file(); ///< see KnownBoards
  };

  using MakeBus = MakeSerialBus;

  explicit FirmataDriver(Firmware firmware, MakeBus make_bus = make_serial_bus);
  FirmataDriver(Firmware firmware, MakeBus make_bus, Settings settings);
  ~FirmataDriver() override;

  double resolution() const override;
  Time transport_latency() const override;
  LineTime line() const override;
  Time refresh_interval() const override;
  DriverStatus status() const override;

private:
  // On the driver's thread. Those with a lock release it while they wait, use bus or port or call
  // `notify`.
  void run(Lock &lock) override;
  tl::expected<std::unique_ptr<SerialBus>, DriverError> watched_bus(Lock &lock);
  tl::expected<std::vector<SerialDevice>, DriverError> list(Lock &lock, SerialBus &bus);
  tl::expected<std::unique_ptr<SerialPort>, DriverError> connect_first(Lock &lock, SerialBus &bus);
  std::unique_ptr<SerialPort> connect_again(Lock &lock, SerialBus &bus);
  tl::expected<std::unique_ptr<SerialPort>, DriverError>
  connect(Lock &lock, SerialBus &bus, const SerialDevice &device, bool is_stranger);
  bool remember_refusal(Lock &lock, const SerialDevice &device);
  void converse(Lock &lock, SerialPort &port, bool (FirmataDriver::*is_done)() const);
  void release(Lock &lock, std::unique_ptr<SerialPort> port);
  void guard(Lock &lock);
  void tell_no_watchdog(Lock &lock);
  void make_sure(Lock &lock, SerialBus &bus);
  bool has_answered() const;
  bool is_quitting() const;
  bool has_left() const;

  void reset() override;
  void wake(Lock &lock) override;

  const Firmware firmware_;
  const MakeBus make_bus_;
  const Settings settings_;

  // Driver's thread only
  std::optional<RealtimeThread> realtime_;
  KnownBoards known_boards_;
  ReturnRefusals return_refusals_;
  std::optional<Guardian> guardian_; ///< of the last board
  bool may_run_ = false;             ///< the last board was left without word that it stands

  // Guarded by the mutex
  std::stop_source opening_; ///< cancels the opening of a port; requested with quit_
  bool bus_changed_ = false;
  std::optional<std::string> lost_;       ///< why the port is unusable
  std::optional<FirmataBoard> board_;     ///< at the other end of the port, while there is one
  SerialDevice device_;                   ///< the last one that was taken
  std::optional<BoardIdentity> identity_; ///< of device_
  std::uint64_t bytes_before_ = 0;        ///< sent to boards before board_
  // The values of the first board stay after a reconnection
  double resolution_ = 0;
  LineTime line_;
};

} // namespace tactor
