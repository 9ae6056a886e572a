// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/drivers/firmata_protocol.h"
#include "tactor/line_time.h"
#include "tactor/serial/serial_port.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactor {

/// How long is waited for what, of steady time.
struct FirmataPatience
{
  Time answer = std::chrono::seconds(
      5); ///< for a board to say what it is: a Mega that was reset says nothing for 2.1 s
  Time ask_again = std::chrono::milliseconds(500);
  Time transfer = std::chrono::seconds(1);            ///< for the line to take a transfer
  Time host_silence = std::chrono::milliseconds(250); ///< see FirmataBoard::set_levels()
  Time keepalive = std::chrono::milliseconds(
      100); ///< between transfers to a board with watchdog, while a motor is on
  Time farewell = std::chrono::milliseconds(250); ///< for the zeros of close() to be taken
  Time last_word = std::chrono::milliseconds(
      50); ///< when the line has carried them, for the board to say that it has read them
};

/// The conversation with one board that speaks Firmata, over a line that is somebody else's: what
/// to send comes from next(), what happened is told by received(), written() and the time. Neither
/// waits, nor looks at a clock, nor knows threads.
///
/// 1. *Asking*: the firmware is asked for again and again (nobody waits for the banner, which may
///    have passed), then reset, since a board whose last host was killed still drives its motors,
///    then asked for its pins' capabilities.
/// 2. *Running*: each pin with pulse-width modulation is a tactor, in ascending order of pins.
///    Levels that differ from what the board has go out, a packet of kPacket bytes at a time, every
///    pin in its turn; until one is carried the latest levels win. A board that reports its
///    firmware unasked was reset and is told everything anew.
/// 3. *Closing*: zeros, then reset, then a question whose answer proves that the board has read
///    them. Whoever releases it before may cut them off: the kernel's driver, which takes over,
///    sets another baud rate, and the USB chip switches its serial line off and on.
///
/// A USB chip takes bytes faster than the line behind it carries them, and they would queue there,
/// old levels before new ones. So nothing is sent before the line has carried what was sent: never
/// more than one packet is under way, and a level has arrived update_time() and a packet after
/// set_levels() at the latest.
///
/// With a watchdog (firmata::kSeatFirmware) there are keepalives while a motor is on. They prove
/// that whoever sets the levels is alive, not just this object: after host_silence without
/// set_levels() all levels are zero, whatever the firmware.
///
/// Not thread-safe: its owner guards it.
class FirmataBoard
{
public:
  enum class State
  {
    asking,
    running,
    closing,
    /// The motors are at zero, or the board did not say so in time; nothing is sent any more.
    closed,
    failed, ///< see failure()
  };

  /// What a byte takes on the line.
  static constexpr Time kByteTime = SerialPort::kByteTime;
  /// Most bytes under way at once: a packet of full-speed USB.
  static constexpr std::size_t kPacket = 64;

  FirmataBoard(Time now, FirmataPatience patience = {});

  /// The board's bytes, cut anywhere.
  void received(std::span<const std::uint8_t> bytes);
  /// The line has taken what next() returned last.
  void written();

  /// What to send now, at most kPacket bytes; empty if there is nothing, and until written() and
  /// the line has carried the last.
  std::vector<std::uint8_t> next(Time now);
  /// When next() is to be called even if nothing else happens.
  std::optional<Time> deadline() const;

  /// What each tactor shall do, 0…1 of full scale (others are clamped, NaN is 0); tactors beyond
  /// are at zero. To be repeated within host_silence while one is not zero. True if there is
  /// something to send.
  bool set_levels(std::span<const double> levels, Time now);

  void close(Time now);

  State state() const
  {
    return state_;
  }
  /// Why, in one line without the board's name.
  const std::string &failure() const
  {
    return failure_;
  }
  /// Name and version of the firmware, as "StandardFirmata.ino 2.5"; empty before it was told.
  std::string firmware() const;
  bool has_watchdog() const;
  /// Pin of each tactor.
  std::vector<int> pins() const;
  /// Smallest step of a level that every pin can make; 0 without pins.
  double resolution() const;
  /// What the line carries of each tactor.
  LineTime line() const;
  std::uint64_t bytes_sent() const
  {
    return bytes_sent_;
  }
  /// How often the running board was reset by somebody else.
  std::uint64_t resets() const
  {
    return resets_;
  }

private:
  struct Pin
  {
    int number = 0;
    unsigned full = 0;               ///< value of level 1
    bool is_pwm = false;             ///< its mode was set
    std::optional<unsigned> value{}; ///< that the board has; none: not known
  };

  void take(const firmata::Event &event);
  void take_capabilities(const firmata::CapabilityReport &report);
  void ask(firmata::Encoder &out, Time now);
  void update(firmata::Encoder &out, Time now);
  unsigned target(std::size_t tactor) const;
  bool is_settled() const;
  bool drives() const;
  void fail(std::string why);

  FirmataPatience patience_;
  State state_ = State::asking;
  std::string failure_;
  firmata::Decoder decoder_;
  bool heard_ = false; ///< any byte
  std::optional<firmata::FirmwareReport> firmware_;
  bool is_reset_ = false; ///< by us
  bool is_armed_ = false; ///< its watchdog, by the first keepalive
  std::vector<Pin> pins_;
  std::vector<double> levels_; ///< as wanted; shorter than pins_: the rest is 0
  bool says_goodbye_ = false;  ///< the last transfer of close() is on the way, or was
  bool listens_ = false;       ///< the line has taken it

  Time started_;
  std::optional<Time> asked_;
  Time levels_set_{ 0 };
  Time sent_{ 0 };             ///< begin of the last transfer
  bool on_the_way_ = false;    ///< it is not yet taken
  Time line_free_;             ///< when the line has carried it
  std::size_t turn_ = 0;       ///< whose level goes out first
  std::optional<Time> leaves_; ///< end of closing
  std::uint64_t bytes_sent_ = 0;
  std::uint64_t resets_ = 0;
};

} // namespace tactor
