// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The drivers of real boards and the default one, with boards in memory. Patience is an hour where it must not end and milliseconds
// where it must: nothing here is measured by the wall clock.
#include "tactor/firmata_driver.h"

#include "memory_bus.h"
#include "tactor/auto_driver.h"
#include "tactor/simulator.h"

#include <atomic>
#include <cmath>
#include <random>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;
using namespace tactor;
using Firmware = FirmataDriver::Firmware;
using Kind = DriverError::Kind;
using EventKind = DriverEvent::Kind;

namespace {

constexpr FirmataPatience kEndless{
  .answer = 1h, .ask_again = 1h, .transfer = 1h, .host_silence = 1h, .keepalive = 1h, .farewell = 1h
};

SerialDevice
device(const char *serial, const char *bus_path, const char *name = "Arduino Mega 2560")
{
  return { .serial = serial,
           .bus_path = bus_path,
           .name = name,
           .vendor = 0x2341,
           .product = 0x0042,
           .transport = "cdc-acm" };
}

/// Sockets, a board in one of them and a driver.
class Rig
{
public:
  explicit Rig(Firmware firmware = Firmware::any, FirmataPatience patience = kEndless,
               Time look_again = 1h)
      : driver(firmware, [this] { return std::make_unique<MemoryBus>(sockets); },
               { .patience = patience, .look_again = look_again })
  {
  }

  void open(int min_tactors = 1, const std::string &name = "")
  {
    driver.open(config(min_tactors, name));
  }
  DriverConfig config(int min_tactors = 1, const std::string &name = "")
  {
    return { .device = name,
             .min_tactors = min_tactors,
             .full_scale_volts = 3.0,
             .notify = [this](const DriverEvent &event) {
               std::lock_guard lock(sockets.mutex);
               events.push_back(event);
               sockets.changed.notify_all();
             } };
  }
  DriverError refusal(int min_tactors = 1, const std::string &name = "")
  {
    try {
      open(min_tactors, name);
    } catch (const DriverError &error) {
      fail_unless(driver.tactors() == 0);
      fail_unless(std::string(error.what()).find('\n') == std::string::npos);
      return error;
    }
    fail("it was opened");
    return { Kind::failed, "" };
  }
  void write(const std::vector<double> &volts)
  {
    driver.write(volts, 0s);
  }
  /// Waits until the motors have what these volts are on 8 bits, and all others nothing.
  void expect(MemoryBoard &board, const std::vector<double> &volts)
  {
    const std::vector<int> pins = driver.status().pins;
    sockets.wait([&] {
      for (std::size_t i = 0; i < pins.size(); i++)
        if (board.model.duty[pins[i]]
            != static_cast<int>(std::lround((i < volts.size() ? volts[i] : 0) / 3.0 * 255)))
          return false;
      return true;
    });
  }
  void wait_for(EventKind kind, int count = 1)
  {
    sockets.wait([&] { return std::ranges::count(events, kind, &DriverEvent::kind) >= count; });
  }
  int count(EventKind kind)
  {
    return sockets.locked(
        [&] { return static_cast<int>(std::ranges::count(events, kind, &DriverEvent::kind)); });
  }
  std::string text(EventKind kind)
  {
    return sockets.locked([&] {
      const auto event = std::ranges::find(events, kind, &DriverEvent::kind);
      return event == events.end() ? "" : event->text;
    });
  }

  Sockets sockets;
  MemoryBoard mega{ device("7573", "1-2"), kMega };
  MemoryBoard uno{ device("95", "1-3", "Arduino Uno"), kUno };
  MemoryBoard seat{ device("S1", "2-1", "Seat"), kMega, true };
  std::vector<DriverEvent> events;
  FirmataDriver driver;
};

void
assert_contains(const std::string &text, std::initializer_list<const char *> parts)
{
  for (const char *part : parts)
    fail_unless(text.find(part) != std::string::npos, "no '%s' in: %s", part, text.c_str());
}

} // namespace

