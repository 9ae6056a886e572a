// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Which board the drivers for real boards and the default driver choose, which they refuse, and
// which one they take for the one that was lost.
#include "tactor/drivers/auto_driver.h"
#include "tactor/drivers/release_boards.h"
#include "tactor/simulator.h"

#include <filesystem>
#include <fstream>
#include <thread>

#include "firmata_driver_rig.h"

#include "support/check_tests.h"

CHECK_TEST(test_no_board)
{
  DriverRig rig;
  const DriverError none = rig.refusal();
  fail_unless(none.kind == Kind::not_found);
  assert_contains(none.text, { "StandardFirmata" });
  rig.sockets.plug(rig.mega);
  rig.sockets.plug(rig.uno);
  const DriverError other = rig.refusal(1, "12345");
  fail_unless(other.kind == Kind::not_found);
  assert_contains(other.text, { "'12345'", "7573", "1-2", "Arduino Uno", "95", "1-3" });
  ck_assert_int_eq(rig.mega.opens + rig.uno.opens, 0);

  for (const Kind kind : { Kind::permission, Kind::busy, Kind::failed }) {
    rig.mega.refusal = kind;
    const DriverError error = rig.refusal(1, "7573");
    fail_unless(error.kind == kind);
    assert_contains(error.text, { "refused" });
  }
  FirmataDriver broken(Firmware::any, [] {
    return tl::unexpected(DriverError{ Kind::failed, "no bus" });
  });
  assert_contains(refusal_of(broken.open({})).text, { "no bus" });
}

CHECK_TEST(test_silent_board)
{
  FirmataPatience patience = kEndless;
  patience.answer = 20ms;
  patience.ask_again = 5ms;
  DriverRig rig(Firmware::any, patience);
  rig.mega.says_nothing = true;
  rig.sockets.plug(rig.mega);
  const DriverError error = rig.refusal();
  fail_unless(error.kind == Kind::failed);
  assert_contains(error.text, { "Mega", "7573", "does not answer", "StandardFirmata" });
  fail_if(rig.mega.is_open);
}

/// Opening a board that never answers can be interrupted.
CHECK_TEST(test_open_is_interrupted)
{
  DriverRig rig;
  rig.mega.says_nothing = true;
  rig.sockets.plug(rig.mega);
  std::thread other([&] {
    rig.sockets.wait([&] { return rig.mega.opens == 1; });
    rig.stop.request_stop();
  });
  const DriverError error = rig.refusal();
  assert_contains(error.text, { "stopped" });
  other.join();
  fail_if(rig.mega.is_open);

  // The stop may precede the call.
  rig.refusal();
  fail_if(rig.mega.is_open);
}

/// Opening a port whose set-up never completes can be interrupted, too.
CHECK_TEST(test_stopped_while_the_port_is_set_up)
{
  DriverRig rig;
  rig.mega.hangs_on_open = true;
  rig.sockets.plug(rig.mega);
  std::thread other([&] {
    rig.sockets.wait([&] { return rig.mega.opens == 1; });
    rig.stop.request_stop();
  });
  assert_contains(rig.refusal().text, { "interrupted" });
  other.join();
  rig.stop = std::stop_source();
  rig.sockets.locked([&] { rig.mega.hangs_on_open = false; });
  rig.open();
}

/// The first usable board is taken, unless a serial number or a socket names one.
CHECK_TEST(test_two_boards)
{
  DriverRig rig;
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
  assert_contains(rig.refusal().text, { "Uno is refused", "Mega 2560 is refused" });
}

CHECK_TEST(test_too_few_pins)
{
  DriverRig rig;
  rig.sockets.plug(rig.uno);
  const DriverError error = rig.refusal(9);
  fail_unless(error.kind == Kind::settings);
  assert_contains(error.text, { "6 pins", "3, 5, 6, 9, 10, 11", "9 tactors", "mapping" });
  fail_unless(rig.uno.model.is_silent());
  fail_if(rig.uno.is_open);
  rig.open(6);

  ::Layout none = kUno;
  none.pwm.clear();
  MemoryBoard bare(device("0", "1-9"), none);
  rig.sockets.plug(bare);
  fail_unless(rig.refusal(1, "1-9").kind == Kind::settings);
  rig.driver.close();
  rig.sockets.unplug(bare);

  // A device's name may contain any bytes.
  MemoryBoard odd(device("a\nb", "1-8", "\xff\x1b[2J"), none);
  rig.sockets.plug(odd);
  assert_contains(rig.refusal(1, "1-8").text,
                  { "??[2J (serial a?b, at 1-8): expected pins", "has none" });
  rig.sockets.unplug(odd);

  // No more tactors than requested.
  DriverConfig config = rig.config();
  config.max_tactors = 4;
  unwrap(rig.driver.open(config));
  ck_assert_int_eq(rig.driver.tactors(), 4);
  rig.write(std::vector<double>(6, 3.0));
  rig.expect(rig.uno, std::vector<double>(4, 3.0));
}

