// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/film_file.h"

#include <optional>

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

struct Box
{
  std::uint64_t name = 0;
  std::size_t size = 0; ///< with its header
  Bytes body;
};

constexpr std::uint64_t
name(const char (&text)[5])
{
  std::uint64_t value = 0;
  for (int i = 0; i < 4; i++)
    value = value << 8 | static_cast<std::uint8_t>(text[i]);
  return value;
}

/// Reads the first box.
std::optional<Box>
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
  return Box{ .name = big_endian(bytes.subspan(4, 4)),
              .size = static_cast<std::size_t>(size),
              .body = bytes.subspan(header, static_cast<std::size_t>(size) - header) };
}

/// Calls `visit` for adjacent boxes, up to the first invalid one.
template <typename Visit>
void
for_each_box(Bytes bytes, Visit visit)
{
  for (std::optional<Box> box = read(bytes); box; box = read(bytes)) {
    bytes = bytes.subspan(box->size);
    visit(*box);
  }
}

/// The first one of a name.
std::optional<Box>
find_box(Bytes bytes, std::uint64_t of)
{
  std::optional<Box> found;
  for_each_box(bytes, [&](const Box &box) {
    if (box.name == of && !found)
      found = box;
  });
  return found;
}

bool
is_tactile(const Box &media)
{
  constexpr std::uint64_t kNone = ('z' - 0x60) << 10 | ('x' - 0x60) << 5 | ('x' - 0x60);
  const std::optional<Box> header = find_box(media.body, name("mdhd"));
  const std::optional<Box> handler = find_box(media.body, name("hdlr"));
  if (!header || header->body.empty() || !handler || handler->body.size() < 12)
    return false;
  const std::size_t language = header->body[0] == 1 ? 32 : 20; // depends on the version
  const std::uint64_t kind = big_endian(handler->body.subspan(8, 4));
  return header->body.size() >= language + 2
         && big_endian(header->body.subspan(language, 2)) == kNone
         && (kind == name("text") || kind == name("sbtl") || kind == name("subt"));
}

bool
disable_by_default(const Box &track)
{
  const std::optional<Box> header = find_box(track.body, name("tkhd"));
  const std::optional<Box> media = find_box(track.body, name("mdia"));
  if (!header || header->body.size() < 4 || !media || !is_tactile(*media))
    return false;
  header->body[3] &= 0xfe; // lowest of the 24 flag bits that follow the version
  return true;
}

} // namespace

std::size_t
disable_by_default(std::span<std::uint8_t> file)
{
  const std::optional<Box> movie = find_box(file, name("moov"));
  std::size_t count = 0;
  if (movie)
    for_each_box(movie->body, [&](const Box &track) {
      count += track.name == name("trak") && disable_by_default(track);
    });
  return count;
}

} // namespace tactile
