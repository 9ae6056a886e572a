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

/// The Firmata protocol, version 2.5 (github.com/firmata/protocol): bytes, and nothing of when they
/// are sent.
namespace tactor::firmata {

/// Pins have numbers of 7 bits.
inline constexpr int kMaxPins = 128;
/// Mode of a pin whose output is pulse-width modulated: a motor's.
inline constexpr std::uint8_t kPwm = 3;
/// Firmware whose name begins with this has the watchdog: 250 ms without a byte from the host turn
/// every motor off.
inline constexpr std::string_view kSeatFirmware = "visuotactile-seat";

/// Messages to a board, one behind the other. Pins are 0…127, other values are cut to their field.
class Encoder
{
public:
  /// Longest message of a pin: what one set_mode() or set_value() adds at most.
  static constexpr std::size_t kLongest = 7;

  Encoder &ask_version();      ///< `F9`
  Encoder &ask_firmware();     ///< `F0 79 F7`
  Encoder &ask_capabilities(); ///< `F0 6B F7`
  Encoder &set_mode(int pin, std::uint8_t mode);
  /// A pin's duty: an analog message where pin (below 16) and value (14 bits) fit, else an extended
  /// one (21 bits).
  Encoder &set_value(int pin, unsigned value);
  /// All pins to output, low; whatever of a message was on the way is forgotten.
  Encoder &reset();
  /// `F0 01 F7`, of the ids that Firmata leaves to its users: the host is alive. Known to
  /// kSeatFirmware alone, harmless to others.
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

/// What runs on the board.
struct FirmwareReport
{
  int major = 0;
  int minor = 0;
  std::string
      name; ///< printable ASCII (others are '?'), at most 64 characters, as "StandardFirmata.ino"
  bool operator==(const FirmwareReport &) const = default;
};

/// What a pin can do.
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

/// A message of the board that is well formed; others of Firmata's (inputs, pin states, I2C,
/// servos, text) mean nothing here and are not told.
using Event = std::variant<VersionReport, FirmwareReport, CapabilityReport>;

/// Takes a board's bytes apart. Whatever comes, it holds no more than kMaxSysex bytes, and it finds
/// the next whole message behind a damaged one: a byte of 0x80 or more other than F7 begins a
/// message anew.
class Decoder
{
public:
  /// Longer system-exclusive messages are dropped: a capability report of 128 pins with 15 modes
  /// each fits.
  static constexpr std::size_t kMaxSysex = 4096;

  /// The next bytes of the line, cut anywhere. `event` is called once for each message that ends in
  /// them.
  void feed(std::span<const std::uint8_t> bytes, const std::function<void(const Event &)> &event);

  /// Messages that were cut short, too long or contradict themselves, and bytes outside any, since
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
    long_sysex, ///< too long: its end is waited for
  };
  Inside inside_ = Inside::nothing;
  std::uint8_t status_ = 0;
  std::vector<std::uint8_t> data_; ///< data bytes of the message so far
  std::uint64_t damaged_ = 0;
};

} // namespace tactor::firmata
