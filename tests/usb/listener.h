// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/emulated_board.h"

#include "tactor/serial/usb_serial_bus.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "support/unwrap.h"
#include <gst/check/gstcheck.h>

namespace usb_test {

/// Records the events of a port.
class Listener
{
public:
  tactor::SerialPort::Events events()
  {
    return {
      .received =
          [this](std::span<const std::uint8_t> bytes) {
            note([&] { received_.insert(received_.end(), bytes.begin(), bytes.end()); });
          },
      .written = [this] { note([&] { written_++; }); },
      .lost = [this](const std::string &why) { note([&] { lost_.push_back(why); }); },
    };
  }

  bool wait_for_bytes(std::size_t count)
  {
    return wait([&] { return received_.size() >= count; });
  }

  /// Waits for a condition on the received bytes.
  bool wait_for(const std::function<bool(const Bytes &)> &condition)
  {
    return wait([&] { return condition(received_); });
  }

  bool wait_for_written(int count)
  {
    return wait([&] { return written_ >= count; });
  }

  bool wait_for_loss()
  {
    return wait([&] { return !lost_.empty(); });
  }

  Bytes received()
  {
    const std::lock_guard lock(mutex_);
    return received_;
  }

  int written()
  {
    const std::lock_guard lock(mutex_);
    return written_;
  }

  std::vector<std::string> lost()
  {
    const std::lock_guard lock(mutex_);
    return lost_;
  }

private:
  template <class F> void note(F what)
  {
    const std::lock_guard lock(mutex_);
    what();
    changed_.notify_all();
  }

  template <class F> bool wait(F condition)
  {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, condition);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Bytes received_;
  int written_ = 0;
  std::vector<std::string> lost_;
};

/// A counter that can be waited for.
class Counter
{
public:
  void count()
  {
    const std::lock_guard lock(mutex_);
    value_++;
    changed_.notify_all();
  }

  bool wait_for(int value)
  {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return value_ >= value; });
  }

private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int value_ = 0;
};

inline Bytes
random_bytes(std::mt19937 &random, std::size_t size)
{
  Bytes bytes(size);
  for (std::uint8_t &byte : bytes)
    byte = static_cast<std::uint8_t>(random());
  return bytes;
}

inline std::unique_ptr<tactor::SerialPort>
open_only(tactor::UsbSerialBus &bus, Listener &listener)
{
  const std::vector<tactor::SerialDevice> devices = unwrap(bus.list());
  fail_unless_equals_int(devices.size(), 1);
  return unwrap(bus.open(devices[0], listener.events()));
}

} // namespace usb_test