CHECK_TEST(test_which_board_returns)
{
  DriverRig rig;
  rig.sockets.plug(rig.mega);
  rig.open();
  rig.write({ 2.0 });
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost);
  // Another board in the same socket is not taken…
  MemoryBoard other(device("8", "1-2"), kMega);
  MemoryBoard same(device("7573", "3-1"), kMega);
  rig.sockets.plug(other);
  // …but the same one in another socket is.
  rig.sockets.plug(same);
  rig.wait_for(EventKind::returned);
  rig.expect(same, { 2.0 });
  ck_assert_int_eq(other.opens, 0);
  rig.driver.close();
  rig.sockets.unplug(same);
  rig.sockets.unplug(other);

  // Without a serial number the socket decides. Of clones with equal numbers the one in the same
  // socket is preferred.
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

  // A board that returns with fewer pins is not taken.
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

namespace {

/// A driver with a short patience, on a computer where no board is known.
struct StrangersRig : DriverRig
{
  static constexpr FirmataPatience kShort{ .answer = 300ms,
                                           .ask_again = 5ms,
                                           .transfer = 1h,
                                           .host_silence = 1h,
                                           .keepalive = 1h,
                                           .drain = 1h };

  StrangersRig() : DriverRig(Firmware::any, kShort)
  {
    std::filesystem::remove(folder.file("boards"));
  }
  /// As driver=auto.
  DriverConfig careful(const std::string &name = "")
  {
    DriverConfig config = this->config(1, name);
    config.asks_a_stranger = false;
    return config;
  }
  /// The refusal of a play that touches no device.
  std::string untouched(const DriverConfig &config, Kind kind = Kind::not_asked)
  {
    const int opens = mega.opens + uno.opens;
    const DriverError error = refusal_of(driver.open(config));
    fail_unless(error.kind == kind, "%s", error.text.c_str());
    ck_assert_int_eq(mega.opens + uno.opens, opens);
    return error.text;
  }
};

} // namespace

/// Whoever made it: the default driver touches no device that has not answered before. It says how
/// a chair is named once.
CHECK_TEST(test_strangers)
{
  StrangersRig rig;
  rig.sockets.plug(rig.mega);
  assert_contains(rig.untouched(rig.careful()),
                  { "Arduino Mega 2560 (serial 7573, at 1-2)", "not probed", "3D printer",
                    "visuotactile-play --feel-test --device=1-2" });
  unwrap(rig.driver.open(rig.careful("1-2")));
  fail_unless(rig.mega.is_open && rig.mega.has_dtr);

  // From now on it comes first, in any socket, and nobody waits for the stranger before it.
  MemoryBoard elsewhere(device("7573", "3-1"), kMega);
  rig.driver.close();
  rig.sockets.unplug(rig.mega);
  rig.uno.says_nothing = true;
  rig.sockets.plug(rig.uno);
  rig.sockets.plug(elsewhere);
  for (const DriverConfig &config : { rig.careful(), rig.config() }) {
    unwrap(rig.driver.open(config));
    fail_unless(elsewhere.is_open);
    ck_assert_int_eq(rig.uno.opens, 0);
  }
  // The stranger is not asked instead of a chair that cannot be used.
  elsewhere.refusal = Kind::busy;
  for (const DriverConfig &config : { rig.careful(), rig.config() })
    assert_contains(refusal_of(rig.driver.open(config)).text,
                    { "is refused; not probed", "Arduino Uno (serial 95, at 1-3)" });
  ck_assert_int_eq(rig.uno.opens, 0);
}

/// A caller that says that there is a board has the only stranger asked, without a reset.
CHECK_TEST(test_the_only_stranger)
{
  StrangersRig rig;
  rig.sockets.plug(rig.mega);
  rig.open();
  fail_unless(rig.mega.is_open);
  fail_if(rig.mega.has_dtr);
  rig.open(); // it is known
  fail_unless(rig.mega.has_dtr);

  // One that is silent until DTR has to be named.
  StrangersRig leonardo;
  leonardo.mega.needs_dtr = true;
  leonardo.sockets.plug(leonardo.mega);
  assert_contains(leonardo.refusal().text, { "does not answer", "device=1-2" });
  leonardo.open(1, "1-2");
  leonardo.open();

  // Of two it is not known which one is the board.
  StrangersRig two;
  two.sockets.plug(two.mega);
  two.sockets.plug(two.uno);
  assert_contains(two.untouched(two.config()), { "Arduino Mega", "Arduino Uno", "one of these" });
}

