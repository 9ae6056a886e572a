// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Boards without a watchdog whose player ends in a way that it cannot guard against, and boards
// that do not take their zeros.
#include "chair.h"
#include "launch.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/contains.h"
#include "support/temporary_file.h"

using namespace usb_test;

namespace {

constexpr const char *kMayBeOn = "its motors may still be on: switch their supply off";

} // namespace

/// The guardian stops the motors, and the kernel's driver gets the board back.
CHECK_TEST(test_killed)
{
  for (const Transport transport : kTransports)
    for (const int signal : { SIGKILL, SIGSEGV }) {
      if (signal == SIGSEGV && transport != Transport::cdc_acm)
        continue;
      Chair chair(false, transport);
      BarePlayer player; // gst-launch-1.0 catches SIGSEGV and spins
      fail_unless(chair.wait_for_motors());
      const int status = player.end(signal);
      fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == signal);
      fail_unless(chair.wait_for_zero());
      fail_unless(chair.wait_for_return());
      fail_unless(chair.was_told_to_stand());
    }
}

/// gst-launch-1.0 -e drops its handler at the first Ctrl-C, and plays what is queued.
CHECK_TEST(test_interrupted_twice)
{
  for (const int second : { SIGINT, SIGTERM, SIGHUP }) {
    Chair chair;
    Launch launch({ "-e" });
    fail_unless(chair.wait_for_motors());
    launch.send(SIGINT);
    launch.end(second);
    fail_unless(chair.wait_for_zero());
    fail_unless(chair.wait_for_return());
  }
}

/// A player that stops the motors itself has no guardian any more: the board is not touched again.
CHECK_TEST(test_ended)
{
  Chair chair;
  Launch launch;
  fail_unless(chair.wait_for_motors());
  launch.end(SIGTERM);
  fail_unless(chair.wait_for_return());
  const std::size_t before = chair.board.conversation().size();
  {
    Launch next;
    fail_unless(chair.wait_for_motors());
    next.end(SIGTERM);
    fail_unless(chair.wait_for_return());
  }
  const std::vector<std::string> said = chair.board.conversation();
  // The next play alone has opened it meanwhile.
  fail_unless_equals_int(
      std::ranges::count(said.begin() + static_cast<std::ptrdiff_t>(before), said.end(), "claim 0"),
      1);
}

/// A board that takes nothing: the player says so when it ends, and the guardian goes on trying.
/// DTR resets a board that is known to be reset by it.
CHECK_TEST(test_takes_nothing)
{
  for (const bool has_guardian : { true, false }) {
    Chair chair;
    Launch launch({}, { "driver=firmata", has_guardian ? "guardian=true" : "guardian=false" });
    fail_unless(chair.wait_for_motors());
    chair.board.stall(true);
    const int status = launch.end(SIGTERM);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    assert_contains(launch.errors(), { kMayBeOn });
    fail_if(chair.any_motor_on()); // by DTR
    chair.board.stall(false);
    const int resets = has_guardian ? 2 : 1; // the first when it was opened
    fail_unless(chair.board.wait_until([&] { return chair.firmware->resets() >= resets; }));
    fail_unless(chair.wait_for_return());
  }
}

/// The guardian's words, which go to the system's log, and to its standard error where it has one:
/// the player may have ended in any way, and the board may have been unplugged.
CHECK_TEST(test_guardians_words)
{
  Chair chair;
  Program guardian({ g_getenv("VISUOTACTILE_GUARDIAN"), "1-1" });
  chair.board.garble([](Bytes &reply) { reply.clear(); });
  guardian.leave();
  fail_unless(chair.board.wait_until([&] { return chair.firmware->resets() > 0; }));
  chair.board.unplug();
  const int status = guardian.wait();
  fail_unless(WIFEXITED(status) && WEXITSTATUS(status) == 1);
  assert_contains(guardian.errors(), { "the player has ended without stopping its tactor board",
                                       "was unplugged; if it has a supply of its own" });
}

