// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Board models for tests: what StandardFirmata 2.5 does with bytes. Written from its sketch
// (StandardFirmata.ino, Firmata.cpp, Boards.h), without any code of lib/tactor. With `seat` it is
// our sketch: the same with a watchdog.
#pragma once

#include "nanoseconds.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

struct Layout
{
  const char *name;
  int pins;
  int first_digital;
  int first_analog;
  std::set<int> pwm;
  std::set<int> i2c;
  int pwm_bits = 8;
};

inline const Layout kMega{ .name = "Arduino Mega 2560",
                           .pins = 70,
                           .first_digital = 2,
                           .first_analog = 54,
                           .pwm = { 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46 },
                           .i2c = { 20, 21 } };
inline const Layout kUno{ .name = "Arduino Uno",
                          .pins = 20,
                          .first_digital = 2,
                          .first_analog = 14,
                          .pwm = { 3, 5, 6, 9, 10, 11 },
                          .i2c = { 18, 19 } };

class FirmataModel
{
public:
  using Time = visuotactile::Time;
  static constexpr Time kWatchdog = std::chrono::milliseconds(250);

  explicit FirmataModel(const Layout &layout, bool seat = false, Time boot = Time(0))
      : layout_(layout), seat_(seat), boot_(boot)
  {
  }

  /// Power-up or DTR falling: no pin is driven, and the board sends its banner after the boot
  /// loader.
  void restart(Time now);
  void power_off();
  /// When it next acts by itself.
  std::optional<Time> next() const;
  void pass(Time now);

  void receive(std::uint8_t byte, Time now);

  bool is_silent() const;

  bool is_running = false;
  std::string firmware = "StandardFirmata.ino";
  std::map<int, int> duty; ///< compare register of each pin written
  std::map<int, int> mode;
  std::vector<std::uint8_t> received;
  std::deque<std::uint8_t> replies;
  int resets = 0;
  int keepalives = 0;
  int trips = 0; ///< of the watchdog, with a motor on

private:
  void write(int pin, int value);
  void say(const std::vector<int> &bytes);
  void say_firmware();
  void sysex(std::span<const std::uint8_t> data);

  Layout layout_;
  bool seat_;
  Time boot_;
  std::optional<Time> boots_;
  std::vector<std::uint8_t> parsed_;
  bool armed_ = false;
  bool tripped_ = false;
  Time last_byte_{ 0 };
};