/// One that did not answer is not asked again until it is named, and no more after that.
CHECK_TEST(test_refusals_are_remembered)
{
  StrangersRig rig;
  rig.mega.says_nothing = true;
  rig.sockets.plug(rig.mega);
  assert_contains(rig.refusal().text, { "does not answer", "device=1-2" });
  for (const DriverConfig &config : { rig.careful(), rig.config() })
    assert_contains(rig.untouched(config, Kind::not_found), // it was asked, and is none
                    { "Arduino Mega 2560", "--device=1-2" });
  // Another one is the only stranger now.
  rig.sockets.plug(rig.uno);
  rig.open();
  fail_unless(rig.uno.is_open);
  rig.sockets.locked([&] { rig.mega.says_nothing = false; });
  rig.open(1, "7573");
  rig.open();
  fail_unless(rig.mega.is_open);

  // A board that has answered before stays known by its serial number, also if it hangs for once.
  rig.driver.close();
  rig.sockets.unplug(rig.uno);
  rig.mega.says_nothing = true;
  for (int i = 0; i < 2; i++)
    assert_contains(refusal_of(rig.driver.open(rig.careful())).text, { "does not answer" });
}

/// Where nothing can be remembered that is said.
CHECK_TEST(test_no_memory)
{
  StrangersRig rig;
  std::filesystem::create_directory(rig.folder.file("boards"));
  std::ofstream(rig.folder.file("boards/in the way"));
  rig.sockets.plug(rig.mega);
  rig.open(1, "1-2");
  assert_contains(rig.text(EventKind::opened), { "cannot be remembered" });
  rig.untouched(rig.careful());
}

/// A board that another program has open is refused as busy.
CHECK_TEST(test_in_use)
{
  DriverRig rig;
  rig.sockets.plug(rig.mega);
  DriverConfig careful = rig.config();
  careful.asks_a_stranger = false;
  rig.mega.use = { LineUse::Kind::certain, "cat (process 7) has ttyACM0 open" };
  for (const DriverConfig &config : { rig.config(), rig.config(1, "1-2"), careful }) {
    const DriverError error = refusal_of(rig.driver.open(config));
    fail_unless(error.kind == Kind::busy);
    assert_contains(error.text, { "Mega 2560", "in use by another program", "cat (process 7)" });
  }
  // Where the use is uncertain, callers that name or require a board try it nevertheless.
  rig.mega.use.kind = LineUse::Kind::perhaps;
  fail_unless(refusal_of(rig.driver.open(careful)).kind == Kind::busy);
  ck_assert_int_eq(rig.mega.opens, 0);
  careful.device = "1-2";
  unwrap(rig.driver.open(careful));
  unwrap(rig.driver.open(rig.config()));
}

/// A board that is busy is tried again: the guardian of the last play may be stopping it. Stopping
/// ends that.
CHECK_TEST(test_busy_for_a_while)
{
  for (const bool stops : { false, true }) {
    DriverRig rig(Firmware::any, kEndless, 1h, {}, 1h);
    rig.sockets.plug(rig.mega);
    rig.mega.refusal = Kind::busy;
    const std::jthread other([&] {
      rig.sockets.wait([&] { return rig.mega.opens == 3; });
      if (stops)
        rig.stop.request_stop();
      else
        rig.sockets.locked([&] { rig.mega.refusal.reset(); });
    });
    fail_unless(rig.driver.open(rig.config()).has_value() == !stops);
    fail_unless(rig.mega.is_open == !stops);
    rig.driver.close();
  }
}

