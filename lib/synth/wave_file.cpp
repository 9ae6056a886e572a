// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/wave_file.h"

#include "files/regular_file.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace synth {

namespace {

using Bytes = std::span<const std::byte>;
using Error = tl::unexpected<std::string>;

constexpr std::uint32_t kLongestSeconds = 10;
constexpr std::uint32_t kHighestRate = 192'000;
/// Ten seconds of floats at the highest rate, and a megabyte for chunks that are not read.
constexpr std::size_t kMostBytes = std::size_t{ kLongestSeconds } * kHighestRate * 4 + 1'048'576;

constexpr unsigned kIntegers = 1;
constexpr unsigned kFloats = 3;

/// A little-endian number of `size` bytes at an offset that the caller has checked.
std::uint32_t
number(Bytes data, std::size_t offset, std::size_t size)
{
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; i++)
    value |= std::to_integer<std::uint32_t>(data[offset + i]) << (8 * i);
  return value;
}

bool
has_name(Bytes data, std::size_t offset, std::string_view name)
{
  for (std::size_t i = 0; i < name.size(); i++)
    if (offset + i >= data.size() || std::to_integer<char>(data[offset + i]) != name[i])
      return false;
  return true;
}

/// The content of a chunk, as much as there is of it.
std::optional<Bytes>
chunk(Bytes data, std::string_view name)
{
  for (std::size_t offset = 12; offset + 8 <= data.size();) {
    const std::size_t size = number(data, offset + 4, 4);
    const Bytes rest = data.subspan(offset + 8);
    if (has_name(data, offset, name))
      return rest.first(std::min(size, rest.size()));
    offset += 8 + size + size % 2;
  }
  return std::nullopt;
}

} // namespace

tl::expected<std::shared_ptr<const Wave>, std::string>
parse_wave_file(Bytes data)
{
  if (!has_name(data, 0, "RIFF") || !has_name(data, 8, "WAVE"))
    return Error("expected a RIFF WAVE file, got something else");
  const std::optional<Bytes> format = chunk(data, "fmt ");
  const std::optional<Bytes> sound = chunk(data, "data");
  if (!format || format->size() < 16 || !sound)
    return Error("expected the chunks 'fmt ' and 'data', found not both");
  const unsigned kind = number(*format, 0, 2);
  const unsigned channels = number(*format, 2, 2);
  const std::uint32_t rate = number(*format, 4, 4);
  const unsigned bits = number(*format, 14, 2);
  if (channels != 1)
    return Error("expected one channel, got " + std::to_string(channels));
  if (!(kind == kIntegers && bits == 16) && !(kind == kFloats && bits == 32))
    return Error("expected 16 bit integers (format 1) or 32 bit floats (format 3), got "
                 + std::to_string(bits) + " bits of format " + std::to_string(kind));
  if (rate < 1000 || rate > kHighestRate)
    return Error("expected a rate of 1000 to " + std::to_string(kHighestRate) + " Hz, got "
                 + std::to_string(rate));
  const std::size_t size = bits / 8;
  const std::size_t count = sound->size() / size;
  if (count < 2 || count > std::size_t{ kLongestSeconds } * rate)
    return Error("expected 2 to " + std::to_string(kLongestSeconds * rate) + " samples, got "
                 + std::to_string(count));
  std::vector<float> round;
  round.reserve(count + 1);
  for (std::size_t i = 0; i < count; i++) {
    const std::uint32_t value = number(*sound, i * size, size);
    round.push_back(kind == kFloats ? std::bit_cast<float>(value)
                                    : static_cast<float>(static_cast<std::int16_t>(value)) / 32768);
  }
  return std::make_shared<const Wave>(static_cast<double>(rate) / static_cast<double>(count),
                                      std::move(round));
}

tl::expected<std::shared_ptr<const Wave>, std::string>
read_wave_file(const std::string &path)
{
  const auto refused = [&](const std::string &why) {
    return Error("cannot read the loop '" + path + "': " + why);
  };
  const tl::expected<std::string, files::Error> data = files::read(path, kMostBytes);
  if (!data)
    return refused(data.error().reason);
  auto wave = parse_wave_file(std::as_bytes(std::span(*data)));
  return wave ? wave : refused(wave.error());
}

} // namespace synth