GST_START_TEST(test_open_write_close)
{
  Rig rig;
  rig.sockets.plug(rig.mega);
  rig.open(9);
  ck_assert_int_eq(rig.driver.tactors(), 15);
  fail_unless(rig.driver.resolution() == 3.0 / 255);
  fail_unless(rig.driver.transport_latency() == 9375us); // 54 bytes
  const DriverStatus status = rig.driver.status();
  fail_unless(status.is_there && !status.has_watchdog);
  fail_unless(status.firmware == "StandardFirmata.ino 2.5");
  fail_unless(status.pins == (std::vector{ 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46 }));
  assert_contains(rig.text(EventKind::opened),
                  { "Arduino Mega 2560", "7573", "1-2", "StandardFirmata", "44" });
  assert_contains(rig.text(EventKind::warning), { "watchdog", "StandardFirmata" });
  ck_assert_int_eq(rig.count(EventKind::warning), 1);

  rig.write({ 3.0, 1.5, 0.5 });
  rig.expect(rig.mega, { 3.0, 1.5, 0.5 });
  std::vector<double> all(15, 1.0);
  rig.write(all);
  rig.expect(rig.mega, all);
  rig.write({ 1.0, 99.0 });
  rig.expect(rig.mega, { 1.0, 3.0 });
  rig.driver.close();
  fail_unless(rig.mega.model.is_silent());
  ck_assert_int_eq(rig.mega.model.received.back(), 0xff);
  fail_if(rig.mega.is_open);
  fail_unless(rig.driver.tactors() == 0);
  fail_if(rig.driver.status().is_there);
  ck_assert_uint_ge(rig.driver.status().bytes, rig.mega.model.received.size());
  rig.driver.close();

  // And again.
  rig.open();
  rig.write({ 2.0 });
  rig.expect(rig.mega, { 2.0 });
}
GST_END_TEST;

/// The destructor leaves them at zero, too.
GST_START_TEST(test_destroyed)
{
  Sockets sockets;
  MemoryBoard board(device("1", "1-1"), kUno);
  sockets.plug(board);
  {
    FirmataDriver driver(Firmware::any, [&] { return std::make_unique<MemoryBus>(sockets); });
    driver.open({});
    driver.write(std::vector<double>{ 3.0 }, 0s);
    sockets.wait([&] { return board.model.duty[3] == 255; });
  }
  fail_unless(board.model.is_silent());
  fail_if(board.is_open);
}
GST_END_TEST;

/// One warning, the film goes on, and a board that comes back, whatever it has done meanwhile, does what holds then. With hot-plug
/// events and, where there are none, by looking again.
GST_START_TEST(test_unplug_and_replug)
{
  for (const bool announces : { true, false }) {
    Rig rig(Firmware::any, kEndless, announces ? Time(1h) : Time(2ms));
    rig.sockets.announces = announces;
    rig.sockets.plug(rig.mega);
    rig.open();
    for (int times = 1; times <= 3; times++) {
      rig.write({ 3.0, 1.0 });
      rig.expect(rig.mega, { 3.0, 1.0 });
      rig.sockets.unplug(rig.mega);
      rig.wait_for(EventKind::lost, times);
      for (int i = 0; i < 100; i++)
        rig.write({ i / 50.0, 0.5 });
      fail_if(rig.driver.status().is_there);
      rig.sockets.plug(rig.mega);
      rig.wait_for(EventKind::returned, times);
      rig.expect(rig.mega, { 99 / 50.0, 0.5 });
      fail_unless(rig.driver.status().is_there);
      ck_assert_uint_eq(rig.driver.status().reconnects, static_cast<unsigned>(times));
      ck_assert_int_eq(rig.count(EventKind::lost), times);
    }
    ck_assert_int_eq(rig.count(EventKind::opened), 1);
    ck_assert_int_eq(rig.count(EventKind::warning), 1);
    assert_contains(rig.text(EventKind::lost), { "7573", "plugged out" });
    ck_assert_int_eq(rig.driver.tactors(), 15);
    rig.sockets.unplug(rig.mega);
    rig.wait_for(EventKind::lost, 4);
    rig.driver.close(); // while it is away
    fail_unless(rig.mega.model.is_silent());
  }
}
GST_END_TEST;

