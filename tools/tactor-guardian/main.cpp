// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Stops a board's motors when the process is gone that plays on it. tactorsink runs it with one end
// of a socket as its standard input: a byte means that the motors were stopped. It is no program
// for users.
#include "tactor/drivers/board_choice.h"
#include "tactor/drivers/stop_board.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <syslog.h>
#include <thread>
#include <unistd.h>

using namespace std::chrono_literals;

namespace {

/// How long a board is tried to be stopped that takes nothing or is unplugged.
constexpr auto kPatience = 10s;
constexpr auto kTryAgain = 50ms;
/// The kernel takes the board from a player that has just ended. Later on, another player has it,
/// which began with a reset.
constexpr auto kBusy = 1s;

/// The board at a bus path; none if there is none.
std::optional<tactor::SerialDevice>
find(tactor::SerialBus &bus, const std::string &bus_path)
{
  const auto devices = bus.list();
  if (!devices)
    return std::nullopt;
  const auto found = std::ranges::find(*devices, bus_path, &tactor::SerialDevice::bus_path);
  return found == devices->end() ? std::nullopt : std::optional(*found);
}

/// Waits for the player's end. Whether the motors may be on.
bool
is_left_on()
{
  char byte = 0;
  ssize_t got = 0;
  while ((got = read(STDIN_FILENO, &byte, 1)) < 0 && errno == EINTR) {
  }
  return got != 1;
}

/// 1 if the motors may still be on.
int
stop(tactor::SerialBus &bus, const tactor::SerialDevice &device)
{
  using Kind = tactor::DriverError::Kind;
  const auto begin = std::chrono::steady_clock::now();
  const tactor::DriverError unplugged{ Kind::not_found,
                                       tactor::describe(device) + " was unplugged" };
  tactor::DriverError why;
  bool may_pulse = true; // once: it boots for seconds
  for (auto now = begin; now < begin + kPatience; now = std::chrono::steady_clock::now()) {
    if (find(bus, device.bus_path) == device) { // another board may be there now
      const auto stopped = tactor::stop_board(bus, device, &may_pulse);
      if (stopped || (stopped.error().kind == Kind::busy && now > begin + kBusy))
        return 0;
      why = stopped.error();
    } else {
      why = unplugged;
    }
    std::this_thread::sleep_for(kTryAgain);
  }
  openlog("tactor-guardian", LOG_PID | LOG_PERROR, LOG_USER);
  syslog(LOG_ERR,
         "the player has ended without stopping its tactor board, which cannot be stopped: %s",
         tactor::advice_after(why).c_str());
  return 1;
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc != 2 || isatty(STDIN_FILENO) != 0) {
    std::fputs("tactor-guardian: expected to be run by tactorsink, with a bus path\n", stderr);
    return 2;
  }
  // What ends the player may be sent to all its processes, and there is nothing to do before it has
  // ended.
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, nullptr);
  static_cast<void>(!chdir("/"));
  const auto bus = tactor::make_serial_bus();
  if (!bus)
    return 1;
  const std::optional<tactor::SerialDevice> device = find(**bus, argv[1]);
  return is_left_on() && device ? stop(**bus, *device) : 0;
}