/// Releases only boards that a killed player left open: sets their motors to zero and closes them.
CHECK_TEST(test_release_boards)
{
  DriverRig rig;
  for (MemoryBoard *board : { &rig.mega, &rig.uno }) {
    board->resets_on_open = false; // like a Leonardo
    rig.sockets.plug(*board);
    for (const std::uint8_t byte : { 0xf4, 3, 3, 0xe3, 0x7f, 1 }) // pin 3 to PWM, 255
      board->model.receive(byte, {});
    ck_assert_int_eq(board->model.duty[3], 255);
  }
  rig.mega.is_left = true;
  MemoryBoard stranger(device("9", "1-9", "Printer"), kMega);
  stranger.is_left = true;
  rig.sockets.plug(stranger);
  const auto release = [&](const char *name) {
    return unwrap(
        release_boards(name, [&] { return std::make_unique<MemoryBus>(rig.sockets); },
                       { .patience = kEndless, .known_boards = rig.folder.file("boards") }));
  };
  std::vector<ReleasedBoard> released = release("");
  ck_assert_uint_eq(released.size(), 2);
  fail_unless(released[0].device == rig.mega.device && !released[0].refusal);
  fail_unless(rig.mega.model.is_silent() && !rig.mega.is_open);
  ck_assert_int_eq(rig.uno.model.duty[3], 255);
  ck_assert_int_eq(rig.uno.opens + stranger.opens, 0);
  assert_contains(released[1].refusal.value().text, { "not known", "--device=1-9" });
  released = release("1-9");
  ck_assert_uint_eq(released.size(), 1);
  fail_if(released[0].refusal);
  ck_assert_int_eq(stranger.opens, 1);
}

/// The film does not move to another chair. Of two boards with equal serial numbers, the driver
/// waits for the one in the same socket, however it is named.
CHECK_TEST(test_twin_is_not_taken)
{
  for (const char *name : { "1-2", "", "7573" }) {
    MemoryBoard twin(device("7573", "1-3"), kMega);
    DriverRig rig;
    rig.sockets.plug(rig.mega);
    // The twin is plugged in before the film, or while it plays.
    const bool comes_later = *name != '1';
    if (!comes_later)
      rig.sockets.plug(twin);
    rig.open(1, name);
    rig.write({ 1.0 });
    if (comes_later)
      rig.sockets.plug(twin);
    rig.sockets.unplug(rig.mega);
    rig.wait_for(EventKind::lost);
    rig.sockets.announce();
    rig.sockets.plug(rig.mega);
    rig.wait_for(EventKind::returned);
    ck_assert_int_eq(twin.opens, 0);
    assert_contains(rig.text(EventKind::lost), { "looked for at 1-2 alone" });
    rig.expect(rig.mega, { 1.0 });
  }
}

/// A named socket stands for whatever board is in it.
CHECK_TEST(test_socket_is_named)
{
  MemoryBoard other(device("8", "1-2", "Another Mega"), kMega);
  MemoryBoard elsewhere(device("7573", "1-3"), kMega);
  DriverRig rig;
  rig.sockets.plug(rig.mega);
  rig.open(1, "1-2");
  rig.write({ 1.0 });
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost);
  rig.sockets.plug(elsewhere);
  rig.sockets.plug(other);
  rig.wait_for(EventKind::returned);
  ck_assert_int_eq(elsewhere.opens, 0);
  rig.expect(other, { 1.0 });
}

/// A board that returns but cannot be used is reported once for each reason, while the driver keeps
/// trying.
CHECK_TEST(test_refused_when_it_is_back)
{
  ::Layout small = kMega;
  small.pwm = { 2, 3, 4 };
  MemoryBoard smaller(device("7573", "1-2"), small);
  DriverRig rig(Firmware::any, kEndless, 1ms);
  const auto refused = [&] {
    return rig.count(EventKind::refused);
  };
  rig.sockets.plug(rig.mega);
  rig.open();
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost);
  rig.mega.refusal = Kind::permission;
  rig.sockets.plug(rig.mega);
  const auto wait_for_tries = [&] {
    const int opens = rig.sockets.locked([&] { return rig.mega.opens; });
    rig.sockets.wait([&] { return rig.mega.opens > opens + 10; });
  };
  wait_for_tries();
  ck_assert_int_eq(refused(), 1);
  assert_contains(rig.text(EventKind::refused), { "cannot be used", "Mega 2560 is refused" });
  rig.sockets.locked([&] { rig.mega.use = { LineUse::Kind::certain, "cat has it" }; });
  rig.wait_for(EventKind::refused, 2);
  rig.sockets.locked([&] { rig.mega.use = {}; });
  wait_for_tries();
  ck_assert_int_eq(refused(), 2);
  rig.sockets.locked([&] { rig.mega.refusal.reset(); });
  rig.wait_for(EventKind::returned);

  // Reported again on each return. A refusal that cannot change is not retried until another board
  // opens.
  rig.sockets.unplug(rig.mega);
  rig.wait_for(EventKind::lost, 2);
  rig.sockets.plug(smaller);
  rig.wait_for(EventKind::refused, 3);
  rig.sockets.plug(rig.uno);
  rig.sockets.wait([&] { return smaller.opens == 2; });
  rig.sockets.unplug(smaller);
  rig.sockets.plug(rig.mega);
  rig.wait_for(EventKind::returned, 2);
  ck_assert_int_eq(smaller.opens, 2);
  ck_assert_int_eq(refused(), 3);
}

