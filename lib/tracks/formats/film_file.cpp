// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/film_file.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string_view>

namespace tactile {

namespace {

using Bytes = std::span<std::uint8_t>;

std::uint64_t
big_endian(std::span<const std::uint8_t> bytes)
{
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes)
    value = value << 8 | byte;
  return value;
}

/// An EBML element or an MP4 box.
struct Part
{
  std::uint64_t id = 0;
  Bytes header; ///< id and size
  Bytes body;
};

/// Calls `visit` for adjacent parts in `bytes`, up to the first invalid one or until it returns
/// false.
template <typename Read, typename Visit>
void
for_each_part(Bytes bytes, Read read, Visit visit)
{
  for (std::optional<Part> part = read(bytes); part; part = read(bytes)) {
    bytes = bytes.subspan(part->header.size() + part->body.size());
    if (!visit(*part))
      break;
  }
}

template <typename Read>
std::optional<Part>
find_part(Bytes bytes, Read read, std::uint64_t id)
{
  std::optional<Part> found;
  for_each_part(bytes, read, [&](const Part &part) {
    if (part.id == id)
      found = part;
    return !found;
  });
  return found;
}

/* ---- Matroska ---- */

namespace ebml {

constexpr std::uint64_t kHeader = 0x1a45dfa3;
constexpr std::uint64_t kSegment = 0x18538067;
constexpr std::uint64_t kTracks = 0x1654ae6b;
constexpr std::uint64_t kTrackEntry = 0xae;
constexpr std::uint64_t kTrackType = 0x83;
constexpr std::uint64_t kLanguage = 0x22b59c;
constexpr std::uint64_t kFlagDefault = 0x88;
constexpr std::uint64_t kSubtitles = 0x11;

/// FlagDefault = 0, with a value of one byte.
constexpr std::uint8_t kNotDefault[] = { 0x88, 0x81, 0x00 };

/// Reads the first element. An element of unknown size, which is legal for a Segment but not in
/// Tracks, extends to the end; it is accepted only if `may_be_open`.
std::optional<Part>
read_element(Bytes bytes, bool may_be_open)
{
  if (bytes.empty())
    return std::nullopt;
  const auto id_width = static_cast<std::size_t>(std::countl_zero(bytes[0])) + 1;
  if (id_width > 4 || bytes.size() <= id_width)
    return std::nullopt;
  const auto size_width = static_cast<std::size_t>(std::countl_zero(bytes[id_width])) + 1;
  const std::size_t header = id_width + size_width;
  if (size_width > 8 || bytes.size() < header)
    return std::nullopt;
  const std::uint64_t most = (std::uint64_t{ 1 } << 7 * size_width) - 1; // all ones: unknown size
  const std::uint64_t size = big_endian(bytes.subspan(id_width, size_width)) & most;
  const Bytes rest = bytes.subspan(header);
  if (size == most ? !may_be_open : size > rest.size())
    return std::nullopt;
  return Part{ .id = big_endian(bytes.first(id_width)),
               .header = bytes.first(header),
               .body = size == most ? rest : rest.first(static_cast<std::size_t>(size)) };
}

std::optional<Part>
read(Bytes bytes)
{
  return read_element(bytes, false);
}

std::optional<Part>
read_open(Bytes bytes)
{
  return read_element(bytes, true);
}

/// Whether the track consists of elements up to its end: after garbage the flag would not be found.
bool
is_whole(const Part &track)
{
  std::size_t size = 0;
  for_each_part(track.body, read, [&](const Part &part) {
    size += part.header.size() + part.body.size();
    return true;
  });
  return size == track.body.size();
}

bool
is_tactile(const Part &track)
{
  const std::optional<Part> type = find_part(track.body, read, kTrackType);
  const std::optional<Part> language = find_part(track.body, read, kLanguage);
  constexpr std::string_view kNone = "zxx"; // terminated by zeros or by its size
  return type && big_endian(type->body) == kSubtitles && language
         && language->body.size() >= kNone.size()
         && std::ranges::equal(language->body.first(kNone.size()), kNone);
}

/// Shortens the size field by three bytes and appends the flag.
bool
append_flag(const Part &track)
{
  constexpr std::size_t kFlag = sizeof kNotDefault;
  const std::size_t size_width = track.header.size() - 1;
  const std::size_t size = track.body.size() + kFlag;
  if (size_width <= kFlag || size >= (std::uint64_t{ 1 } << 7 * (size_width - kFlag)) - 1)
    return false;
  const std::size_t width = size_width - kFlag;
  for (std::size_t i = 0; i < width; i++)
    track.header[1 + i] = static_cast<std::uint8_t>(size >> 8 * (width - 1 - i));
  track.header[1] |= static_cast<std::uint8_t>(0x80 >> (width - 1));
  const Bytes entry(track.header.data(), track.header.size() + track.body.size());
  std::ranges::copy(track.body, entry.begin() + static_cast<std::ptrdiff_t>(1 + width));
  std::ranges::copy(kNotDefault, entry.end() - kFlag);
  return true;
}

bool
disable_by_default(const Part &track)
{
  const std::optional<Part> flag = find_part(track.body, read, kFlagDefault);
  if (!flag)
    return is_whole(track) && append_flag(track);
  std::ranges::fill(flag->body, 0);
  return !flag->body.empty(); // an empty value means the default, 1
}

std::size_t
disable_by_default(Bytes file)
{
  const std::optional<Part> segment = find_part(file, read_open, kSegment);
  const std::optional<Part> tracks
      = segment ? find_part(segment->body, read, kTracks) : std::nullopt;
  std::size_t count = 0;
  if (tracks)
    for_each_part(tracks->body, read, [&](const Part &track) {
      count += track.id == kTrackEntry && is_tactile(track) && disable_by_default(track);
      return true;
    });
  return count;
}

} // namespace ebml

/* ---- MP4 ---- */

namespace boxes {

constexpr std::uint64_t
name(const char (&text)[5])
{
  std::uint64_t value = 0;
  for (int i = 0; i < 4; i++)
    value = value << 8 | static_cast<std::uint8_t>(text[i]);
  return value;
}

/// Reads the first box.
std::optional<Part>
read(Bytes bytes)
{
  if (bytes.size() < 8)
    return std::nullopt;
  std::uint64_t size = big_endian(bytes.first(4));
  const std::size_t header = size == 1 ? 16 : 8;
  if (bytes.size() < header)
    return std::nullopt;
  if (size == 0)
    size = bytes.size();
  else if (size == 1)
    size = big_endian(bytes.subspan(8, 8));
  if (size < header || size > bytes.size())
    return std::nullopt;
  return Part{ .id = big_endian(bytes.subspan(4, 4)),
               .header = bytes.first(header),
               .body = bytes.subspan(header, static_cast<std::size_t>(size) - header) };
}

bool
is_tactile(const Part &media)
{
  constexpr std::uint64_t kNone = ('z' - 0x60) << 10 | ('x' - 0x60) << 5 | ('x' - 0x60);
  const std::optional<Part> header = find_part(media.body, read, name("mdhd"));
  const std::optional<Part> handler = find_part(media.body, read, name("hdlr"));
  if (!header || header->body.empty() || !handler || handler->body.size() < 12)
    return false;
  const std::size_t language = header->body[0] == 1 ? 32 : 20; // depends on the version
  const std::uint64_t kind = big_endian(handler->body.subspan(8, 4));
  return header->body.size() >= language + 2
         && big_endian(header->body.subspan(language, 2)) == kNone
         && (kind == name("text") || kind == name("sbtl") || kind == name("subt"));
}

bool
disable_by_default(const Part &track)
{
  const std::optional<Part> header = find_part(track.body, read, name("tkhd"));
  const std::optional<Part> media = find_part(track.body, read, name("mdia"));
  if (!header || header->body.size() < 4 || !media || !is_tactile(*media))
    return false;
  header->body[3] &= 0xfe; // lowest of the 24 flag bits that follow the version
  return true;
}

std::size_t
disable_by_default(Bytes file)
{
  const std::optional<Part> movie = find_part(file, read, name("moov"));
  std::size_t count = 0;
  if (movie)
    for_each_part(movie->body, read, [&](const Part &track) {
      count += track.id == name("trak") && disable_by_default(track);
      return true;
    });
  return count;
}

} // namespace boxes

} // namespace

std::size_t
disable_by_default(std::span<std::uint8_t> file)
{
  const std::optional<Part> first = ebml::read(file);
  return first && first->id == ebml::kHeader ? ebml::disable_by_default(file)
                                             : boxes::disable_by_default(file);
}

} // namespace tactile