/// Plugged out after any number of bytes, at first and when it has returned: nobody hangs, and it is found again.
GST_START_TEST(test_unplug_in_each_phase)
{
  int refused = 0;
  int lost = 0;
  for (long bytes = 1; bytes < 130; bytes += bytes < 12 ? 1 : 7) {
    Rig rig;
    rig.sockets.plug(rig.mega);
    rig.mega.bytes_to_live = bytes;
    bool is_open = true;
    try {
      rig.open();
    } catch (const DriverError &error) {
      is_open = false;
      refused++;
      fail_unless(error.kind() == Kind::failed);
      assert_contains(error.what(), { "plugged out" });
      fail_if(rig.mega.is_open);
    }
    if (!is_open)
      continue;
    // In the middle of a film. What it still gets is more than it has left.
    for (int i = 0; rig.count(EventKind::lost) == 0; i++)
      rig.write({ i % 2 * 1.0, 2.0 });
    // And in the middle of its return.
    rig.sockets.locked([&] { rig.mega.bytes_to_live = bytes; });
    rig.sockets.plug(rig.mega);
    for (int i = 0; rig.sockets.locked([&] { return rig.mega.is_plugged; }); i++)
      rig.write({ i % 2 * 1.0, 2.0 });
    fail_unless(rig.mega.model.is_silent());
    rig.sockets.locked([&] { rig.mega.bytes_to_live = -1; });
    rig.sockets.plug(rig.mega);
    rig.write({ 2.0, 3.0 });
    rig.expect(rig.mega, { 2.0, 3.0 });
    lost++;
    rig.driver.close();
    fail_unless(rig.mega.model.is_silent());
  }
  ck_assert_int_ge(
      refused,
      4); // the banner may come before the first question: one question of 4 bytes at least
  ck_assert_int_ge(lost, 15);
}
GST_END_TEST;

/// It takes nothing any more, but does not leave: it is opened anew, which resets it.
GST_START_TEST(test_stalled_board)
{
  FirmataPatience patience = kEndless;
  patience.transfer = 250ms;
  patience.farewell = 250ms;
  Rig rig(Firmware::any, patience, 2ms);
  rig.sockets.plug(rig.mega);
  // Under a load of others it may be lost before it stalls: then it returns all the same.
  for (bool is_open = false; !is_open;) {
    try {
      rig.open();
      is_open = true;
    } catch (const DriverError &) {
    }
  }
  rig.sockets.locked([&] { rig.mega.takes_nothing = true; });
  const int lost = rig.count(EventKind::lost);
  rig.write({ 2.0 });
  rig.wait_for(EventKind::lost, lost + 1);
  rig.sockets.locked([&] { rig.mega.takes_nothing = false; });
  rig.wait_for(EventKind::returned, lost + 1);
  rig.expect(rig.mega, { 2.0 });
  // Closed while it takes nothing: not for long.
  rig.sockets.locked([&] { rig.mega.takes_nothing = true; });
  rig.write({ 1.0 });
  rig.driver.close();
  fail_if(rig.mega.is_open);
}
GST_END_TEST;

GST_START_TEST(test_no_board)
{
  Rig rig;
  const DriverError none = rig.refusal();
  fail_unless(none.kind() == Kind::not_found);
  assert_contains(none.what(), { "StandardFirmata" });
  rig.sockets.plug(rig.mega);
  rig.sockets.plug(rig.uno);
  const DriverError other = rig.refusal(1, "12345");
  fail_unless(other.kind() == Kind::not_found);
  assert_contains(other.what(), { "'12345'", "7573", "1-2", "Arduino Uno", "95", "1-3" });
  ck_assert_int_eq(rig.mega.opens + rig.uno.opens, 0);

  for (const Kind kind : { Kind::permission, Kind::busy, Kind::failed }) {
    rig.mega.refusal = kind;
    const DriverError error = rig.refusal(1, "7573");
    fail_unless(error.kind() == kind);
    assert_contains(error.what(), { "refused" });
  }
  FirmataDriver broken(Firmware::any,
                       []() -> std::unique_ptr<SerialBus> { throw std::runtime_error("no bus"); });
  try {
    broken.open({});
    fail("there is no bus");
  } catch (const DriverError &error) {
    assert_contains(error.what(), { "no bus" });
  }
}
GST_END_TEST;

