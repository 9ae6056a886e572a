// SPDX-License-Identifier: LGPL-2.1-or-later
#include "standard_firmata.h"

#include <cstddef>
#include <utility>

namespace usb_test {

namespace {

constexpr std::size_t kLongestSysex = 64; // MAX_DATA_BYTES of the sketch's library

std::set<int>
range(int first, int last)
{
  std::set<int> all;
  for (int i = first; i <= last; i++)
    all.insert(i);
  return all;
}

void
append_14_bits(Bytes &bytes, int value)
{
  bytes.push_back(value & 0x7f);
  bytes.push_back(value >> 7 & 0x7f);
}

} // namespace

StandardFirmata::Pins
StandardFirmata::mega()
{
  Pins pins{ .count = 70, .first_analog = 54, .pwm = range(2, 13), .i2c = { 20, 21 } };
  pins.pwm.merge(range(44, 46));
  return pins;
}

StandardFirmata::Pins
StandardFirmata::uno()
{
  return { .count = 20, .first_analog = 14, .pwm = { 3, 5, 6, 9, 10, 11 }, .i2c = { 18, 19 } };
}

StandardFirmata::StandardFirmata(Pins pins, std::string name)
    : layout_(std::move(pins)), name_(std::move(name)),
      pins_(static_cast<std::size_t>(layout_.count))
{
}

Bytes
StandardFirmata::reset()
{
  message_.clear();
  rest(Clock::now());
  Bytes banner{ 0xf9, 2, 5 };
  const Bytes name = firmware();
  banner.insert(banner.end(), name.begin(), name.end());
  return banner;
}

Bytes
StandardFirmata::receive(std::uint8_t byte, Clock::time_point time)
{
  const bool in_sysex = !message_.empty() && message_[0] == 0xf0;
  if (byte >= 0x80) {
    if (in_sysex && byte == 0xf7) {
      const Bytes body(message_.begin() + 1, message_.end());
      message_.clear();
      return sysex(body, time);
    }
    message_ = { byte };
  } else if (!message_.empty() && (!in_sysex || message_.size() <= kLongestSysex)) {
    message_.push_back(byte);
  }
  return message(time);
}

/// Acts on message_ as soon as it is whole.
Bytes
StandardFirmata::message(Clock::time_point time)
{
  if (message_.empty())
    return {};
  const int command = message_[0] < 0xf0 ? message_[0] & 0xf0 : message_[0];
  const std::size_t length
      = command == 0xe0 || command == 0x90 || command == 0xf4 || command == 0xf5 ? 3
        : command == 0xc0 || command == 0xd0                                     ? 2
                                                                                 : 1;
  if (command == 0xf0 || message_.size() < length)
    return {};
  const Bytes whole = std::exchange(message_, {});
  switch (command) {
  case 0xe0:
    write(whole[0] & 0x0f, whole[1] | whole[2] << 7, time);
    break;
  case 0xf4:
    set_mode(whole[1], whole[2], time);
    break;
  case 0xf9:
    return { 0xf9, 2, 5 };
  case 0xff:
    resets_++;
    rest(time);
    break;
  default:
    break;
  }
  return {};
}

Bytes
StandardFirmata::sysex(std::span<const std::uint8_t> body, Clock::time_point time)
{
  if (body.empty())
    return {};
  switch (body[0]) {
  case 0x79:
    return firmware();
  case 0x6b:
    return capabilities();
  case 0x69:
    return analog_mapping();
  case 0x6d: {
    if (body.size() < 2 || !has_pin(body[1]))
      return {};
    const Pin &pin = pins_[body[1]];
    Bytes reply{ 0xf0, 0x6e, body[1], static_cast<std::uint8_t>(pin.mode) };
    reply.push_back(pin.value & 0x7f);
    if (pin.value > 0x7f)
      reply.push_back(pin.value >> 7 & 0x7f);
    reply.push_back(0xf7);
    return reply;
  }
  case 0x6f: {
    int value = 0;
    for (std::size_t i = 2; i < body.size() && i < 5; i++)
      value |= body[i] << 7 * (i - 2);
    if (body.size() > 2)
      write(body[1], value, time);
    return {};
  }
  default:
    return {};
  }
}

Bytes
StandardFirmata::capabilities() const
{
  Bytes reply{ 0xf0, 0x6c };
  const auto mode = [&](std::uint8_t number, std::uint8_t resolution) {
    reply.push_back(number);
    reply.push_back(resolution);
  };
  for (int pin = 0; pin < layout_.count; pin++) {
    if (pin >= 2) { // 0 and 1 are the serial line
      mode(0, 1);   // input
      mode(11, 1);  // pull-up
      mode(kOutput, 1);
      if (pin >= layout_.first_analog)
        mode(kAnalog, 10);
      if (layout_.pwm.contains(pin))
        mode(kPwm, 8);
      mode(4, 14); // servo
      if (layout_.i2c.contains(pin))
        mode(6, 1);
    }
    reply.push_back(0x7f);
  }
  reply.push_back(0xf7);
  return reply;
}

Bytes
StandardFirmata::analog_mapping() const
{
  Bytes reply{ 0xf0, 0x6a };
  for (int pin = 0; pin < layout_.count; pin++)
    reply.push_back(pin < layout_.first_analog ? 0x7f : pin - layout_.first_analog);
  reply.push_back(0xf7);
  return reply;
}

Bytes
StandardFirmata::firmware() const
{
  Bytes reply{ 0xf0, 0x79, 2, 5 };
  for (const char c : name_)
    append_14_bits(reply, static_cast<std::uint8_t>(c));
  reply.push_back(0xf7);
  return reply;
}

void
StandardFirmata::set_mode(int pin, int mode, Clock::time_point time)
{
  if (!has_pin(pin) || (mode == kPwm && !layout_.pwm.contains(pin)))
    return;
  pins_[pin].mode = mode;
  if (mode == kPwm || mode == kOutput)
    write(pin, 0, time);
}

void
StandardFirmata::write(int pin, int value, Clock::time_point time)
{
  if (!has_pin(pin) || (pins_[pin].mode != kPwm && value != 0))
    return;
  pins_[pin].value = value;
  const int duty = value & 0xff; // the compare register's 8 bits
  if (pins_[pin].duty != duty)
    changes_.push_back({ time, pin, duty });
  pins_[pin].duty = duty;
}

void
StandardFirmata::rest(Clock::time_point time)
{
  for (int pin = 0; pin < layout_.count; pin++) {
    write(pin, 0, time);
    pins_[pin].mode = pin >= layout_.first_analog ? kAnalog : kOutput;
  }
}

bool
StandardFirmata::has_pin(int pin) const
{
  return pin >= 0 && pin < layout_.count;
}

int
StandardFirmata::duty(int pin) const
{
  return pins_.at(static_cast<std::size_t>(pin)).duty;
}

int
StandardFirmata::mode(int pin) const
{
  return pins_.at(static_cast<std::size_t>(pin)).mode;
}

const std::vector<StandardFirmata::Change> &
StandardFirmata::changes() const
{
  return changes_;
}

int
StandardFirmata::resets() const
{
  return resets_;
}

} // namespace usb_test