/// The same without a line for resets: the guardian's zeros come when the board takes them.
CHECK_TEST(test_takes_nothing_for_a_while)
{
  Chair chair;
  Launch launch;
  fail_unless(chair.wait_for_motors());
  chair.board.ignore_dtr(true);
  chair.board.stall(true);
  launch.end(SIGTERM);
  assert_contains(launch.errors(), { kMayBeOn });
  fail_unless(chair.any_motor_on());
  chair.board.stall(false);
  fail_unless(chair.wait_for_zero());
  fail_unless(chair.wait_for_return());
}

/// Transfers that fail once, each time for another reason: the zeros are sent again, and nothing
/// has to be said.
CHECK_TEST(test_fails_once)
{
  for (const int error : { EPROTO, EPIPE, ESHUTDOWN }) {
    Chair chair;
    Launch launch({}, { "driver=firmata", "guardian=false" });
    fail_unless(chair.wait_for_motors());
    chair.board.fail_next_write(error);
    const int status = launch.end(SIGTERM);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    fail_if(chair.any_motor_on(), "errno %d", error);
    assert_text(launch.errors(), "");
  }
}

/// An answer to the zeros that is lost: they are sent again.
CHECK_TEST(test_unanswered_once)
{
  Chair chair;
  bool is_asked = false;
  Launch launch({}, { "driver=firmata", "guardian=false" });
  fail_unless(chair.wait_for_motors());
  chair.board.garble([&](Bytes &reply) {
    if (!std::exchange(is_asked, true))
      reply.clear();
  });
  launch.end(SIGTERM);
  fail_unless(is_asked);
  fail_if(chair.any_motor_on());
  assert_text(launch.errors(), "");
}

/// visuotactile-play ends with another status if motors may still be on.
CHECK_TEST(test_status)
{
  const char *play = g_getenv("VISUOTACTILE_PLAY");
  if (!play)
    return; // the program was not built
  for (const auto &[act, stalls] :
       { std::pair{ "--feel-test", false }, std::pair{ "--feel-test", true },
         std::pair{ "--no-window", true } }) {
    Chair chair;
    Program program({ play, act, "--driver=firmata", "--quiet" });
    fail_unless(chair.board.wait_until([&] { return chair.firmware->any_motor_on(); }));
    chair.board.ignore_dtr(true);
    chair.board.stall(stalls);
    if (act == std::string("--no-window"))
      program.send(SIGTERM); // a film would go on
    const int status = program.wait();
    fail_unless(WIFEXITED(status));
    fail_unless_equals_int(WEXITSTATUS(status), stalls ? 1 : 0);
    fail_unless((program.errors().find(kMayBeOn) != std::string::npos) == stalls);
    chair.board.stall(false);
    fail_unless(chair.wait_for_zero());
    fail_unless(chair.wait_for_return());
  }
}

/// As a closed terminal does: SIGHUP by the shell, then by the kernel.
CHECK_TEST(test_player_is_hung_up_twice)
{
  const char *play = g_getenv("VISUOTACTILE_PLAY");
  if (!play)
    return; // the program was not built
  const TemporaryFolder folder;
  for (const bool is_film : { true, false }) {
    Chair chair;
    Program program({ play, "--driver=firmata", "--quiet", is_film ? "--no-window" : "--feel-test",
                      "--output=" + folder.path });
    fail_unless(chair.board.wait_until([&] { return chair.firmware->any_motor_on(); }));
    program.send(SIGHUP);
    program.send(SIGHUP);
    const int status = program.wait();
    fail_unless(is_film ? WIFEXITED(status) && WEXITSTATUS(status) == 0
                        : WTERMSIG(status) == SIGHUP);
    fail_if(chair.any_motor_on());
    fail_unless(chair.wait_for_return());
  }
}

CHECK_MAIN_AFTER(killed, -1, begin_emulation())
