// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The driver of real boards once it has its board: levels, unplugging, stalls, threads.
// firmata_driver_choice tests how it finds one.
#include <array>
#include <atomic>
#include <cstdlib>
#include <random>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "firmata_driver_rig.h"
#include "support/realtime.h"

#include "support/check_tests.h"

CHECK_TEST(test_open_write_close)
{
  DriverRig rig;
  rig.sockets.plug(rig.mega);
  rig.open(9);
  ck_assert_int_eq(rig.driver.tactors(), 15);
  fail_unless(rig.driver.resolution() == 3.0 / 255);
  fail_unless(rig.driver.transport_latency() == 9450us); // 54 bytes
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
  const std::vector<std::uint8_t> &received = rig.mega.model.received;
  fail_unless(std::vector(received.end() - 2, received.end())
              == (std::vector<std::uint8_t>{ 0xff, 0xf9 }));
  fail_if(rig.mega.is_open);
  fail_unless(rig.driver.tactors() == 0);
  fail_if(rig.driver.status().is_there);
  ck_assert_uint_ge(rig.driver.status().bytes, rig.mega.model.received.size());
  rig.driver.close();

  rig.open();
  rig.write({ 2.0 });
  rig.expect(rig.mega, { 2.0 });
}

/// Whoever writes the levels goes on for ever: the driver's thread ends them.
CHECK_TEST(test_limits)
{
  DriverRig rig;
  rig.sockets.plug(rig.mega);
  DriverConfig config = rig.config();
  config.limits.max_on_time = 30ms;
  unwrap(rig.driver.open(config));
  const std::jthread writer([&](const std::stop_token &stop) {
    while (!stop.stop_requested()) {
      rig.write({ 3.0 });
      std::this_thread::yield();
    }
  });
  rig.sockets.wait([&] {
    const std::vector<std::uint8_t> &received = rig.mega.model.received;
    const std::array<std::uint8_t, 3> full{ 0xe2, 0x7f, 1 };
    const std::array<std::uint8_t, 3> zero{ 0xe2, 0, 0 };
    const auto on = std::ranges::search(received, full);
    return !std::ranges::search(on.begin(), received.end(), zero.begin(), zero.end()).empty();
  });
  ck_assert_uint_eq(rig.driver.status().cuts, 1);
}

/// The thread that carries levels to the board is real-time where that is permitted, and requests
/// the same of the port's thread.
CHECK_TEST(test_realtime)
{
  for (const bool wanted : { true, false }) {
    DriverRig rig;
    rig.sockets.plug(rig.mega);
    DriverConfig config = rig.config();
    config.realtime = wanted;
    unwrap(rig.driver.open(config));
    rig.write({ 3.0 });
    rig.expect(rig.mega, { 3.0 });
    const int expected = wanted && may_be_realtime() ? SCHED_RR : SCHED_OTHER;
    ck_assert_int_eq(rig.sockets.locked([&] { return rig.sockets.writer_policy; }), expected);
    fail_unless(rig.sockets.locked([&] { return rig.sockets.wants_realtime; }) == wanted);
  }
}

/// The destructor leaves motors at zero, too.
CHECK_TEST(test_destroyed)
{
  Sockets sockets;
  MemoryBoard board(device("1", "1-1"), kUno);
  sockets.plug(board);
  {
    FirmataDriver driver(Firmware::any, [&] { return std::make_unique<MemoryBus>(sockets); });
    unwrap(driver.open({}));
    unwrap(driver.write(std::vector<double>{ 3.0 }, 0s));
    sockets.wait([&] { return board.model.duty[3] == 255; });
  }
  fail_unless(board.model.is_silent());
  fail_if(board.is_open);
}

/// Unplugging gives one warning, and the film goes on. A board that returns resumes the current
/// levels. It is found by hot-plug events, or by polling where there are none.
CHECK_TEST(test_unplug_and_replug)
{
  for (const bool announces : { true, false }) {
    DriverRig rig(Firmware::any, kEndless, announces ? Time(1h) : Time(2ms));
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
    rig.driver.close(); // while it is unplugged
    fail_unless(rig.mega.model.is_silent());
  }
}

