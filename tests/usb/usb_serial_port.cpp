// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listener.h"

#include <atomic>
#include <filesystem>
#include <iterator>

#include "support/check_tests.h"
#include "support/realtime.h"

using namespace std::chrono_literals;
using namespace tactor;
using namespace usb_test;

namespace {

/// A plugged board and its open port.
struct Plugged
{
  explicit Plugged(const BoardDescription &description = {}, UsbPatience patience = {})
      : board(usb, description), bus(patience), port(open_only(bus, listener))
  {
  }

  EmulatedUsb usb;
  EmulatedBoard board;
  UsbSerialBus bus;
  Listener listener;
  std::unique_ptr<SerialPort> port;
};

} // namespace

CHECK_TEST(test_bytes_out)
{
  for (const Transport transport : kTransports) {
    Plugged plugged({ .transport = transport });
    auto &[usb, board, bus, listener, port] = plugged;
    std::mt19937 random(static_cast<unsigned>(transport));
    Bytes sent;
    for (int i = 0; i < 100; i++) {
      // Including the longest and the shortest.
      const std::size_t size = i == 0   ? SerialPort::kMaxWrite
                               : i == 1 ? 1
                                        : 1 + random() % SerialPort::kMaxWrite;
      const Bytes bytes = random_bytes(random, size);
      sent.insert(sent.end(), bytes.begin(), bytes.end());
      fail_unless(port->write(bytes));
      fail_unless(listener.wait_for_written(i + 1));
    }
    fail_unless(board.bytes() == sent);
    fail_unless_equals_int(board.most_writes_pending(), 1);
  }
}

/// The port's thread is real-time where requested and permitted.
CHECK_TEST(test_realtime)
{
  for (const bool wanted : { true, false }) {
    EmulatedUsb usb;
    EmulatedBoard board(usb, {});
    UsbSerialBus bus;
    Listener listener;
    std::atomic<int> policy{ -1 };
    SerialPort::Events events = listener.events();
    events.realtime = wanted;
    events.received = [&, tell = events.received](std::span<const std::uint8_t> bytes) {
      policy = policy_of(0);
      tell(bytes);
    };
    const auto port = bus.open(unwrap(bus.list()).at(0), std::move(events));
    board.send(Bytes{ 1, 2, 3 });
    fail_unless(listener.wait_for_bytes(3));
    fail_unless_equals_int(policy, wanted && may_be_realtime() ? SCHED_RR : SCHED_OTHER);
  }
}

CHECK_TEST(test_bytes_in)
{
  for (const Transport transport : kTransports) {
    Plugged plugged({ .transport = transport });
    auto &[usb, board, bus, listener, port] = plugged;
    std::mt19937 random(static_cast<unsigned>(transport));
    Bytes sent;
    for (int i = 0; i < 300; i++) {
      // Including sizes around packet boundaries. FTDI sends a packet with only status bytes each
      // millisecond.
      constexpr std::size_t edges[] = { 0, 1, 31, 32, 33, 61, 62, 63, 64, 65, 124, 496, 512, 683 };
      const std::size_t size = i < 14 ? edges[i] : random() % 700;
      const Bytes bytes = random_bytes(random, size);
      sent.insert(sent.end(), bytes.begin(), bytes.end());
      board.send(bytes);
    }
    fail_unless(listener.wait_for_bytes(sent.size()));
    fail_unless(listener.received() == sent);
  }
}

/// Packets shorter than the transport's status bytes, and one longer than the buffer. Other data is
/// not affected.
CHECK_TEST(test_odd_packets)
{
  for (const Transport transport : kTransports) {
    Plugged plugged({ .transport = transport });
    auto &[usb, board, bus, listener, port] = plugged;
    std::mt19937 random(7);
    Bytes sent;
    for (int i = 0; i < 60; i++) {
      board.send_packet({});
      if (transport == Transport::ftdi) {
        board.send_packet({ 0x01 });
        board.send_packet({ 0x01, 0x60 });
      }
      const Bytes bytes = random_bytes(random, 1 + random() % 70);
      sent.insert(sent.end(), bytes.begin(), bytes.end());
      board.send(bytes);
    }
    fail_unless(listener.wait_for_bytes(sent.size()));
    fail_unless(listener.received() == sent);

    board.send_packet(random_bytes(random, 600));
    const Bytes last = random_bytes(random, 5);
    board.send(last);
    fail_unless(listener.wait_for([&](const Bytes &received) {
      return received.size() >= last.size()
             && std::equal(last.begin(), last.end(), received.end() - 5);
    }));
    fail_unless(listener.lost().empty());
  }
}

