// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The Firmata protocol, version 2.5 (github.com/firmata/protocol): encoding and decoding, without
/// timing.
namespace tactor::firmata {

/// Pin numbers have 7 bits.
inline constexpr int kMaxPins = 128;
/// Mode of a pin with pulse-width modulation, as motors need.
inline constexpr std::uint8_t kPwm = 3;
/// Prefix of the name of firmware with a watchdog: 250 ms without a byte from the host turn all
/// motors off.
inline constexpr std::string_view kSeatFirmware = "visuotactile-seat";

/// Appends messages to a board. Pins are 0…127, other values are cut to their field.
class Encoder
{
public:
  /// Most bytes that one set_mode() or set_value() adds.
  static constexpr std::size_t kLongest = 7;

  Encoder &ask_version();      ///< `F9`
  Encoder &ask_firmware();     ///< `F0 79 F7`
  Encoder &ask_capabilities(); ///< `F0 6B F7`
  Encoder &set_mode(int pin, std::uint8_t mode);
  /// Duty cycle of a pin: an analog message if pin (below 16) and value (14 bits) fit, else an
  /// extended one (21 bits).
  Encoder &set_value(int pin, unsigned value);
  /// Sets all pins to output, low, and drops an incomplete message other than a system-exclusive
  /// one.
  Encoder &reset();
  Encoder &end_sysex(); ///< `F7`: ends one that was cut off
  /// `F0 01 F7`, an id that Firmata leaves to its users: the host is alive. For kSeatFirmware;
  /// others ignore it.
  Encoder &keepalive();

  const std::vector<std::uint8_t> &bytes() const
  {
    return bytes_;
  }

private:
  Encoder &add(std::initializer_list<unsigned> bytes);

  std::vector<std::uint8_t> bytes_;
};

/// `F9 major minor`: version of the protocol.
struct VersionReport
{
  int major = 0;
  int minor = 0;
  bool operator==(const VersionReport &) const = default;
};

struct FirmwareReport
{
  int major = 0;
  int minor = 0;
  std::string
      name; ///< printable ASCII (others are '?'), at most 64 characters, as "StandardFirmata.ino"
  bool operator==(const FirmwareReport &) const = default;
};

/// A capability of a pin.
struct PinMode
{
  std::uint8_t mode = 0;
  std::uint8_t resolution = 0; ///< bits
  bool operator==(const PinMode &) const = default;
};

/// Modes of each pin, from pin 0 on.
struct CapabilityReport
{
  std::vector<std::vector<PinMode>> pins;
  bool operator==(const CapabilityReport &) const = default;
};

/// A well-formed message from the board. Other messages of Firmata (inputs, pin states, I2C,
/// servos, text) are ignored.
using Event = std::variant<VersionReport, FirmwareReport, CapabilityReport>;

/// Decodes a board's bytes. It never holds more than kMaxSysex bytes, and resynchronizes after a
/// damaged message: a byte of 0x80 or more other than F7 begins a message.
class Decoder
{
public:
  /// Longer system-exclusive messages are dropped: a capability report of 128 pins with 15 modes
  /// each fits.
  static constexpr std::size_t kMaxSysex = 4096;

  /// Takes the next bytes, in any pieces. `event` is called for each message that ends in them.
  void feed(std::span<const std::uint8_t> bytes, const std::function<void(const Event &)> &event);

  /// Messages that were truncated, too long or inconsistent, and bytes outside of messages, since
  /// construction.
  std::uint64_t damaged() const
  {
    return damaged_;
  }

private:
  void end_sysex(const std::function<void(const Event &)> &event);

  enum class Inside
  {
    nothing,
    short_message, ///< status byte and two data bytes
    sysex,
    long_sysex, ///< too long: skipped up to its end
  };
  Inside inside_ = Inside::nothing;
  std::uint8_t status_ = 0;
  std::vector<std::uint8_t> data_; ///< data bytes of the message so far
  std::uint64_t damaged_ = 0;
};

} // namespace tactor::firmata
