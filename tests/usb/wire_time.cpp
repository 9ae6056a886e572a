// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How long after its due time is a command's last byte on the wire to the board? A film of some seconds on an emulated Mega at 57600 baud, over each
// transport. Usage: umockdev-wrapper wire_time [seconds, default 10]
#include "film.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>

using namespace usb_test;

int
main(int argc, char **argv)
{
  std::signal(SIGHUP, SIG_IGN); // see usb_serial_bus.cpp
  gst_init(nullptr, nullptr);
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 10;
  std::printf(
      "transport  commands  at board  late p50 ms  p99 ms  max ms  time to zero when stopped ms\n");
  for (const Transport transport : kTransports) {
    const char *const names[] = { "cdc-acm", "ftdi", "ch340" };
    EmulatedUsb usb;
    const auto firmware = std::make_shared<Firmware>();
    EmulatedBoard board(usb, { .transport = transport, .baud = 57600 }, firmware);
    Film film(seconds * 5);
    film.play();
    film.wait_for(GST_MESSAGE_EOS);
    const Clock::time_point start = film.start();
    film.stop();

    std::map<int, std::deque<Firmware::Change>> changes;
    for (const Firmware::Change &change : firmware->changes())
      changes[change.pin].push_back(change);
    std::vector<double> late;
    const std::vector<tactor::IssuedCommand> trace = film.trace();
    for (const tactor::IssuedCommand &line : trace) {
      auto &pin = changes[2 + line.command.tactor];
      if (pin.empty() || pin.front().duty != std::lround(line.command.volts / 3.0 * 255))
        continue; // overtaken by the tactor's next one, or no change
      late.push_back(
          std::chrono::duration<double, std::milli>(pin.front().time - (start + line.command.due()))
              .count());
      pin.pop_front();
    }
    std::sort(late.begin(), late.end());

    // Another film, stopped while motors are on.
    Film stopped(50);
    stopped.play();
    board.wait_until([&] { return firmware->duty(2) + firmware->duty(3) + firmware->duty(4) > 0; });
    const Clock::time_point stop = Clock::now();
    stopped.stop();
    const double zero
        = std::chrono::duration<double, std::milli>(firmware->changes().back().time - stop).count();
    const auto percentile = [&](double p) {
      return late.empty() ? NAN : late[static_cast<std::size_t>(p * (late.size() - 1))];
    };
    std::printf("%-9s  %8zu  %8zu  %11.2f  %6.2f  %6.2f  %.2f\n",
                names[static_cast<int>(transport)], trace.size(), late.size(), percentile(0.5),
                percentile(0.99), percentile(1.0), zero);
  }
}
