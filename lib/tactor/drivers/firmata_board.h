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

/// Timeouts and intervals, in steady time.
struct FirmataPatience
{
  Time answer = std::chrono::seconds(
      5); ///< for the first answers; a Mega is silent for 2.1 s after a reset
  Time ask_again = std::chrono::milliseconds(500);
  Time transfer = std::chrono::seconds(1);            ///< for the line to take a transfer
  Time host_silence = std::chrono::milliseconds(250); ///< see FirmataBoard::set_levels()
  Time keepalive = std::chrono::milliseconds(
      100); ///< between transfers to a board with watchdog while a motor is on
  Time drain = std::chrono::milliseconds(250); ///< for the zeros of close() to be sent
  /// After that, for the board's answer that it has read them.
  Time acknowledge = std::chrono::milliseconds(250);
};

/// State machine for one board that speaks Firmata. The owner sends what next() returns and reports
/// received(), written() and the time. It never waits, reads no clock and is not thread-safe.
///
/// 1. *Asking*: the firmware version is queried repeatedly, as the banner may have passed. Then the
///    board is reset, since it still drives its motors if its last host was killed, and its pins'
///    capabilities are queried.
/// 2. *Running*: each pin with pulse-width modulation is a tactor, in ascending order of pins.
///    Levels that have changed are sent in packets of kPacket bytes, round robin; the latest levels
///    win. A board that reports its firmware without a query was reset, and all is sent again.
/// 3. *Closing*: zeros, then a reset, then a query whose answer proves that the board has read
///    them. Releasing the board earlier may cut them off: the kernel's driver takes over and sets
///    another baud rate, for which the USB chip switches its serial line off and on.
///
/// A USB chip takes bytes faster than its serial line carries them; they would queue there, old
/// levels before new ones. Hence at most one packet is under way, and a level arrives line().all()
/// and a packet after set_levels() at the latest.
///
/// While a motor is on, a board with watchdog (firmata::kSeatFirmware) gets keepalives. They prove
/// that the caller of set_levels() is alive: after host_silence without a call all levels are zero,
/// with any firmware.
class FirmataBoard
{
public:
  enum class State
  {
    asking,
    running,
    closing,
    closed, ///< nothing more is sent; see is_stopped()
    failed, ///< see failure()
  };

  /// Time of a byte on the line.
  static constexpr Time kByteTime = SerialPort::kByteTime;
  /// Most bytes under way at once: a packet of full-speed USB.
  static constexpr std::size_t kPacket = 64;

  FirmataBoard(Time now, FirmataPatience patience = {});

  /// Bytes from the board, in any pieces.
  void received(std::span<const std::uint8_t> bytes);
  /// The last bytes of next() were written.
  void written();

  /// Bytes to send now, at most kPacket. Empty if there are none, and until the last ones were
  /// written() and carried by the line.
  std::vector<std::uint8_t> next(Time now);
  /// When to call next() if nothing else happens.
  std::optional<Time> deadline() const;

  /// Sets the level of each tactor, 0…1 (others are clamped, NaN is 0); further tactors are at
  /// zero. To be repeated within host_silence while one is not zero. True if there is something to
  /// send.
  bool set_levels(std::span<const double> levels, Time now);

  void close(Time now);

  State state() const
  {
    return state_;
  }
  /// The reason of `failed`, in one line without the board's name.
  const std::string &failure() const
  {
    return failure_;
  }
  /// Name and version of the firmware, as "StandardFirmata.ino 2.5"; empty before the report.
  std::string firmware() const;
  bool has_watchdog() const;
  /// Whether a closed board has confirmed that its motors are at zero.
  bool is_stopped() const
  {
    return is_stopped_;
  }
  /// Whether the board has no level but zero: what was sent last has been carried by the line.
  bool is_still(Time now) const;
  /// Pin of each tactor.
  std::vector<int> pins() const;
  /// Smallest step of a level on the coarsest pin; 0 without pins.
  double resolution() const;
  LineTime line() const;
  std::uint64_t bytes_sent() const
  {
    return bytes_sent_;
  }
  /// How often the running board was reset by others.
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
    std::optional<unsigned> value{}; ///< that the board has; none: unknown
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
  bool heard_ = false; ///< any byte came
  std::optional<firmata::FirmwareReport> firmware_;
  bool is_reset_ = false; ///< by us
  bool is_armed_ = false; ///< its watchdog, which the first keepalive starts
  std::vector<Pin> pins_;
  std::vector<double> levels_;  ///< as wanted; shorter than pins_: the rest is 0
  bool shutdown_begun_ = false; ///< the last transfer of close() was begun
  bool shutdown_sent_ = false;  ///< it was written
  bool is_stopped_ = false;

  Time started_;
  std::optional<Time> asked_;
  Time levels_set_{ 0 };
  Time sent_{ 0 };                     ///< begin of the last transfer
  bool on_the_way_ = false;            ///< it is not yet written
  Time line_free_;                     ///< when the line has carried it
  std::size_t turn_ = 0;               ///< tactor whose level is sent first
  std::optional<Time> close_deadline_; ///< end of closing
  std::uint64_t bytes_sent_ = 0;
  std::uint64_t resets_ = 0;
};

} // namespace tactor