GST_START_TEST(test_silent_board)
{
  FirmataPatience patience = kEndless;
  patience.answer = 20ms;
  patience.ask_again = 5ms;
  Rig rig(Firmware::any, patience);
  rig.mega.says_nothing = true;
  rig.sockets.plug(rig.mega);
  const DriverError error = rig.refusal();
  fail_unless(error.kind() == Kind::failed);
  assert_contains(error.what(), { "Mega", "7573", "does not answer", "StandardFirmata" });
  fail_if(rig.mega.is_open);
}
GST_END_TEST;

/// Whoever waits for a board that never answers can be called off.
GST_START_TEST(test_open_is_interrupted)
{
  Rig rig;
  rig.mega.says_nothing = true;
  rig.sockets.plug(rig.mega);
  std::thread other([&] {
    rig.sockets.wait([&] { return rig.mega.opens == 1; });
    rig.driver.close();
  });
  const DriverError error = rig.refusal();
  assert_contains(error.what(), { "closed" });
  other.join();
  fail_if(rig.mega.is_open);
}
GST_END_TEST;

/// The first that can be used, unless one is named by its number or its socket.
GST_START_TEST(test_two_boards)
{
  Rig rig;
  rig.sockets.plug(rig.uno);
  rig.sockets.plug(rig.mega);
  rig.open();
  fail_unless(rig.uno.is_open && !rig.mega.is_open);
  assert_contains(rig.text(EventKind::opened), { "Arduino Uno (serial 95", "device=", "7573" });
  for (const char *name : { "7573", "1-2" }) {
    rig.open(1, name);
    fail_unless(rig.mega.is_open && !rig.uno.is_open);
  }
  // The Uno has too few pins.
  rig.open(9);
  fail_unless(rig.mega.is_open && !rig.uno.is_open);
  fail_unless(rig.uno.model.is_silent());
  // The first is refused.
  rig.uno.refusal = Kind::busy;
  rig.open();
  fail_unless(rig.mega.is_open);
  rig.mega.refusal = Kind::permission;
  rig.driver.close();
  assert_contains(rig.refusal().what(), { "Uno is refused", "Mega 2560 is refused" });
}
GST_END_TEST;

GST_START_TEST(test_too_few_pins)
{
  Rig rig;
  rig.sockets.plug(rig.uno);
  const DriverError error = rig.refusal(9);
  fail_unless(error.kind() == Kind::settings);
  assert_contains(error.what(), { "6 pins", "3, 5, 6, 9, 10, 11", "9 tactors", "mapping" });
  fail_unless(rig.uno.model.is_silent());
  fail_if(rig.uno.is_open);
  rig.open(6);

  Layout none = kUno;
  none.pwm.clear();
  MemoryBoard bare(device("0", "1-9"), none);
  rig.sockets.plug(bare);
  fail_unless(rig.refusal(1, "1-9").kind() == Kind::settings);
  rig.driver.close();
  rig.sockets.unplug(bare);

  // What a device calls itself may be anything.
  MemoryBoard odd(device("a\nb", "1-8", "\xff\x1b[2J"), none);
  rig.sockets.plug(odd);
  assert_contains(rig.refusal(1, "1-8").what(), { "??[2J (serial a?b, at 1-8) has 0 pins" });
  rig.sockets.unplug(odd);

  // No more tactors than are wanted.
  DriverConfig config = rig.config();
  config.max_tactors = 4;
  rig.driver.open(config);
  ck_assert_int_eq(rig.driver.tactors(), 4);
  rig.write(std::vector<double>(6, 3.0));
  rig.expect(rig.uno, std::vector<double>(4, 3.0));
}
GST_END_TEST;

