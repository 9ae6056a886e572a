// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/firmata_board.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactor {

namespace {

/// Pins with a higher resolution are not driven: no board has them, and a value has 21 bits.
constexpr int kMostBits = 16;

static_assert(FirmataBoard::kPacket <= SerialPort::kMaxWrite);

int
message_bytes(int pin, unsigned value)
{
  return static_cast<int>(firmata::Encoder().set_value(pin, value).bytes().size());
}

} // namespace

FirmataBoard::FirmataBoard(Time now, FirmataPatience patience)
    : patience_(patience), started_(now), line_free_(now)
{
}

/* ---- what happens ---- */

void
FirmataBoard::received(std::span<const std::uint8_t> bytes)
{
  heard_ = heard_ || !bytes.empty();
  decoder_.feed(bytes, [this](const firmata::Event &event) { take(event); });
}

void
FirmataBoard::take(const firmata::Event &event)
{
  if (const auto *firmware = std::get_if<firmata::FirmwareReport>(&event)) {
    if (state_ == State::asking) {
      if (!firmware_)
        asked_.reset(); // the next question at once; later reports repeat the answer
      firmware_ = *firmware;
    } else if (state_ == State::running) {
      // No query preceded: the board was reset.
      firmware_ = *firmware;
      resets_++;
      is_armed_ = false;
      for (Pin &pin : pins_) {
        pin.is_pwm = false;
        pin.value.reset();
      }
    }
  } else if (const auto *capabilities = std::get_if<firmata::CapabilityReport>(&event)) {
    // A report before our reset answers another program.
    if (state_ == State::asking && is_reset_)
      take_capabilities(*capabilities);
  } else if (std::holds_alternative<firmata::VersionReport>(event)) {
    if (state_ == State::closing && shutdown_begun_) {
      state_ = State::closed; // so it has read the zeros, too
      is_stopped_ = true;
    }
  }
}

void
FirmataBoard::take_capabilities(const firmata::CapabilityReport &report)
{
  for (std::size_t i = 0; i < report.pins.size(); i++) {
    const auto pwm = std::ranges::find(report.pins[i], firmata::kPwm, &firmata::PinMode::mode);
    if (pwm != report.pins[i].end() && pwm->resolution >= 1 && pwm->resolution <= kMostBits)
      pins_.push_back({ .number = static_cast<int>(i), .full = (1u << pwm->resolution) - 1 });
  }
  state_ = State::running;
}

void
FirmataBoard::written()
{
  on_the_way_ = false;
}

bool
FirmataBoard::set_levels(std::span<const double> levels, Time now)
{
  if (state_ != State::asking && state_ != State::running)
    return false;
  levels_.assign(levels.begin(), levels.end());
  levels_set_ = now;
  return state_ == State::running && !is_settled();
}

void
FirmataBoard::close(Time now)
{
  levels_.clear();
  // A board that speaks Firmata may still drive motors for its last host. To others nothing was
  // sent that moves one.
  if (state_ == State::running || (state_ == State::asking && firmware_)) {
    state_ = State::closing;
    close_deadline_ = now + patience_.drain;
  } else if (state_ == State::asking) {
    state_ = State::closed;
  }
}

void
FirmataBoard::fail(std::string why)
{
  state_ = State::failed;
  failure_ = std::move(why);
}

/* ---- what is sent ---- */

std::vector<std::uint8_t>
FirmataBoard::next(Time now)
{
  if (shutdown_begun_ && !on_the_way_ && !std::exchange(shutdown_sent_, true))
    close_deadline_ = std::max(now, line_free_) + patience_.acknowledge;
  if (state_ == State::closing && now >= *close_deadline_)
    state_ = State::closed;
  if (state_ == State::closed || state_ == State::failed)
    return {};
  if (state_ == State::asking && now - started_ >= patience_.answer) {
    fail(!heard_      ? "it does not answer: is StandardFirmata on it?"
         : !firmware_ ? "what it says is not Firmata at 57600 baud: is StandardFirmata on it?"
                      : firmware() + " does not say what its pins can do");
    return {};
  }
  if (on_the_way_) {
    if (now - sent_ >= patience_.transfer)
      fail("it does not take what it is sent");
    return {};
  }
  if (now < line_free_ || shutdown_begun_)
    return {};

  firmata::Encoder out;
  if (state_ == State::asking)
    ask(out, now);
  else
    update(out, now);
  if (!out.bytes().empty()) {
    on_the_way_ = true;
    sent_ = now;
    line_free_ = now + static_cast<int>(out.bytes().size()) * kByteTime;
    bytes_sent_ += out.bytes().size();
  }
  return out.bytes();
}

void
FirmataBoard::ask(firmata::Encoder &out, Time now)
{
  if (asked_ && now - *asked_ < patience_.ask_again)
    return;
  asked_ = now;
  if (!firmware_) {
    out.ask_version().ask_firmware();
    return;
  }
  if (!std::exchange(is_reset_, true))
    out.end_sysex().reset(); // its last host may have been cut off
  out.ask_capabilities();
}

