// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/firmata_model.h"

#include <algorithm>

void
FirmataModel::restart(Time now)
{
  duty.clear();
  mode.clear();
  parsed_.clear();
  armed_ = false;
  boots_ = now + boot_;
  pass(now);
}

void
FirmataModel::power_off()
{
  restart(Time(0));
  boots_.reset();
  is_running = false;
  replies.clear();
}

std::optional<FirmataModel::Time>
FirmataModel::next() const
{
  if (boots_)
    return boots_;
  return armed_ ? std::optional(last_byte_ + kWatchdog) : std::nullopt;
}

void
FirmataModel::pass(Time now)
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

void
FirmataModel::receive(std::uint8_t byte, Time now)
{
  pass(now);
  if (boots_ || !is_running)
    return;
  received.push_back(byte);
  last_byte_ = now;
  if (tripped_)
    armed_ = true;
  tripped_ = false;
  // As in Firmata.cpp: in a sysex all bytes up to F7 are data, FF too.
  const bool is_in_sysex = !parsed_.empty() && parsed_[0] == 0xf0;
  if (byte == 0xff && !is_in_sysex) {
    parsed_.clear();
    duty.clear();
    mode.clear();
    resets++;
    return;
  }
  // Elsewhere a status byte begins a message.
  if (!is_in_sysex) {
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

bool
FirmataModel::is_silent() const
{
  return std::ranges::all_of(duty, [](const auto &pin) { return pin.second == 0; });
}

void
FirmataModel::write(int pin, int value)
{
  // analogWrite() ignores pins that are not in PWM mode. The register keeps only its own bits.
  if (pin < layout_.pins && mode.contains(pin) && mode[pin] == 3 && layout_.pwm.contains(pin))
    duty[pin] = value & ((1 << layout_.pwm_bits) - 1);
}

void
FirmataModel::say(const std::vector<int> &bytes)
{
  for (const int byte : bytes)
    replies.push_back(static_cast<std::uint8_t>(byte));
}

void
FirmataModel::say_firmware()
{
  say({ 0xf0, 0x79, 2, 5 });
  for (const char c : seat_ ? std::string("visuotactile-seat.ino") : firmware)
    say({ c & 0x7f, (c >> 7) & 1 });
  say({ 0xf7 });
}

void
FirmataModel::sysex(std::span<const std::uint8_t> data)
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
