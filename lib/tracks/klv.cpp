// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/klv.h"

#include "tracks/track.h"

#include <algorithm>
#include <bit>
#include <string>
#include <string_view>
#include <utility>

namespace tactile {

namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kTunedVersion = 2; ///< with a frequency
constexpr std::size_t kHeader = 11;       ///< of the value: version, rows, columns, duration

void
append_big_endian(std::vector<std::uint8_t> &bytes, std::uint64_t value, int size)
{
  for (int i = size - 1; i >= 0; i--)
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Reads a packet from its start. Missing bytes read as zero and set an error.
class Reader
{
public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes)
  {
  }

  std::uint64_t take(std::size_t size)
  {
    if (left() < size) {
      expect(false, at_, "the packet ends too early");
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; i++)
      value = value << 8 | bytes_[at_++];
    return value;
  }

  std::size_t take_ber_length()
  {
    const std::uint64_t first = take(1);
    if (first < 0x80)
      return static_cast<std::size_t>(first);
    if (first == 0x80 || first > 0x88) {
      expect(false, at_ - 1, "expected a BER length of at most 8 bytes");
      return 0;
    }
    return static_cast<std::size_t>(take(static_cast<std::size_t>(first & 0x7f)));
  }

  void expect(bool holds, std::size_t byte, std::string_view reason)
  {
    if (!holds)
      error_.set(FormatError::at_byte(byte, std::string(reason)));
  }

  /// The cue, or the first error.
  tl::expected<Cue, FormatError> finish(Cue cue = {})
  {
    return std::move(error_).unless_set(std::move(cue));
  }

  bool failed() const
  {
    return static_cast<bool>(error_);
  }
  std::size_t at() const
  {
    return at_;
  }
  std::size_t left() const
  {
    return bytes_.size() - at_;
  }

private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  FirstError error_;
};

} // namespace

std::vector<std::uint8_t>
write_klv(const TactileMap &map, Time duration)
{
  std::vector<std::uint8_t> bytes(kKlvKey.begin(), kKlvKey.end());
  const bool tuned = map.frequency > 0;
  const std::size_t length = kHeader + 4 * (map.levels.size() + (tuned ? 1 : 0));
  if (length < 0x80) {
    bytes.push_back(static_cast<std::uint8_t>(length));
  } else {
    bytes.push_back(0x82);
    append_big_endian(bytes, length, 2);
  }
  bytes.push_back(tuned ? kTunedVersion : kVersion);
  bytes.push_back(static_cast<std::uint8_t>(map.rows));
  bytes.push_back(static_cast<std::uint8_t>(map.columns));
  append_big_endian(bytes, static_cast<std::uint64_t>(std::max(duration.count(), Time::rep{ 0 })),
                    8);
  for (const float level : map.levels)
    append_big_endian(bytes, std::bit_cast<std::uint32_t>(level), 4);
  if (tuned)
    append_big_endian(bytes, std::bit_cast<std::uint32_t>(map.frequency), 4);
  return bytes;
}

tl::expected<Cue, FormatError>
read_klv(std::span<const std::uint8_t> bytes)
{
  if (bytes.size() < kKlvKey.size() || !std::ranges::equal(bytes.first(kKlvKey.size()), kKlvKey))
    return tl::unexpected(FormatError::at_byte(0, "this is no tactile map: another key"));
  Reader reader(bytes);
  reader.take(8);
  reader.take(8);
  const std::size_t length = reader.take_ber_length();
  const std::size_t begin = reader.at();
  reader.expect(length == reader.left(), begin,
                "expected a value of " + std::to_string(length) + " bytes, got "
                    + std::to_string(reader.left()));
  const std::uint64_t version = reader.take(1);
  const bool tuned = version == kTunedVersion;
  reader.expect(version == kVersion || tuned, begin, "expected version 1 or 2");
  const auto rows = static_cast<int>(reader.take(1));
  const auto columns = static_cast<int>(reader.take(1));
  reader.expect(rows >= kMinGridSide && rows <= kMaxGridSide && columns >= kMinGridSide
                    && columns <= kMaxGridSide,
                begin + 1, "expected 1 to 64 rows and columns");
  const std::uint64_t duration = reader.take(8);
  reader.expect(duration <= static_cast<std::uint64_t>(Track::kMaxEnd.count()), begin + 3,
                "expected a duration of at most 100 hours");
  if (reader.failed())
    return reader.finish();
  Cue cue{ .end = Time(static_cast<Time::rep>(duration)), .map = TactileMap(rows, columns) };
  reader.expect(reader.left() == 4 * (cue.map.levels.size() + (tuned ? 1 : 0)), reader.at(),
                "expected " + std::to_string(cue.map.levels.size()) + " levels");
  for (float &level : cue.map.levels) {
    level = std::bit_cast<float>(static_cast<std::uint32_t>(reader.take(4)));
    reader.expect(level >= 0 && level <= 1, reader.at() - 4, "expected a level from 0 to 1");
  }
  if (tuned) {
    cue.map.frequency = std::bit_cast<float>(static_cast<std::uint32_t>(reader.take(4)));
    reader.expect(cue.map.frequency >= 1 && cue.map.frequency <= kHighestFrequency, reader.at() - 4,
                  "expected a frequency from 1 to 1000 Hz");
  }
  return reader.finish(std::move(cue));
}

} // namespace tactile
