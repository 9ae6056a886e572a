// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A board whose motors are on is stopped without its last host, and the driver tells if it cannot
// be.
#include "tactor/drivers/stop_board.h"

#include "firmata_driver_rig.h"

#include "support/check_tests.h"

namespace {

constexpr StopPatience kEndlessly{ .answer = 1h };
constexpr StopPatience kBriefly{ .answer = 1ms };

/// A board that its last host has left, maybe within a message.
struct Left
{
  explicit Left(const std::vector<std::uint8_t> &begun = {})
  {
    board.resets_on_open = false; // the line was open all along
    sockets.plug(board);
    board.model.replies.clear(); // the banner was read
    for (const int byte : { 0xf4, 3, 3, 0xe3, 0x7f, 1 })
      board.model.receive(static_cast<std::uint8_t>(byte), {});
    for (const std::uint8_t byte : begun)
      board.model.receive(byte, {});
    fail_if(board.model.is_silent());
  }

  Sockets sockets;
  MemoryBus bus{ sockets };
  MemoryBoard board{ device("7573", "1-2"), kMega };
};

} // namespace

/// By a reset that the board confirms, wherever its host was cut off.
CHECK_TEST(test_stopped)
{
  const std::vector<std::uint8_t> cuts[]
      = { {}, { 0xe3 }, { 0xe3, 0x40 }, { 0xf4, 3 }, { 0xf0 }, { 0xf0, 0x6f, 44, 0 } };
  for (const std::vector<std::uint8_t> &cut : cuts) {
    Left left(cut);
    bool may_pulse = true;
    unwrap(stop_board(left.bus, left.board.device, &may_pulse, kEndlessly));
    fail_unless(may_pulse);
    fail_unless(left.board.model.is_silent());
    fail_if(left.board.is_open);
    ck_assert_int_eq(left.board.pulses, 0);
  }
}

/// One that does not answer, or takes nothing, is reset by DTR; that it answers is not waited for.
CHECK_TEST(test_not_stopped)
{
  for (const bool takes_nothing : { false, true })
    for (const bool pulses : { false, true }) {
      bool may_pulse = pulses;
      Left left;
      left.board.says_nothing = true;
      left.board.takes_nothing = takes_nothing;
      const DriverError error
          = refusal_of(stop_board(left.bus, left.board.device, &may_pulse, kBriefly));
      assert_contains(error.text, { "7573", takes_nothing ? "does not take" : "does not" });
      fail_unless(error.kind == Kind::failed);
      ck_assert_int_eq(left.board.pulses, pulses);
      fail_if(may_pulse);
      fail_if(left.board.is_open);
    }
}

/// Such a board was not reset by DTR: that is left for the next time.
CHECK_TEST(test_cannot_be_opened)
{
  Left left;
  bool may_pulse = true;
  for (const Kind kind : { Kind::busy, Kind::failed }) {
    left.board.refusal = kind;
    fail_unless(refusal_of(stop_board(left.bus, left.board.device, &may_pulse)).kind == kind);
  }
  left.sockets.unplug(left.board);
  fail_unless(refusal_of(stop_board(left.bus, left.board.device, &may_pulse)).kind
              == Kind::not_found);
  fail_unless(may_pulse);
}

namespace {

constexpr FirmataPatience kShort{ .answer = 1h,
                                  .ask_again = 1h,
                                  .transfer = 1h,
                                  .host_silence = 1h,
                                  .keepalive = 1h,
                                  .drain = 1ms,
                                  .acknowledge = 1ms };

/// A driver whose board has `volts` and then misbehaves at the end.
struct LastWords
{
  LastWords(double volts, void (*misbehave)(DriverRig &), bool seat = false,
            FirmataPatience patience = kShort)
      : rig(Firmware::any, patience, 1h, kBriefly)
  {
    MemoryBoard &board = seat ? rig.seat : rig.mega;
    rig.sockets.plug(board);
    rig.open();
    rig.write({ 3.0 });
    rig.expect(board, { 3.0 });
    if (volts == 0) {
      rig.write({ 0.0 });
      rig.expect(board, {});
    }
    misbehave(rig);
    rig.driver.close();
  }
  bool are_told() const
  {
    fail_unless(rig.driver.status().may_run == (rig.count(EventKind::not_stopped) == 1));
    return rig.driver.status().may_run;
  }

  mutable DriverRig rig;
};

} // namespace

/// A board that does not confirm its last zeros: it is told that motors may still be on.
CHECK_TEST(test_told)
{
  const auto hush = [](DriverRig &rig) {
    rig.sockets.locked([&] { rig.mega.says_nothing = rig.seat.says_nothing = true; });
  };
  const auto stall = [](DriverRig &rig) {
    rig.sockets.locked([&] {
      rig.mega.takes_nothing = rig.seat.takes_nothing = true;
      rig.mega.resets_on_open = false; // else its banner would come
    });
  };
  for (void (*misbehave)(DriverRig &) : { +hush, +stall }) {
    const LastWords last(3.0, misbehave);
    fail_unless(last.are_told());
    assert_contains(last.rig.text(EventKind::not_stopped),
                    { "7573", "its motors may still be on: switch their supply off" });
    ck_assert_int_eq(last.rig.mega.opens, 2); // it was tried again
    ck_assert_int_eq(last.rig.mega.pulses, 1);
    fail_if(LastWords(3.0, misbehave, true).are_told()); // its watchdog stops them
  }
  FirmataPatience patient = kEndless;
  patient.acknowledge = 1h;
  fail_if(LastWords(
              3.0, [](DriverRig &) {}, false, patient)
              .are_told());
  // One that is unplugged may have a supply of its own.
  const auto unplug = [](DriverRig &rig) {
    rig.sockets.unplug(rig.mega);
    rig.wait_for(EventKind::lost);
  };
  const LastWords unplugged(3.0, unplug, false, patient);
  fail_unless(unplugged.are_told());
  for (const EventKind kind : { EventKind::lost, EventKind::not_stopped })
    assert_contains(unplugged.rig.text(kind),
                    { "plugged out", "its motors may still be on", "a supply of its own" });
}

/// One that recovers: nothing is told.
CHECK_TEST(test_tried_again)
{
  DriverRig rig(Firmware::any, kShort, 1h, kEndlessly);
  rig.sockets.plug(rig.mega);
  rig.open();
  rig.write({ 3.0 });
  rig.expect(rig.mega, { 3.0 });
  rig.sockets.locked([&] { rig.mega.takes_nothing_until_reopened = true; });
  rig.driver.close();
  fail_unless(rig.mega.model.is_silent());
  ck_assert_int_eq(rig.mega.opens, 2);
  fail_if(rig.driver.status().may_run);
  ck_assert_int_eq(rig.count(EventKind::not_stopped), 0);
}

CHECK_MAIN(stop_board)
