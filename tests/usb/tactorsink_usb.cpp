// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink, driver, USB and firmware in real time: from tactile maps to the pins of an emulated
// Mega.
#include "map_stream.h"

#include <algorithm>
#include <map>
#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace usb_test;

namespace {

/// A Mega on a USB port, at the wire's real rate.
struct Mega
{
  explicit Mega(Transport transport = Transport::cdc_acm)
      : board(usb, { .transport = transport, .baud = 57600, .chip = 128 }, firmware)
  {
  }

  bool wait_for_motors(bool on)
  {
    return board.wait_until([&] { return firmware->any_motor_on() == on; });
  }

  std::map<int, std::vector<int>> duties() const
  {
    std::map<int, std::vector<int>> all;
    board.with_firmware([&] {
      for (const Firmware::Change &change : firmware->changes())
        all[change.pin].push_back(change.duty);
    });
    return all;
  }

  EmulatedUsb usb;
  std::shared_ptr<Firmware> firmware = std::make_shared<Firmware>();
  EmulatedBoard board;
};

/// Whether each pin got its planned duties. On a busy machine commands may be superseded: then a
/// subsequence with the last one.
bool
is_part_of(const std::map<int, std::vector<int>> &got,
           const std::map<int, std::vector<int>> &planned)
{
  return std::ranges::all_of(planned, [&](const auto &pin) {
    const auto found = got.find(pin.first);
    if (found == got.end())
      return false;
    auto rest = pin.second.begin();
    for (const int duty : found->second) {
      rest = std::find(rest, pin.second.end(), duty);
      if (rest == pin.second.end())
        return false;
      ++rest;
    }
    return found->second.back() == pin.second.back();
  });
}

} // namespace

CHECK_TEST(test_pins_get_what_was_planned)
{
  for (const Transport transport : kTransports) {
    bool all = false;
    for (int play = 0; play < 5 && !all; play++) {
      Mega mega(transport);
      MapStream film(8);
      film.play();
      fail_unless(film.wait_for(GST_MESSAGE_EOS));
      film.stop();
      const auto planned = planned_duties(film.trace());
      fail_unless(planned.size() == 9);
      const auto duties = mega.duties();
      fail_unless(is_part_of(duties, planned));
      all = duties == planned;
      fail_if(mega.firmware->any_motor_on());
      fail_unless(mega.firmware->resets() > 0);
    }
    fail_unless(all);
  }
}

CHECK_TEST(test_stopped_while_motors_are_on)
{
  Mega mega;
  MapStream film(20);
  film.play();
  fail_unless(mega.wait_for_motors(true));
  film.stop();
  fail_if(mega.firmware->any_motor_on());
  const Bytes told = mega.board.bytes();
  fail_unless(told[told.size() - 2] == 0xff && told.back() == 0xf9);
  fail_unless_equals_int(mega.board.transfers_pending(), 0);
}

CHECK_TEST(test_unplugged_and_plugged_in_again)
{
  for (const bool udev : { true, false }) {
    Mega mega;
    MapStream film(40);
    film.play();
    fail_unless(mega.wait_for_motors(true));
    if (!udev)
      mega.usb.stop_udev();
    mega.board.unplug();
    fail_unless(film.wait_for(GST_MESSAGE_ELEMENT, "tactor-device-lost"));
    mega.board.plug();
    fail_unless(film.wait_for(GST_MESSAGE_ELEMENT, "tactor-device-found"));
    fail_unless(mega.wait_for_motors(true));
    fail_unless(film.wait_for(GST_MESSAGE_EOS));
    film.stop();
    fail_if(mega.firmware->any_motor_on());
    fail_unless(film.errors.empty());
    int gone = 0;
    for (const std::string &warning : film.warnings)
      gone += warning.find("gone") != std::string::npos;
    fail_unless_equals_int(gone, 1);
  }
}

CHECK_TEST(test_unplugged_for_good)
{
  Mega mega;
  MapStream film(10);
  film.play();
  fail_unless(mega.wait_for_motors(true));
  mega.board.unplug();
  fail_unless(film.wait_for(GST_MESSAGE_EOS));
  fail_unless(film.errors.empty());
}

/// A board that stops accepting data is closed, and reopened when it accepts data again.
CHECK_TEST(test_stalled)
{
  Mega mega;
  MapStream film(40);
  film.play();
  fail_unless(mega.wait_for_motors(true));
  mega.board.stall(true);
  fail_unless(film.wait_for(GST_MESSAGE_ELEMENT, "tactor-device-lost"));
  mega.board.stall(false);
  fail_unless(film.wait_for(GST_MESSAGE_ELEMENT, "tactor-device-found"));
  fail_unless(film.wait_for(GST_MESSAGE_EOS));
  film.stop();
  fail_if(mega.firmware->any_motor_on());
}

CHECK_TEST(test_boards_that_cannot_be_used)
{
  {
    Mega mega;
    mega.board.use_by_another(true);
    MapStream film(1);
    film.play();
    fail_if(film.wait_for(GST_MESSAGE_EOS));
    fail_unless(film.errors.at(0).find("another program") != std::string::npos);
  }
  {
    EmulatedUsb usb;
    EmulatedBoard silent(usb, {});
    MapStream film(1);
    film.play();
    fail_if(film.wait_for(GST_MESSAGE_EOS));
  }
}

/// Starting does not block on the board, and can be canceled before the board answers.
CHECK_TEST(test_stopped_while_the_board_is_silent)
{
  EmulatedUsb usb;
  EmulatedBoard silent(usb, {});
  MapStream film(1);
  film.play();
  fail_unless(silent.wait_for_bytes(1)); // the query was sent
  fail_unless(film.is_quiet());          // play() did not wait
  film.stop();
  fail_unless_equals_int(silent.transfers_pending(), 0);
}

/// A board that is refused after it was opened is released like one that played.
CHECK_TEST(test_refused_with_an_open_board)
{
  for (const Transport transport : kTransports) {
    Mega mega(transport);
    MapStream film(1, "trace-location=/nowhere/trace.csv");
    film.play();
    fail_if(film.wait_for(GST_MESSAGE_EOS));
    fail_unless(film.errors.at(0).find("/nowhere/trace.csv") != std::string::npos);
    film.stop();
    const Bytes told = mega.board.bytes();
    fail_unless(told.size() > 2 && told[told.size() - 2] == 0xff && told.back() == 0xf9);
    fail_unless(mega.board.conversation().back() == "return 0");
    fail_unless_equals_int(mega.board.cut_off(), 0);
  }
}

CHECK_MAIN_AFTER(tactorsink_usb, -1, begin_emulation())
