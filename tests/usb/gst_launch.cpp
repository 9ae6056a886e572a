// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The state of a chair after gst-launch-1.0, which knows nothing of chairs, was terminated.
#include "chair.h"
#include "launch.h"
#include "map_stream.h"

#include <algorithm>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace usb_test;

namespace {

const std::vector<std::string> kAlone{ "driver=firmata", "guardian=false" };

} // namespace

/// Ctrl-C, with and without EOS first, over every transport: zeros, then a reset.
CHECK_TEST(test_interrupted)
{
  for (const Transport transport : kTransports)
    for (const bool seat : { false, true })
      for (const bool eos : { false, true }) {
        Chair chair(seat, transport);
        Launch launch(eos ? std::vector<std::string>{ "-e" } : std::vector<std::string>{});
        fail_unless(chair.wait_for_motors());
        const int status = launch.end(SIGINT);
        fail_unless(WIFEXITED(status));
        fail_if(chair.firmware->any_motor_on());
        fail_unless(chair.was_told_to_stand());
        fail_unless(chair.wait_for_hosts_end());
      }
}

/// SIGTERM, for which gst-launch-1.0 has no handler: the same. The kernel's driver gets the board
/// back, and the process ends by the signal.
CHECK_TEST(test_terminated)
{
  for (const Transport transport : kTransports) {
    Chair chair(false, transport);
    Launch launch;
    fail_unless(chair.wait_for_motors());
    const int status = launch.end(SIGTERM);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    fail_if(chair.firmware->any_motor_on());
    fail_unless(chair.was_told_to_stand());
    fail_unless(chair.wait_for_hosts_end());
    fail_unless(chair.board.conversation().back() == "return 0");
  }
}

/// SIGTERM while a silent board is being identified: motors off, and the kernel's driver gets the
/// board back.
CHECK_TEST(test_terminated_while_opening)
{
  for (const Transport transport : kTransports) {
    Chair chair(false, transport);
    bool is_asked = false;
    chair.board.garble([&](Bytes &reply) {
      constexpr std::uint8_t kCapabilities = 0x6c;
      if (reply.size() > 1 && reply[1] == kCapabilities) {
        is_asked = true;
        reply.clear();
      }
    });
    Launch launch;
    fail_unless(chair.board.wait_until([&] { return is_asked; }));
    const int status = launch.end(SIGTERM);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    fail_unless(chair.wait_for_hosts_end());
    fail_unless(chair.board.conversation().back() == "return 0");
    fail_unless_equals_int(chair.board.cut_off(), 0);
    fail_unless(chair.was_told_to_stand());
  }
}

/// After SIGKILL without a guardian nothing is sent. With StandardFirmata the motors stay on until
/// the next play, which begins with a reset.
CHECK_TEST(test_killed)
{
  Chair chair;
  Launch launch({}, kAlone);
  fail_unless(chair.wait_for_motors());
  fail_unless(WIFSIGNALED(launch.end(SIGKILL)));
  fail_unless(chair.wait_for_hosts_end());
  chair.board.with_firmware([&] {
    for (const int pin : Chair::kPins)
      fail_unless_equals_int(chair.firmware->duty(pin), Chair::kDuty);
    fail_if(chair.firmware->next()); // no watchdog is armed
  });

  const std::size_t before = chair.board.bytes().size();
  MapStream film(1);
  film.play();
  fail_unless(chair.board.wait_until([&] { return !chair.firmware->any_motor_on(); }));
  fail_unless(film.wait_for(GST_MESSAGE_EOS));
  const Bytes bytes = chair.board.bytes();
  const auto first_level
      = std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(before), bytes.end(),
                     [](std::uint8_t byte) { return (byte & 0xf0) == 0xe0; });
  fail_unless(std::find(bytes.begin() + static_cast<std::ptrdiff_t>(before), first_level, 0xff)
              != first_level);
}

/// --release-boards after SIGKILL: motors off, and the kernel's driver gets the board back. A board
/// that was not left open is not touched.
CHECK_TEST(test_killed_and_released)
{
  const std::string program = g_getenv("VISUOTACTILE_PLAY") ? g_getenv("VISUOTACTILE_PLAY") : "";
  if (program.empty())
    return; // the program was not built
  const auto release = [&] {
    g_autofree gchar *said = nullptr;
    const std::string command = program + " --release-boards";
    int status = -1;
    fail_unless(g_spawn_command_line_sync(command.c_str(), &said, nullptr, &status, nullptr));
    fail_unless(status == 0);
    return std::string(said);
  };
  for (const Transport transport : kTransports) {
    Chair chair(false, transport);
    Launch launch({}, kAlone);
    fail_unless(chair.wait_for_motors());
    fail_unless(WIFSIGNALED(launch.end(SIGKILL)));
    fail_unless(chair.wait_for_hosts_end());
    fail_unless(chair.board.conversation().back() != "return 0");
    const std::string said = release();
    fail_unless(said.find("Mega 2560 (serial 75833353035351F0C0A1, at 1-1): motors stopped")
                    != std::string::npos,
                "%s", said.c_str());
    fail_if(chair.firmware->any_motor_on());
    fail_unless(chair.board.conversation().back() == "return 0");

    const std::size_t before = chair.board.conversation().size();
    fail_unless(release() == "No board was left by a player that was killed.\n");
    fail_unless(chair.board.conversation().size() == before);
  }
}

/// The seat sketch's watchdog turns motors off 250 ms after the last byte.
CHECK_TEST(test_killed_with_watchdog)
{
  for (const Transport transport : kTransports) {
    Chair chair(true, transport);
    Launch launch({}, { "driver=seat" });
    fail_unless(chair.wait_for_motors());
    fail_unless(WIFSIGNALED(launch.end(SIGKILL)));
    fail_unless(chair.wait_for_hosts_end());
    fail_unless(chair.board.wait_until([&] { return !chair.firmware->any_motor_on(); }));
    fail_unless(chair.firmware->changes().back().time
                == chair.board.received().back().time + 250ms);
    fail_unless(chair.firmware->keepalives() > 0);
  }
}

CHECK_MAIN_AFTER(gst_launch, -1, begin_emulation())
