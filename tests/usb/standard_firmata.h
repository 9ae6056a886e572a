// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace usb_test {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

/// What runs on a board.
class Firmware
{
public:
  virtual ~Firmware() = default;
  /// The board was reset; what it says.
  virtual Bytes reset() = 0;
  /// A byte came at a time; the answer.
  virtual Bytes receive(std::uint8_t byte, Clock::time_point time) = 0;
};

/// A board with the stock sketch StandardFirmata 2.5, written after the protocol (github.com/firmata/protocol) and what the sketch was seen to do
/// (design/hardware.md, "Firmata bytes").
class StandardFirmata : public Firmware
{
public:
  struct Pins
  {
    int count = 0;
    int first_analog = 0;
    std::set<int> pwm{};
    std::set<int> i2c{};
  };
  static Pins mega();
  static Pins uno();

  explicit StandardFirmata(Pins pins, std::string name = "StandardFirmata.ino");

  Bytes reset() override;
  Bytes receive(std::uint8_t byte, Clock::time_point time) override;

  struct Change
  {
    Clock::time_point time;
    int pin = 0;
    int duty = 0; ///< of 255
  };

  int duty(int pin) const; ///< of 255; what the compare register holds
  int mode(int pin) const;
  const std::vector<Change> &changes() const;
  int resets() const; ///< by FF

private:
  static constexpr int kOutput = 1;
  static constexpr int kAnalog = 2;
  static constexpr int kPwm = 3;

  struct Pin
  {
    int mode = kOutput;
    int value = 0; ///< as it was sent
    int duty = 0;
  };

  Bytes message(Clock::time_point time);
  Bytes sysex(std::span<const std::uint8_t> body, Clock::time_point time);
  Bytes capabilities() const;
  Bytes analog_mapping() const;
  Bytes firmware() const;
  void set_mode(int pin, int mode, Clock::time_point time);
  void write(int pin, int value, Clock::time_point time);
  void rest(Clock::time_point time);
  bool has_pin(int pin) const;

  const Pins layout_;
  const std::string name_;
  std::vector<Pin> pins_;
  std::vector<Change> changes_;
  Bytes message_; ///< begun
  int resets_ = 0;
};

} // namespace usb_test