/// Each completed write starts the next one.
CHECK_TEST(test_ten_thousand_writes)
{
  constexpr int kWrites = 10000;
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus;
  std::unique_ptr<SerialPort> port;
  Counter count;
  std::mutex opened; // until `port` is set
  Bytes sent;
  const auto write = [&] {
    const Bytes bytes{ static_cast<std::uint8_t>(sent.size() >> 9),
                       static_cast<std::uint8_t>(sent.size() >> 1) };
    fail_unless(port->write(bytes));
    sent.insert(sent.end(), bytes.begin(), bytes.end());
  };
  {
    const std::lock_guard lock(opened);
    port = unwrap(bus.open(unwrap(bus.list()).at(0), { .written = [&] {
                             const std::lock_guard lock(opened);
                             if (sent.size() < 2 * kWrites) {
                               write();
                               // One at a time: this thread tells of its end after it returns from
                               // here.
                               fail_unless(!port->write(Bytes{ 0 }));
                             }
                             count.count();
                           } }));
    write();
  }
  for (int written = 1000; written <= kWrites; written += 1000)
    fail_unless(count.wait_for(written));
  port.reset();
  fail_unless(board.bytes() == sent);
  fail_unless_equals_int(board.most_writes_pending(), 1);
}

CHECK_TEST(test_one_write_at_a_time)
{
  Plugged plugged;
  auto &[usb, board, bus, listener, port] = plugged;
  board.stall(true);
  const Bytes first{ 1 }, second{ 2 }, third{ 3 };
  fail_unless(port->write(first));
  fail_unless(!port->write(second));
  board.stall(false);
  fail_unless(listener.wait_for_written(1));
  fail_unless(port->write(third));
  fail_unless(listener.wait_for_written(2));
  const Bytes expected{ 1, 3 };
  fail_unless(board.bytes() == expected);
}

/// Destroying the port ends transfers at any moment.
CHECK_TEST(test_teardown_at_any_moment)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, { .baud = 57600 });
  UsbSerialBus bus;
  std::mt19937 random(3);
  for (int i = 0; i < 60; i++) {
    Listener listener;
    auto port = open_only(bus, listener);
    board.stall(i % 4 == 0);
    board.send(random_bytes(random, random() % 200));
    if (i % 3 != 0)
      fail_unless(port->write(random_bytes(random, 1 + random() % 20)));
    if (i % 4 == 1)
      fail_unless(listener.wait_for_written(i % 3 != 0));
    port.reset();
    fail_unless_equals_int(board.transfers_pending(), 0);
    fail_unless(listener.lost().empty());
  }
}

CHECK_TEST(test_unplugged)
{
  for (const Transport transport : kTransports)
    for (const bool udev : { true, false }) {
      Plugged plugged({ .transport = transport });
      auto &[usb, board, bus, listener, port] = plugged;
      if (!udev)
        usb.stop_udev();
      board.stall(true);
      const Bytes bytes{ 1, 2, 3 };
      fail_unless(port->write(bytes));
      board.unplug();
      fail_unless(listener.wait_for_loss());
      fail_unless(!port->write(bytes));
      port.reset();
      fail_unless_equals_int(listener.lost().size(), 1);
      fail_unless_equals_int(listener.written(), 0);
      fail_unless(board.bytes().empty());
    }
}

/// Transfers fail before the hub reports that the board was unplugged.
CHECK_TEST(test_transfers_that_fail)
{
  Plugged plugged;
  auto &[usb, board, bus, listener, port] = plugged;
  board.break_transfers(EmulatedBoard::kAll);
  fail_unless(listener.wait_for_loss());
  const Bytes bytes{ 1 };
  fail_unless(!port->write(bytes));
  port.reset();
  fail_unless_equals_int(listener.lost().size(), 1);
}