GST_START_TEST(test_which_board_returns)
{
  Rig rig;
  rig.sockets.plug(rig.mega);
  rig.open();
  rig.write({ 2.0 });
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost);
  // Not another one, though in the same socket…
  MemoryBoard other(device("8", "1-2"), kMega);
  MemoryBoard same(device("7573", "3-1"), kMega);
  rig.sockets.plug(other);
  // …but the same in another socket.
  rig.sockets.plug(same);
  rig.wait_for(EventKind::returned);
  rig.expect(same, { 2.0 });
  ck_assert_int_eq(other.opens, 0);
  rig.driver.close();
  rig.sockets.unplug(same);
  rig.sockets.unplug(other);

  // Without a number the socket counts; of clones with one number it is preferred.
  for (const char *number : { "", "0000" }) {
    MemoryBoard clone(device(number, "1-2"), kMega);
    MemoryBoard twin(device(number, "1-1"), kMega);
    rig.sockets.plug(clone);
    rig.open();
    rig.write({ 1.0 });
    const int times = rig.count(EventKind::lost);
    rig.sockets.announces = false;
    rig.sockets.unplug(clone);
    rig.wait_for(EventKind::lost, times + 1);
    rig.sockets.plug(twin);
    rig.sockets.plug(clone);
    rig.sockets.announces = true;
    rig.sockets.announce();
    rig.expect(clone, { 1.0 });
    ck_assert_int_eq(twin.opens, 0);
    rig.driver.close();
    rig.sockets.unplug(clone);
    rig.sockets.unplug(twin);
  }

  // A board that was changed for one with fewer pins is not taken.
  rig.sockets.plug(rig.mega);
  rig.open();
  const int times = rig.count(EventKind::lost);
  const int returned = rig.count(EventKind::returned);
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost, times + 1);
  MemoryBoard smaller(rig.mega.device, kUno);
  rig.sockets.plug(smaller);
  rig.sockets.wait([&] { return smaller.opens > 0 && !smaller.is_open; });
  ck_assert_int_eq(rig.count(EventKind::returned), returned);
}
GST_END_TEST;

/// `seat` wants the watchdog; `firmata` uses it where it is.
GST_START_TEST(test_seat)
{
  FirmataPatience patience = kEndless;
  patience.keepalive = 2ms;
  Rig rig(Firmware::with_watchdog, patience);
  rig.sockets.plug(rig.mega);
  const DriverError error = rig.refusal();
  fail_unless(error.kind() == Kind::settings);
  assert_contains(error.what(), { "seat firmware", "StandardFirmata.ino 2.5", "driver=firmata" });
  fail_if(rig.mega.is_open);
  rig.sockets.plug(rig.seat);
  rig.open();
  fail_unless(rig.seat.is_open);
  fail_unless(rig.driver.refresh_interval() == 2ms);

  Rig any(Firmware::any, patience);
  any.sockets.plug(any.seat);
  any.open();
  fail_unless(any.driver.status().has_watchdog);
  ck_assert_int_eq(any.count(EventKind::warning), 0);
  any.write({ 1.0 });
  any.sockets.wait([&] { return any.seat.model.keepalives > 10; });
  any.expect(any.seat, { 1.0 });
}
GST_END_TEST;

/// A scheduler that hangs does not leave motors on.
GST_START_TEST(test_scheduler_hangs)
{
  FirmataPatience patience = kEndless;
  patience.host_silence = 20ms;
  Rig rig(Firmware::any, patience);
  rig.sockets.plug(rig.mega);
  rig.open();
  // On a busy computer the driver may come to it too late.
  while (rig.sockets.locked([&] { return rig.mega.model.is_silent(); })) {
    rig.write({ 1.0, 2.0 });
    std::this_thread::yield();
  }
  rig.expect(rig.mega, {});
}
GST_END_TEST;

