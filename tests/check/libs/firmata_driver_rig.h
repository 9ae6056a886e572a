// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A driver of real boards with boards in memory. Time-outs are an hour where they must not expire
// and milliseconds where they must: nothing here depends on wall time.
#pragma once

#include "support/boards/memory_bus.h"
#include "tactor/drivers/firmata_driver.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/contains.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"

using namespace std::chrono_literals;
using namespace tactor;
using Firmware = FirmataDriver::Firmware;
using Kind = DriverError::Kind;
using EventKind = DriverEvent::Kind;

inline constexpr FirmataPatience kEndless{
  .answer = 1h, .ask_again = 1h, .transfer = 1h, .host_silence = 1h, .keepalive = 1h, .drain = 1h
};

inline SerialDevice
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
class DriverRig
{
public:
  explicit DriverRig(Firmware firmware = Firmware::any, FirmataPatience patience = kEndless,
                     Time look_again = 1h, StopPatience stop_patience = {}, Time busy = 0s)
      : driver(firmware, [this] { return std::make_unique<MemoryBus>(sockets); },
               { .patience = patience,
                 .stop_patience = stop_patience,
                 .look_again = look_again,
                 .busy = busy,
                 .known_boards = folder.file("boards") })
  {
    for (const MemoryBoard *board : { &mega, &uno, &seat })
      known.add(board->device);
  }

  void open(int min_tactors = 1, const std::string &name = "")
  {
    unwrap(driver.open(config(min_tactors, name)));
  }
  DriverConfig config(int min_tactors = 1, const std::string &name = "")
  {
    return { .device = name,
             .min_tactors = min_tactors,
             .full_scale_volts = 3.0,
             .stop = stop.get_token(),
             .notify = [this](const DriverEvent &event) {
               std::lock_guard lock(sockets.mutex);
               events.push_back(event);
               sockets.changed.notify_all();
             } };
  }
  DriverError refusal(int min_tactors = 1, const std::string &name = "")
  {
    DriverError error = refusal_of(driver.open(config(min_tactors, name)));
    fail_unless(driver.tactors() == 0);
    fail_unless(error.text.find('\n') == std::string::npos);
    return error;
  }
  void write(const std::vector<double> &volts)
  {
    unwrap(driver.write(volts, 0s));
  }
  /// Waits until the board has these voltages as 8-bit duties, and zero on all other pins.
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

  const TemporaryFolder folder;
  KnownBoards known{ folder.file("boards") };
  std::stop_source stop; ///< of the next open()
  Sockets sockets;
  MemoryBoard mega{ device("7573", "1-2"), kMega };
  MemoryBoard uno{ device("95", "1-3", "Arduino Uno"), kUno };
  MemoryBoard seat{ device("S1", "2-1", "Seat"), kMega, true };
  std::vector<DriverEvent> events;
  FirmataDriver driver;
};
