// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/utf16.h"

#include <cstdint>

namespace tactile {

namespace {

constexpr char32_t kNoCharacter = 0xfffd;

void
append(std::string &text, char32_t c)
{
  const auto continued = [&](int shift) {
    text += static_cast<char>(0x80U | ((c >> shift) & 0x3fU));
  };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xc0U | (c >> 6));
    continued(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xe0U | (c >> 12));
    continued(6);
    continued(0);
  } else {
    text += static_cast<char>(0xf0U | (c >> 18));
    continued(12);
    continued(6);
    continued(0);
  }
}

bool
is_high(char32_t unit)
{
  return unit >= 0xd800 && unit < 0xdc00;
}

bool
is_low(char32_t unit)
{
  return unit >= 0xdc00 && unit < 0xe000;
}

} // namespace

std::string
as_utf8(std::string text)
{
  const auto byte = [&](std::size_t i) -> char32_t {
    return static_cast<std::uint8_t>(text[i]);
  };
  if (text.size() < 2)
    return text;
  const bool is_marked_little = byte(0) == 0xff && byte(1) == 0xfe;
  const bool is_little = is_marked_little || (byte(0) != 0 && byte(0) < 0x80 && byte(1) == 0);
  const bool is_marked_big = byte(0) == 0xfe && byte(1) == 0xff;
  const bool is_big = is_marked_big || (byte(0) == 0 && byte(1) != 0 && byte(1) < 0x80);
  if (!is_little && !is_big)
    return text;
  const auto unit = [&](std::size_t i) {
    return is_little ? byte(i) | byte(i + 1) << 8 : byte(i) << 8 | byte(i + 1);
  };
  std::string utf8;
  utf8.reserve(text.size());
  std::size_t i = is_marked_little || is_marked_big ? 2 : 0;
  for (; i + 1 < text.size(); i += 2) {
    char32_t c = unit(i);
    if (is_high(c) && i + 3 < text.size() && is_low(unit(i + 2))) {
      c = 0x10000 + ((c - 0xd800) << 10) + (unit(i + 2) - 0xdc00);
      i += 2;
    } else if (is_high(c) || is_low(c)) {
      c = kNoCharacter;
    }
    append(utf8, c);
  }
  if (i < text.size())
    append(utf8, kNoCharacter);
  return utf8;
}

} // namespace tactile