/// A halted endpoint accepts nothing until it is cleared, which the next open() does.
CHECK_TEST(test_halted)
{
  for (const Transport transport : kTransports) {
    Plugged plugged({ .transport = transport });
    auto &[usb, board, bus, listener, port] = plugged;
    board.break_transfers(1, EPIPE);
    fail_unless(listener.wait_for_loss());
    fail_unless(!port->write(Bytes{ 1 }));
    port.reset();
    fail_unless_equals_int(listener.lost().size(), 1);
    fail_unless(listener.lost()[0].find("refuses") != std::string::npos);
  }
}

/// Motors cause noise on the bus: occasional failed transfers lose no data.
CHECK_TEST(test_noise)
{
  Plugged plugged;
  auto &[usb, board, bus, listener, port] = plugged;
  std::mt19937 random(2);
  Bytes sent;
  for (int i = 0; i < 20; i++) {
    // The pending reads, then as many writes.
    board.break_transfers(4 + i % 3);
    const Bytes bytes = random_bytes(random, 1 + random() % 70);
    sent.insert(sent.end(), bytes.begin(), bytes.end());
    fail_unless(port->write(bytes));
    fail_unless(listener.wait_for_written(i + 1));
    board.break_transfers(0);
    board.send(bytes);
    fail_unless(listener.wait_for_bytes(sent.size()));
  }
  fail_unless(board.bytes() == sent);
  fail_unless(listener.received() == sent);
  fail_unless(listener.lost().empty());
}

CHECK_TEST(test_stalled)
{
  Plugged plugged({}, { .write = 30ms });
  auto &[usb, board, bus, listener, port] = plugged;
  board.stall(true);
  const Bytes bytes{ 1 };
  fail_unless(port->write(bytes));
  fail_unless(listener.wait_for_loss());
  fail_unless(!port->write(bytes));
  port.reset();
  fail_unless_equals_int(listener.lost().size(), 1);
  fail_unless(listener.lost()[0].find("30 ms") != std::string::npos);
  fail_unless_equals_int(listener.written(), 0);
}

namespace {

std::ptrdiff_t
entries(const char *folder)
{
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

} // namespace

CHECK_TEST(test_nothing_is_left_behind)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus;
  std::ptrdiff_t files = 0, threads = 0;
  for (int i = 0; i < 100; i++) {
    Listener listener;
    const auto port = open_only(bus, listener);
    bus.watch([] {});
    board.send(Bytes{ 1 });
    fail_unless(listener.wait_for_bytes(1));
    bus.watch(nullptr);
    if (i == 10) {
      files = entries("/proc/self/fd");
      threads = entries("/proc/self/task");
    }
    if (i == 99) {
      fail_unless_equals_int(entries("/proc/self/task"), threads);
      // umockdev closes its end asynchronously.
      for (int more = 0; more < 100 && entries("/proc/self/fd") > files; more++)
        unwrap(bus.list());
      fail_unless(entries("/proc/self/fd") <= files);
    }
  }
}

/// When the kernel's driver gets a board back, the chip's buffer is lost. It must be empty then,
/// however the play ended.
CHECK_TEST(test_nothing_is_cut_off)
{
  for (const Transport transport : kTransports)
    for (const bool is_lost : { false, true }) {
      Plugged plugged({ .transport = transport, .baud = 57600, .chip = 128 });
      auto &[usb, board, bus, listener, port] = plugged;
      const Bytes bytes(64, 0x55); // 11 ms on the line
      fail_unless(port->write(bytes));
      fail_unless(listener.wait_for_written(1));
      if (is_lost) {
        board.break_transfers(EmulatedBoard::kAll);
        fail_unless(listener.wait_for_loss());
      }
      port.reset();
      ck_assert_uint_eq(board.cut_off(), 0);
      fail_unless(board.bytes() == bytes);
    }
}

CHECK_MAIN_AFTER(usb_serial_port, -1, begin_emulation())
