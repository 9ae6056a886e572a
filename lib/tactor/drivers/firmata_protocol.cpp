// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/firmata_protocol.h"

#include <algorithm>
#include <optional>

namespace tactor::firmata {

namespace {

constexpr unsigned kStartSysex = 0xf0;
constexpr unsigned kEndSysex = 0xf7;
constexpr unsigned kVersion = 0xf9;
constexpr unsigned kReset = 0xff;
constexpr unsigned kSetMode = 0xf4;
constexpr unsigned kAnalog = 0xe0;
// Sysex ids
constexpr unsigned kKeepalive = 0x01;
constexpr unsigned kCapabilityQuery = 0x6b;
constexpr unsigned kCapabilityReport = 0x6c;
constexpr unsigned kExtendedAnalog = 0x6f;
constexpr unsigned kFirmware = 0x79;

constexpr unsigned kEndOfPin = 0x7f;
constexpr std::size_t kLongestName = 64;

using Data = std::span<const std::uint8_t>;

std::optional<Event>
firmware_report(Data data)
{
  // The name is in pairs of 7 bits, low bits first.
  if (data.size() < 2 || data.size() % 2 != 0)
    return std::nullopt;
  FirmwareReport report{ .major = data[0], .minor = data[1], .name = {} };
  for (std::size_t i = 2; i < data.size() && report.name.size() < kLongestName; i += 2) {
    const unsigned character = data[i] | unsigned{ data[i + 1] } << 7;
    report.name += character >= ' ' && character <= '~' ? static_cast<char>(character) : '?';
  }
  return report;
}

std::optional<Event>
capability_report(Data data)
{
  if (data.empty() || data.back() != kEndOfPin)
    return std::nullopt;
  CapabilityReport report;
  std::vector<PinMode> modes;
  for (std::size_t i = 0; i < data.size();) {
    if (data[i] == kEndOfPin) {
      report.pins.push_back(std::move(modes));
      modes.clear();
      i++;
    } else {
      // The last byte is kEndOfPin, so there is one more. In a list of odd length it stands in
      // place of a resolution.
      if (data[i + 1] == kEndOfPin)
        return std::nullopt;
      modes.push_back({ .mode = data[i], .resolution = data[i + 1] });
      i += 2;
    }
  }
  if (report.pins.size() > kMaxPins)
    return std::nullopt;
  return report;
}

} // namespace

/* ---- to the board ---- */

Encoder &
Encoder::add(std::initializer_list<unsigned> bytes)
{
  for (const unsigned byte : bytes)
    bytes_.push_back(static_cast<std::uint8_t>(byte));
  return *this;
}

Encoder &
Encoder::ask_version()
{
  return add({ kVersion });
}

Encoder &
Encoder::ask_firmware()
{
  return add({ kStartSysex, kFirmware, kEndSysex });
}

Encoder &
Encoder::ask_capabilities()
{
  return add({ kStartSysex, kCapabilityQuery, kEndSysex });
}

Encoder &
Encoder::set_mode(int pin, std::uint8_t mode)
{
  return add({ kSetMode, static_cast<unsigned>(pin) & 0x7f, mode & 0x7fu });
}

Encoder &
Encoder::set_value(int pin, unsigned value)
{
  const unsigned number = static_cast<unsigned>(pin) & 0x7f;
  const unsigned low = value & 0x7f;
  const unsigned high = value >> 7 & 0x7f;
  const unsigned highest = value >> 14 & 0x7f;
  if (highest != 0)
    return add({ kStartSysex, kExtendedAnalog, number, low, high, highest, kEndSysex });
  if (number > 0x0f)
    return add({ kStartSysex, kExtendedAnalog, number, low, high, kEndSysex });
  return add({ kAnalog | number, low, high });
}

Encoder &
Encoder::reset()
{
  return add({ kReset });
}

Encoder &
Encoder::end_sysex()
{
  return add({ kEndSysex });
}

Encoder &
Encoder::keepalive()
{
  return add({ kStartSysex, kKeepalive, kEndSysex });
}

/* ---- from the board ---- */

void
Decoder::feed(std::span<const std::uint8_t> bytes, const std::function<void(const Event &)> &event)
{
  for (const std::uint8_t byte : bytes) {
    if (byte == kEndSysex && inside_ == Inside::sysex) {
      end_sysex(event);
      inside_ = Inside::nothing;
    } else if (byte >= 0x80) {
      damaged_ += inside_ != Inside::nothing || byte == kEndSysex;
      data_.clear();
      status_ = byte;
      // Digital (9x) and analog (Ex) inputs have two data bytes, as the version has. Boards send
      // nothing else.
      const unsigned kind = byte & 0xf0u;
      inside_ = byte == kStartSysex                                ? Inside::sysex
                : byte == kVersion || kind == 0x90 || kind == 0xe0 ? Inside::short_message
                                                                   : Inside::nothing;
    } else if (inside_ == Inside::nothing) {
      damaged_++;
    } else if (inside_ == Inside::sysex && data_.size() == kMaxSysex) {
      inside_ = Inside::long_sysex;
    } else if (inside_ != Inside::long_sysex) {
      data_.push_back(byte);
      if (inside_ == Inside::short_message && data_.size() == 2) {
        inside_ = Inside::nothing;
        if (status_ == kVersion)
          event(VersionReport{ .major = data_[0], .minor = data_[1] });
      }
    }
  }
}

void
Decoder::end_sysex(const std::function<void(const Event &)> &event)
{
  std::optional<Event> report;
  const Data data = Data(data_).subspan(std::min<std::size_t>(data_.size(), 1));
  switch (data_.empty() ? 0u : data_[0]) {
  case kFirmware:
    report = firmware_report(data);
    break;
  case kCapabilityReport:
    report = capability_report(data);
    break;
  default:
    return;
  }
  if (report)
    event(*report);
  else
    damaged_++;
}

} // namespace tactor::firmata