/// Adds levels that have changed, as many as one packet holds.
void
FirmataBoard::update(firmata::Encoder &out, Time now)
{
  if (state_ == State::running && now - levels_set_ >= patience_.host_silence)
    levels_.clear();
  // After a stop of the host (SIGSTOP, suspend to RAM) the watchdog may have acted.
  if (has_watchdog() && drives()
      && now - sent_ >= (patience_.keepalive + patience_.host_silence) / 2)
    for (Pin &pin : pins_)
      pin.value.reset();

  constexpr std::size_t kEnd = kPacket - 2 * firmata::Encoder::kLongest;
  const std::size_t first = turn_;
  for (std::size_t i = 0; i < pins_.size(); i++) {
    const std::size_t tactor = (first + i) % pins_.size();
    if (out.bytes().size() > kEnd) {
      turn_ = tactor; // round robin: no starvation by levels that always change
      break;
    }
    Pin &pin = pins_[tactor];
    if (!std::exchange(pin.is_pwm, true))
      out.set_mode(pin.number, firmata::kPwm);
    const unsigned value = target(tactor);
    if (pin.value != value) {
      out.set_value(pin.number, value);
      pin.value = value;
    }
  }
  if (state_ == State::closing && is_settled()) {
    out.reset().ask_version();
    shutdown_begun_ = true;
  } else if (has_watchdog()
             && (!is_armed_
                 || (out.bytes().empty() && drives() && now - sent_ >= patience_.keepalive))) {
    out.keepalive();
    is_armed_ = true;
  }
}

std::optional<Time>
FirmataBoard::deadline() const
{
  std::optional<Time> at;
  const auto earlier = [&at](Time time) {
    at = at ? std::min(*at, time) : time;
  };
  if (state_ == State::closed || state_ == State::failed)
    return at;
  if (state_ == State::asking)
    earlier(started_ + patience_.answer);
  if (state_ == State::closing)
    earlier(*close_deadline_);
  // While a transfer is on the way, only its timeout counts; after that the line has to be free.
  const auto when_free = [&](Time time) {
    earlier(std::max(time, line_free_));
  };
  if (on_the_way_) {
    earlier(sent_ + patience_.transfer);
  } else if (state_ == State::asking) {
    when_free(asked_ ? *asked_ + patience_.ask_again : started_);
  } else if (state_ == State::closing) {
    if (!shutdown_begun_)
      when_free(line_free_);
  } else if (state_ == State::running) {
    if (!is_settled())
      when_free(line_free_);
    if (std::ranges::any_of(levels_, [](double level) { return level > 0; }))
      when_free(levels_set_ + patience_.host_silence);
    if (has_watchdog() && drives())
      when_free(sent_ + patience_.keepalive);
  }
  return at;
}

unsigned
FirmataBoard::target(std::size_t tactor) const
{
  const double level = tactor < levels_.size() ? levels_[tactor] : 0.0;
  // NaN compares as false. A value beyond the pin's bits would wrap.
  return level > 0 ? static_cast<unsigned>(std::lround(std::min(level, 1.0) * pins_[tactor].full))
                   : 0;
}

/// Whether the board has all levels.
bool
FirmataBoard::is_settled() const
{
  for (std::size_t i = 0; i < pins_.size(); i++)
    if (pins_[i].value != target(i))
      return false;
  return true;
}

bool
FirmataBoard::is_still(Time now) const
{
  return pins_.empty() || (!on_the_way_ && now >= line_free_ && !drives());
}

/// Whether a motor may be on.
bool
FirmataBoard::drives() const
{
  return std::ranges::any_of(pins_, [](const Pin &pin) { return pin.value != 0u; });
}

/* ---- what it is ---- */

std::string
FirmataBoard::firmware() const
{
  if (!firmware_)
    return {};
  return firmware_->name + " " + std::to_string(firmware_->major) + "."
         + std::to_string(firmware_->minor);
}

bool
FirmataBoard::has_watchdog() const
{
  return firmware_ && firmware_->name.starts_with(firmata::kSeatFirmware);
}

std::vector<int>
FirmataBoard::pins() const
{
  std::vector<int> pins;
  for (const Pin &pin : pins_)
    pins.push_back(pin.number);
  return pins;
}

double
FirmataBoard::resolution() const
{
  double step = 0;
  for (const Pin &pin : pins_)
    step = std::max(step, 1.0 / pin.full);
  return step;
}

LineTime
FirmataBoard::line() const
{
  std::vector<int> bytes;
  for (const Pin &pin : pins_)
    bytes.push_back(message_bytes(pin.number, pin.full));
  return { bytes, kByteTime };
}

} // namespace tactor
