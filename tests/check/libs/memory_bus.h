// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A serial bus in memory. Its boards can be plugged in and out, and can misbehave. Each open port
// has a thread, as a real one has. No time passes: a board answers as soon as its thread runs.
#pragma once

#include "../realtime.h"
#include "firmata_model.h"
#include "tactor/driver.h"
#include "tactor/serial/serial_port.h"

#include <condition_variable>
#include <list>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

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
  std::optional<tactor::DriverError::Kind> refusal{}; ///< of open()
  tactor::LineUse use{};                              ///< of its tty
  bool is_left = false;                               ///< a killed process left it open
  bool hangs_on_open = false;                         ///< until interrupted
  bool says_nothing = false;
  bool takes_nothing = false; ///< writes never complete
  long bytes_to_live = -1;    ///< unplugged after this many more bytes, −1: never

  // State that the bus keeps
  bool is_plugged = false;
  bool is_open = false;
  int opens = 0;
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

class MemoryPort final : public tactor::SerialPort
{
public:
  MemoryPort(Sockets &sockets, MemoryBoard &board, Events events)
      : sockets_(sockets), board_(board), events_(std::move(events)), thread_([this] { run(); })
  {
  }
  ~MemoryPort() override
  {
    {
      std::lock_guard lock(sockets_.mutex);
      quit_ = true;
      sockets_.changed.notify_all();
    }
    thread_.join();
    std::lock_guard lock(sockets_.mutex);
    board_.is_open = false;
    sockets_.changed.notify_all();
  }
  bool write(std::span<const std::uint8_t> bytes) override
  {
    std::lock_guard lock(sockets_.mutex);
    if (is_lost_ || !out_.empty() || bytes.empty() || bytes.size() > kMaxWrite)
      return false;
    sockets_.writer_policy = policy_of(0);
    sockets_.wants_realtime = events_.realtime;
    out_.assign(bytes.begin(), bytes.end());
    sockets_.changed.notify_all();
    return true;
  }

private:
  void run()
  {
    std::unique_lock lock(sockets_.mutex);
    while (!quit_) {
      const bool takes = !out_.empty() && !board_.takes_nothing;
      std::vector<std::uint8_t> in;
      bool is_written = false;
      if (board_.is_plugged && takes) {
        board_.model.receive(out_.front(), {});
        out_.erase(out_.begin());
        is_written = out_.empty();
        if (board_.bytes_to_live > 0 && --board_.bytes_to_live == 0)
          sockets_.pull(board_);
        sockets_.changed.notify_all();
      }
      while (board_.is_plugged && !board_.model.replies.empty() && in.size() < 50) {
        in.push_back(board_.model.replies.front());
        board_.model.replies.pop_front();
      }
      if (board_.says_nothing)
        in.clear();
      if (!board_.is_plugged) {
        is_lost_ = true;
        lock.unlock();
        events_.lost("it was plugged out");
        lock.lock();
        sockets_.changed.wait(lock, [this] { return quit_; });
      } else if (is_written || !in.empty()) {
        lock.unlock();
        if (!in.empty())
          events_.received(in);
        if (is_written)
          events_.written();
        lock.lock();
      } else if (!takes) {
        sockets_.changed.wait(lock);
      }
    }
  }

  Sockets &sockets_;
  MemoryBoard &board_;
  Events events_;
  std::vector<std::uint8_t> out_;
  bool is_lost_ = false;
  bool quit_ = false;
  std::thread thread_; ///< last, as it uses the others
};

class MemoryBus final : public tactor::SerialBus
{
public:
  explicit MemoryBus(Sockets &sockets) : sockets_(sockets)
  {
  }
  ~MemoryBus() override
  {
    watch(nullptr);
  }
  tl::expected<std::vector<tactor::SerialDevice>, tactor::DriverError> list() override
  {
    std::lock_guard lock(sockets_.mutex);
    std::vector<tactor::SerialDevice> devices;
    for (const MemoryBoard *board : sockets_.boards)
      devices.push_back(board->device);
    return devices;
  }
  tl::expected<std::unique_ptr<tactor::SerialPort>, tactor::DriverError>
  open(const tactor::SerialDevice &device, tactor::SerialPort::Events events,
       std::stop_token stop) override
  {
    using tactor::DriverError;
    MemoryBoard *board = nullptr;
    {
      std::unique_lock lock(sockets_.mutex);
      board = find(device);
      if (!board)
        return refused(DriverError::Kind::not_found, device.name + " was plugged out");
      board->opens++;
      sockets_.changed.notify_all();
      if (board->hangs_on_open) {
        lock.unlock();
        const std::stop_callback wake(stop, [this] {
          const std::lock_guard woken(sockets_.mutex);
          sockets_.changed.notify_all();
        });
        lock.lock();
        sockets_.changed.wait(lock, [&] { return stop.stop_requested(); });
        lock.unlock(); // ~stop_callback may wait for the callback
        return refused(DriverError::Kind::failed, device.name + " was interrupted");
      }
      if (board->refusal)
        return refused(*board->refusal, device.name + " is refused");
      if (board->is_open)
        return refused(DriverError::Kind::busy, device.name + " is in use");
      board->is_open = true;
      if (board->resets_on_open)
        board->model.restart({});
    }
    return std::make_unique<MemoryPort>(sockets_, *board, std::move(events));
  }
  tactor::LineUse use(const tactor::SerialDevice &device) override
  {
    std::lock_guard lock(sockets_.mutex);
    const MemoryBoard *board = find(device);
    return board ? board->use : tactor::LineUse{};
  }
  bool is_left(const tactor::SerialDevice &device) override
  {
    std::lock_guard lock(sockets_.mutex);
    const MemoryBoard *board = find(device);
    return board && board->is_left;
  }
  tl::expected<void, tactor::DriverError> watch(std::function<void()> changed) override
  {
    std::lock_guard lock(sockets_.watching);
    sockets_.watcher = std::move(changed);
    return {};
  }

private:
  /// The caller holds the lock.
  MemoryBoard *find(const tactor::SerialDevice &device)
  {
    for (MemoryBoard *each : sockets_.boards)
      if (each->device == device)
        return each;
    return nullptr;
  }
  static tl::unexpected<tactor::DriverError> refused(tactor::DriverError::Kind kind,
                                                     std::string why)
  {
    return tl::unexpected(tactor::DriverError{ kind, std::move(why) });
  }

  Sockets &sockets_;
};
