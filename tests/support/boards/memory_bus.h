// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A serial bus in memory. Its boards can be plugged in and out, and can misbehave. Each open port
// has a thread, as a real one has. No time passes: a board answers as soon as its thread runs.
#pragma once

#include "support/boards/firmata_model.h"
#include "tactor/driver.h"
#include "tactor/serial/serial_port.h"

#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

/// A board, plugged in or not.
struct MemoryBoard
{
  MemoryBoard(tactor::SerialDevice device, const Layout &layout, bool seat = false)
      : device(std::move(device)), model(layout, seat)
  {
  }

  tactor::SerialDevice device;
  FirmataModel model;
  bool resets_on_open = true;                         ///< DTR is wired to reset
  bool needs_dtr = false;                             ///< it is silent until DTR
  std::optional<tactor::DriverError::Kind> refusal{}; ///< of open()
  tactor::LineUse use{};                              ///< of its tty
  bool is_left = false;                               ///< a killed process left it open
  bool hangs_on_open = false;                         ///< until interrupted
  bool says_nothing = false;
  bool takes_nothing = false; ///< writes never complete
  bool takes_nothing_until_reopened = false;
  long bytes_to_live = -1; ///< unplugged after this many more bytes, −1: never

  // State that the bus keeps
  bool is_plugged = false;
  bool is_open = false;
  bool has_dtr = false; ///< raised by an opening
  int opens = 0;
  int pulses = 0; ///< of DTR
};

/// The sockets, which all buses of a test share. Boards outlive them.
class Sockets
{
public:
  bool announces = true; ///< hot-plug events; set before a bus is made

  void plug(MemoryBoard &board)
  {
    {
      std::lock_guard lock(mutex);
      board.is_plugged = true;
      board.model.power_off();
      board.model.restart({});
      boards.push_back(&board);
      changed.notify_all();
    }
    announce();
  }
  void unplug(MemoryBoard &board)
  {
    {
      std::lock_guard lock(mutex);
      pull(board);
    }
    announce();
  }
  /// Waits for a condition on boards or events.
  template <typename Predicate> void wait(Predicate predicate)
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, predicate);
  }
  template <typename Function> auto locked(Function function)
  {
    std::lock_guard lock(mutex);
    return function();
  }
  /// The caller holds the lock.
  void pull(MemoryBoard &board)
  {
    board.is_plugged = false;
    board.model.power_off();
    boards.remove(&board);
    changed.notify_all();
  }
  void announce()
  {
    std::lock_guard lock(watching);
    if (watcher && announces)
      watcher();
  }

  std::mutex mutex; ///< guards boards and what tests wait for
  std::condition_variable changed;
  std::list<MemoryBoard *> boards;
  int writer_policy = -1;      ///< of the thread that wrote last
  bool wants_realtime = false; ///< of the port's thread
  std::mutex watching;         ///< held while the watcher is called
  std::function<void()> watcher;
};

class MemoryBus final : public tactor::SerialBus
{
public:
  explicit MemoryBus(Sockets &sockets) : sockets_(sockets)
  {
  }
  ~MemoryBus() override;
  tl::expected<std::vector<tactor::SerialDevice>, tactor::DriverError> list() override;
  tl::expected<std::unique_ptr<tactor::SerialPort>, tactor::DriverError>
  open(const tactor::SerialDevice &device, tactor::SerialPort::Events events,
       std::stop_token stop) override;
  tactor::LineUse use(const tactor::SerialDevice &device) override;
  bool is_left(const tactor::SerialDevice &device) override;
  tl::expected<void, tactor::DriverError> reset(const tactor::SerialDevice &device) override;
  tl::expected<void, tactor::DriverError> watch(std::function<void()> changed) override;

private:
  /// The caller holds the lock.
  MemoryBoard *find(const tactor::SerialDevice &device);

  Sockets &sockets_;
};
