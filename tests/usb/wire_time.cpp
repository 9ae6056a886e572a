// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Latency on emulated Megas at 57600 baud: from a command's due time to its last byte on the wire,
// and from each end of a play until motors are off.
//
// Usage: umockdev-wrapper wire_time [seconds of film, default 10] [ends of each kind, default 10]
#include "launch.h"
#include "map_stream.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>

using namespace usb_test;

namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

double
percentile(std::vector<double> values, double p)
{
  std::sort(values.begin(), values.end());
  return values.empty() ? NAN : values[static_cast<std::size_t>(p * (values.size() - 1))];
}

struct Chair
{
  explicit Chair(Transport transport = Transport::cdc_acm, bool seat = false)
      : firmware(std::make_shared<Firmware>(kMega, seat)),
        board(usb, { .transport = transport, .baud = 57600 }, firmware)
  {
  }

  void wait_for_motors(bool on)
  {
    if (!board.wait_until([&] { return firmware->any_motor_on() == on; }))
      throw std::runtime_error(on ? "the motors do not begin" : "the motors do not end");
  }

  EmulatedUsb usb;
  std::shared_ptr<Firmware> firmware;
  EmulatedBoard board;
};

/// Lateness of the last byte of each command that changed a pin, in ms.
std::vector<double>
lateness(Chair &chair, int seconds)
{
  MapStream film(seconds * 5);
  film.play();
  film.wait_for(GST_MESSAGE_EOS);
  const Clock::time_point start = film.start();
  film.stop();

  std::map<int, std::deque<Firmware::Change>> changes;
  for (const Firmware::Change &change : chair.firmware->changes())
    changes[change.pin].push_back(change);
  std::vector<double> late;
  for (const tactor::IssuedCommand &line : film.trace()) {
    auto &pin = changes[2 + line.command.tactor];
    if (pin.empty() || pin.front().duty != std::lround(line.command.volts / 3.0 * 255))
      continue; // superseded, or no change
    late.push_back(Milliseconds(pin.front().time - (start + line.command.due())).count());
    pin.pop_front();
  }
  return late;
}

/// Time from the end of a play until motors are off, in ms.
template <class Play>
double
time_to_zero(const std::function<void(Chair &, Play &)> &end, bool seat = false)
{
  Chair chair(Transport::cdc_acm, seat);
  Clock::time_point begin;
  if constexpr (std::is_same_v<Play, MapStream>) {
    MapStream film(100);
    film.play();
    chair.wait_for_motors(true);
    begin = Clock::now();
    end(chair, film);
    chair.wait_for_motors(false);
  } else {
    Launch launch;
    chair.wait_for_motors(true);
    begin = Clock::now();
    end(chair, launch);
    chair.wait_for_motors(false);
  }
  return Milliseconds(chair.firmware->changes().back().time - begin).count();
}

/// Time from the end of the last frame until motors are off, in ms.
double
time_to_zero_at_end()
{
  constexpr int kBlocks = 5; // of 200 ms, with motors on in the last one
  Chair chair;
  MapStream film(kBlocks);
  film.play();
  film.wait_for(GST_MESSAGE_EOS);
  chair.wait_for_motors(false); // the zeros may still be on the line
  const Clock::time_point end
      = film.start() + std::chrono::duration_cast<Clock::duration>(Milliseconds(kBlocks * 200));
  return Milliseconds(chair.firmware->changes().back().time - end).count();
}

} // namespace

int
main(int argc, char **argv)
{
  std::signal(SIGHUP, SIG_IGN); // see usb_serial_bus.cpp
  // umockdev warns when a host dies during a request.
  g_log_set_default_handler([](const gchar *, GLogLevelFlags, const gchar *, gpointer) {}, nullptr);
  gst_init(nullptr, nullptr);
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 10;
  const int times = argc > 2 ? std::atoi(argv[2]) : 10;

  std::printf("due to last byte on the wire  commands   p50 ms   p99 ms   max ms\n");
  for (const Transport transport : kTransports) {
    const char *const names[] = { "cdc-acm", "ftdi", "ch340" };
    Chair chair(transport);
    const std::vector<double> late = lateness(chair, seconds);
    std::printf("%-28s  %8zu  %7.2f  %7.2f  %7.2f\n", names[static_cast<int>(transport)],
                late.size(), percentile(late, 0.5), percentile(late, 0.99), percentile(late, 1.0));
  }

  const std::pair<const char *, std::function<double()>> ends[] = {
    { "end of stream", time_to_zero_at_end },
    { "pause",
      [] {
        return time_to_zero<MapStream>([](Chair &, MapStream &film) { film.pause(); });
      } },
    { "flush (seek)",
      [] {
        return time_to_zero<MapStream>([](Chair &, MapStream &film) { film.flush(); });
      } },
    { "stop",
      [] {
        return time_to_zero<MapStream>([](Chair &, MapStream &film) { film.stop(); });
      } },
    { "Ctrl-C in gst-launch-1.0",
      [] {
        return time_to_zero<Launch>([](Chair &, Launch &launch) { launch.end(SIGINT); });
      } },
    { "killed, watchdog",
      [] {
        return time_to_zero<Launch>([](Chair &, Launch &launch) { launch.end(SIGKILL); }, true);
      } },
    { "unplugged, watchdog",
      [] {
        return time_to_zero<MapStream>([](Chair &chair, MapStream &) { chair.board.unplug(); },
                                       true);
      } },
  };
  std::printf("end of play to motors at zero    times   p50 ms            max ms\n");
  for (const auto &[name, end] : ends) {
    std::vector<double> zero;
    for (int i = 0; i < times; i++)
      zero.push_back(end());
    std::printf("%-28s  %8d  %7.2f           %7.2f\n", name, times, percentile(zero, 0.5),
                percentile(zero, 1.0));
  }
}