#ifndef __SANITIZE_THREAD__ // it takes a guardian's start for a fork, after which threads end it
/// A board that is back without the guardian that it had: the warning comes once more.
CHECK_TEST(test_guardian_is_missed)
{
  DriverRig rig;
  const std::string guardian = rig.folder.file("guardian", "#!/bin/sh\nexec cat\n");
  fail_unless(chmod(guardian.c_str(), 0700) == 0);
  setenv("VISUOTACTILE_GUARDIAN", guardian.c_str(), 1);
  rig.sockets.plug(rig.mega);
  DriverConfig config = rig.config();
  config.guardian = true;
  unwrap(rig.driver.open(config));
  assert_text(rig.driver.status().guardian, "running");
  for (int times = 1; times <= 3; times++) {
    if (times == 2)
      fail_unless(unlink(guardian.c_str()) == 0);
    rig.sockets.unplug(rig.mega);
    rig.wait_for(EventKind::lost, times);
    rig.sockets.plug(rig.mega);
    rig.wait_for(EventKind::returned, times);
  }
  rig.driver.close();
  ck_assert_int_eq(rig.count(EventKind::warning), 2); // the first one as it was opened
  const DriverEvent last = *std::ranges::find(rig.events.rbegin(), rig.events.rend(),
                                              EventKind::warning, &DriverEvent::kind);
  assert_contains(last.text, { "or the player is killed, as", guardian.c_str(), "No such file" });
}
#endif

/// Unplugged after any number of bytes, on first opening and on its return. Nothing hangs, and the
/// board is found again.
CHECK_TEST(test_unplug_in_each_phase)
{
  int refused = 0;
  int lost = 0;
  for (long bytes = 1; bytes < 130; bytes += bytes < 12 ? 1 : 7) {
    DriverRig rig;
    rig.sockets.plug(rig.mega);
    rig.mega.bytes_to_live = bytes;
    if (const auto opened = rig.driver.open(rig.config()); !opened) {
      refused++;
      fail_unless(opened.error().kind == Kind::failed);
      assert_contains(opened.error().text, { "plugged out" });
      fail_if(rig.mega.is_open);
      continue;
    }
    // During a film: more bytes are written than the board takes.
    for (int i = 0; rig.count(EventKind::lost) == 0; i++)
      rig.write({ i % 2 * 1.0, 2.0 });
    // During its return.
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
      4); // after 1 to 4 bytes at least: a question has 4, and the banner may come first
  ck_assert_int_ge(lost, 15);
}

/// A board that stays plugged in but takes no more bytes is reopened, which resets it.
CHECK_TEST(test_stalled_board)
{
  FirmataPatience patience = kEndless;
  patience.transfer = 250ms;
  patience.drain = 250ms;
  DriverRig rig(Firmware::any, patience, 2ms);
  rig.sockets.plug(rig.mega);
  // On a busy machine it may time out before it stalls. It returns in that case, too.
  while (!rig.driver.open(rig.config())) {
  }
  rig.sockets.locked([&] { rig.mega.takes_nothing = true; });
  const int lost = rig.count(EventKind::lost);
  rig.write({ 2.0 });
  rig.wait_for(EventKind::lost, lost + 1);
  rig.sockets.locked([&] { rig.mega.takes_nothing = false; });
  rig.wait_for(EventKind::returned, lost + 1);
  rig.expect(rig.mega, { 2.0 });
  // Closing a stalled board does not take long.
  rig.sockets.locked([&] { rig.mega.takes_nothing = true; });
  rig.write({ 1.0 });
  rig.driver.close();
  fail_if(rig.mega.is_open);
}

/// Motors stop when the scheduler hangs.
CHECK_TEST(test_scheduler_hangs)
{
  FirmataPatience patience = kEndless;
  patience.host_silence = 20ms;
  DriverRig rig(Firmware::any, patience);
  rig.sockets.plug(rig.mega);
  rig.open();
  // On a busy machine the driver's thread may run too late.
  while (rig.sockets.locked([&] { return rig.mega.model.is_silent(); })) {
    rig.write({ 1.0, 2.0 });
    std::this_thread::yield();
  }
  rig.expect(rig.mega, {});
}

/// Boards come and go during a film while other threads query the driver's status.
CHECK_TEST(test_many_threads)
{
  for (unsigned seed = 1; seed <= 10; seed++) {
    FirmataPatience patience = kEndless;
    patience.keepalive = 1ms;
    DriverRig rig(Firmware::any, patience, 1ms);
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

CHECK_MAIN(firmata_driver)