/// Boards come and go while a film plays and others ask how it is.
GST_START_TEST(test_many_threads)
{
  for (unsigned seed = 1; seed <= 10; seed++) {
    FirmataPatience patience = kEndless;
    patience.keepalive = 1ms;
    Rig rig(Firmware::any, patience, 1ms);
    MemoryBoard &board = seed % 2 == 0 ? rig.mega : rig.seat;
    rig.sockets.announces = seed % 3 != 0;
    rig.sockets.plug(board);
    rig.open();
    std::thread plugger([&] {
      std::mt19937 random(seed);
      for (int i = 1; i <= 20; i++) {
        rig.sockets.locked([&] { board.bytes_to_live = 1 + static_cast<long>(random() % 200); });
        rig.wait_for(EventKind::lost, i);
        rig.sockets.locked([&] { board.bytes_to_live = -1; });
        rig.sockets.plug(board);
        rig.wait_for(EventKind::returned, i);
      }
    });
    std::atomic<bool> done{ false };
    std::thread asker([&] {
      while (!done) {
        rig.driver.status();
        std::this_thread::yield();
      }
    });
    std::thread film([&] {
      for (unsigned i = 0; !done; i++) {
        rig.write({ (i % 100) / 50.0, (i % 7) / 3.0, (i % 3) / 1.5 });
        std::this_thread::yield();
      }
    });
    plugger.join();
    done = true;
    film.join();
    asker.join();
    rig.write({ 0.3, 2.0 });
    rig.expect(board, { 0.3, 2.0 });
    ck_assert_uint_eq(rig.driver.status().reconnects, 20);
    rig.driver.close();
    fail_unless(board.model.is_silent());
  }
}
GST_END_TEST;

/* ---- auto ---- */

GST_START_TEST(test_auto)
{
  Rig rig;
  auto simulator = std::make_unique<Simulator>();
  const Simulator &simulated = *simulator;
  AutoDriver driver(std::make_unique<FirmataDriver>(
                        Firmware::any, [&] { return std::make_unique<MemoryBus>(rig.sockets); },
                        FirmataDriver::Settings{ .patience = kEndless }),
                    std::move(simulator));

  // Nothing is plugged in.
  driver.open(rig.config());
  fail_unless(driver.status().board == "simulator");
  assert_contains(rig.text(EventKind::opened), { "simulated", "no tactor board" });
  ck_assert_int_eq(rig.count(EventKind::warning), 0);
  ck_assert_int_eq(driver.tactors(), 4096);
  driver.write(std::vector<double>{ 3.0 }, 0s);
  fail_unless(simulated.amplitude(0, 1s) > 2.9);
  driver.close();
  fail_unless(driver.tactors() == 0);

  // A board is.
  rig.sockets.plug(rig.uno);
  driver.open(rig.config());
  ck_assert_int_eq(driver.tactors(), 6);
  fail_unless(driver.status().firmware == "StandardFirmata.ino 2.5");
  fail_unless(driver.refresh_interval() == kEndless.keepalive);
  fail_unless(driver.transport_latency() == 3125us); // 18 bytes
  driver.write(std::vector<double>{ 3.0 }, 0s);
  rig.sockets.wait([&] { return rig.uno.model.duty[3] == 255; });
  driver.close();
  fail_unless(rig.uno.model.is_silent());

  // One that is named, or that does not fit, is no matter of choice.
  for (const auto &[name, tactors, kind] :
       { std::tuple("1-7", 1, Kind::not_found), std::tuple("", 9, Kind::settings) }) {
    try {
      driver.open(rig.config(tactors, name));
      fail("it was opened");
    } catch (const DriverError &error) {
      fail_unless(error.kind() == kind);
      fail_unless(driver.tactors() == 0);
    }
  }

  // One that may not be opened is said aloud.
  rig.uno.refusal = Kind::permission;
  rig.events.clear();
  driver.open(rig.config());
  fail_unless(driver.status().board == "simulator");
  assert_contains(rig.text(EventKind::warning), { "simulated", "Uno is refused" });
}
GST_END_TEST;

static Suite *
firmata_driver_suite(void)
{
  Suite *suite = suite_create("firmata_driver");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_open_write_close);
  tcase_add_test(tests, test_destroyed);
  tcase_add_test(tests, test_unplug_and_replug);
  tcase_add_test(tests, test_unplug_in_each_phase);
  tcase_add_test(tests, test_stalled_board);
  tcase_add_test(tests, test_no_board);
  tcase_add_test(tests, test_silent_board);
  tcase_add_test(tests, test_open_is_interrupted);
  tcase_add_test(tests, test_two_boards);
  tcase_add_test(tests, test_too_few_pins);
  tcase_add_test(tests, test_which_board_returns);
  tcase_add_test(tests, test_seat);
  tcase_add_test(tests, test_scheduler_hangs);
  tcase_add_test(tests, test_many_threads);
  tcase_add_test(tests, test_auto);
  return suite;
}

GST_CHECK_MAIN(firmata_driver)