/// The driver `seat` requires the watchdog, `firmata` uses it if there is one.
CHECK_TEST(test_seat)
{
  FirmataPatience patience = kEndless;
  patience.keepalive = 2ms;
  DriverRig rig(Firmware::with_watchdog, patience);
  rig.sockets.plug(rig.mega);
  const DriverError error = rig.refusal();
  fail_unless(error.kind == Kind::settings);
  assert_contains(error.text, { "seat firmware", "StandardFirmata.ino 2.5", "driver=firmata" });
  fail_if(rig.mega.is_open);
  rig.sockets.plug(rig.seat);
  rig.open();
  fail_unless(rig.seat.is_open);
  fail_unless(rig.driver.refresh_interval() == 2ms);

  DriverRig any(Firmware::any, patience);
  any.sockets.plug(any.seat);
  any.open();
  fail_unless(any.driver.status().has_watchdog);
  ck_assert_int_eq(any.count(EventKind::warning), 0);
  any.write({ 1.0 });
  any.sockets.wait([&] { return any.seat.model.keepalives > 10; });
  any.expect(any.seat, { 1.0 });
}

/* ---- auto ---- */

CHECK_TEST(test_auto)
{
  DriverRig rig;
  auto simulator = std::make_unique<Simulator>();
  const Simulator &simulated = *simulator;
  AutoDriver driver(std::make_unique<FirmataDriver>(
                        Firmware::any, [&] { return std::make_unique<MemoryBus>(rig.sockets); },
                        FirmataDriver::Settings{ .patience = kEndless,
                                                 .known_boards = rig.folder.file("boards") }),
                    std::move(simulator));

  // No board is plugged in.
  unwrap(driver.open(rig.config()));
  fail_unless(driver.status().board == "simulator");
  assert_contains(rig.text(EventKind::opened), { "simulated", "no tactor board" });
  ck_assert_int_eq(rig.count(EventKind::warning), 0);
  ck_assert_int_eq(driver.tactors(), 4096);
  unwrap(driver.write(std::vector<double>{ 3.0 }, 0s));
  fail_unless(simulated.amplitude(0, 1s) > 2.9);
  driver.close();
  fail_unless(driver.tactors() == 0);

  // A board is plugged in.
  rig.sockets.plug(rig.uno);
  unwrap(driver.open(rig.config()));
  ck_assert_int_eq(driver.tactors(), 6);
  fail_unless(driver.status().firmware == "StandardFirmata.ino 2.5");
  fail_unless(driver.refresh_interval() == kEndless.keepalive);
  fail_unless(driver.transport_latency() == 3150us); // 18 bytes
  unwrap(driver.write(std::vector<double>{ 3.0 }, 0s));
  rig.sockets.wait([&] { return rig.uno.model.duty[3] == 255; });
  driver.close();
  fail_unless(rig.uno.model.is_silent());

  // A named board that is missing and a board that does not fit are errors.
  for (const auto &[name, tactors, kind] :
       { std::tuple("1-7", 1, Kind::not_found), std::tuple("", 9, Kind::settings) }) {
    fail_unless(refusal_of(driver.open(rig.config(tactors, name))).kind == kind);
    fail_unless(driver.tactors() == 0);
  }

  // A device that was never asked causes a warning, once in this process.
  MemoryBoard printer(device("P", "1-9", "Printer"), kMega);
  rig.sockets.unplug(rig.uno);
  rig.sockets.plug(printer);
  for (const EventKind kind : { EventKind::warning, EventKind::opened }) {
    rig.events.clear();
    unwrap(driver.open(rig.config()));
    assert_contains(rig.text(kind), { "simulated", "not probed", "--device=1-9" });
    ck_assert_uint_eq(rig.events.size(), 1);
  }
  ck_assert_int_eq(printer.opens, 0);
  driver.close();
  rig.sockets.unplug(printer);
  rig.sockets.plug(rig.uno);

  // A board that may not be opened causes a warning.
  rig.uno.refusal = Kind::permission;
  rig.events.clear();
  unwrap(driver.open(rig.config()));
  fail_unless(driver.status().board == "simulator");
  assert_contains(rig.text(EventKind::warning), { "simulated", "Uno is refused" });
}

CHECK_MAIN(firmata_driver_choice)
