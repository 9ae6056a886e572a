// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Board models for tests: what StandardFirmata 2.5 does with bytes. Written from its sketch
// (StandardFirmata.ino, Firmata.cpp, Boards.h), without any code of lib/tactor. With `seat` it is
// our sketch: the same with a watchdog.
#pragma once

#include "nanoseconds.h"

#include <algorithm>
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
  void restart(Time now)
  {
    duty.clear();
    mode.clear();
    parsed_.clear();
    armed_ = false;
    boots_ = now + boot_;
    pass(now);
  }
  void power_off()
  {
    restart(Time(0));
    boots_.reset();
    is_running = false;
    replies.clear();
  }
  /// When it next acts by itself.
  std::optional<Time> next() const
  {
    if (boots_)
      return boots_;
    return armed_ ? std::optional(last_byte_ + kWatchdog) : std::nullopt;
  }
  void pass(Time now)
  {
    if (boots_ && now >= *boots_) {
      boots_.reset();
      is_running = true;
      say({ 0xf9, 2, 5 });
      say_firmware();
    }
    if (armed_ && now >= last_byte_ + kWatchdog) {
      trips += std::ranges::any_of(duty, [](const auto &pin) { return pin.second != 0; });
      for (auto &pin : duty)
        pin.second = 0;
      armed_ = false; // until the next byte
      tripped_ = true;
    }
  }

  void receive(std::uint8_t byte, Time now)
  {
    pass(now);
    if (boots_ || !is_running)
      return;
    received.push_back(byte);
    last_byte_ = now;
    if (tripped_)
      armed_ = true;
    tripped_ = false;
    if (byte == 0xff) {
      parsed_.clear();
      duty.clear();
      mode.clear();
      resets++;
      return;
    }
    // As in Firmata.cpp: in a sysex all bytes up to F7 are data, elsewhere a status byte begins a
    // message.
    if (parsed_.empty() || parsed_[0] != 0xf0) {
      if (byte >= 0x80)
        parsed_.clear();
      else if (parsed_.empty())
        return;
    }
    parsed_.push_back(byte);
    const std::uint8_t status = parsed_[0];
    if (status == 0xf0) {
      if (byte == 0xf7) {
        sysex(std::span(parsed_).subspan(1, parsed_.size() - 2));
        parsed_.clear();
      }
    } else if (status == 0xf9) {
      say({ 0xf9, 2, 5 });
      parsed_.clear();
    } else if (parsed_.size() == 3) {
      if (status == 0xf4) {
        mode[parsed_[1]] = parsed_[2];
        if (parsed_[2] == 3)
          write(parsed_[1], 0);
      } else if ((status & 0xf0) == 0xe0) {
        write(status & 0x0f, parsed_[1] | parsed_[2] << 7);
      }
      parsed_.clear();
    }
  }

  bool is_silent() const
  {
    return std::ranges::all_of(duty, [](const auto &pin) { return pin.second == 0; });
  }

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
  void write(int pin, int value)
  {
    // analogWrite() ignores pins that are not in PWM mode. The register keeps only its own bits.
    if (pin < layout_.pins && mode.contains(pin) && mode[pin] == 3 && layout_.pwm.contains(pin))
      duty[pin] = value & ((1 << layout_.pwm_bits) - 1);
  }
  void say(const std::vector<int> &bytes)
  {
    for (const int byte : bytes)
      replies.push_back(static_cast<std::uint8_t>(byte));
  }
  void say_firmware()
  {
    say({ 0xf0, 0x79, 2, 5 });
    for (const char c : seat_ ? std::string("visuotactile-seat.ino") : firmware)
      say({ c & 0x7f, (c >> 7) & 1 });
    say({ 0xf7 });
  }
  void sysex(std::span<const std::uint8_t> data)
  {
    if (data.empty())
      return;
    switch (data[0]) {
    case 0x79:
      say_firmware();
      break;
    case 0x6b:
      say({ 0xf0, 0x6c });
      for (int pin = 0; pin < layout_.pins; pin++) {
        const bool digital = pin >= layout_.first_digital;
        if (digital)
          say({ 0, 1, 11, 1, 1, 1 });
        if (pin >= layout_.first_analog)
          say({ 2, 10 });
        if (layout_.pwm.contains(pin))
          say({ 3, layout_.pwm_bits });
        if (digital)
          say({ 4, 14 });
        if (layout_.i2c.contains(pin))
          say({ 6, 1 });
        say({ 0x7f });
      }
      say({ 0xf7 });
      break;
    case 0x6f:
      if (data.size() > 2) {
        int value = data[2];
        for (std::size_t i = 3; i < std::min<std::size_t>(data.size(), 5); i++)
          value |= data[i] << 7 * (i - 2);
        write(data[1], value);
      }
      break;
    case 0x01:
      keepalives++;
      armed_ = seat_;
      break;
    default:
      break;
    }
  }

  Layout layout_;
  bool seat_;
  Time boot_;
  std::optional<Time> boots_;
  std::vector<std::uint8_t> parsed_;
  bool armed_ = false;
  bool tripped_ = false;
  Time last_byte_{ 0 };
};
