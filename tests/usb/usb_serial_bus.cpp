// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/usb/usb_serial_bus.h"

#include "emulated_board.h"
#include "tactor/driver.h"

#include <csignal>
#include <filesystem>
#include <random>
#include <sys/fsuid.h>
#include <unistd.h>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;
using namespace tactor;
using namespace usb_test;

namespace {

/// What a port told, and from which thread.
class Listener
{
public:
  SerialPort::Events events()
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

/// Counts, and waits for a count.
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

Bytes
random_bytes(std::mt19937 &random, std::size_t size)
{
  Bytes bytes(size);
  for (std::uint8_t &byte : bytes)
    byte = static_cast<std::uint8_t>(random());
  return bytes;
}

std::unique_ptr<SerialPort>
open_only(UsbSerialBus &bus, Listener &listener)
{
  const std::vector<SerialDevice> devices = bus.list();
  fail_unless_equals_int(devices.size(), 1);
  return bus.open(devices[0], listener.events());
}

template <class F>
DriverError
error_of(F call)
{
  try {
    call();
  } catch (const DriverError &error) {
    return error;
  }
  fail("expected an error");
  std::abort();
}

} // namespace

GST_START_TEST(test_conversations)
{
  const std::vector<std::string> expected[] = {
    { "claim 0", "claim 1", "21 20 0000 0000 00e10000000008", "21 22 0003 0000", "release 1",
      "return 1", "release 0", "return 0" },
    { "claim 0", "40 00 0000 0000", "40 03 c034 0000", "40 04 0008 0000", "40 01 0101 0000",
      "40 01 0202 0000", "40 09 0001 0000", "release 0", "return 0" },
    { "claim 0", "c0 5f 0000 0000 2 bytes", "40 a1 0000 0000", "40 9a 1312 9883", "40 9a 0f2c 0010",
      "40 9a 2518 00c3", "40 a4 ff9f 0000", "release 0", "return 0" },
  };
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard board(usb, { .transport = transport });
    UsbSerialBus bus;
    Listener listener;
    open_only(bus, listener).reset();
    fail_unless(board.conversation() == expected[static_cast<int>(transport)]);
    fail_unless_equals_int(board.transfers_pending(), 0);
    fail_unless(listener.lost().empty());
  }
}
GST_END_TEST;

static Suite *
usb_serial_bus_suite(void)
{
  // The pty behind the device node becomes the controlling terminal of a test that leads its session, and hangs up when a board is unplugged.
  std::signal(SIGHUP, SIG_IGN);
  Suite *suite = suite_create("usb_serial_bus");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_conversations);
  return suite;
}

GST_CHECK_MAIN(usb_serial_bus)
