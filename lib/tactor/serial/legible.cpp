// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/legible.h"

#include <cstddef>
#include <cstdint>

namespace tactor {

namespace {

constexpr std::size_t kMostCharacters = 126;
constexpr std::string_view kReplacement = "\xef\xbf\xbd";
constexpr std::string_view kSpace(" \t\r\n\v\f\0", 7);

/// Length in bytes of the first character; 0 if it is invalid (RFC 3629) or a control character.
std::size_t
character(std::string_view text)
{
  const auto byte = [&](std::size_t i) -> std::uint32_t {
    return static_cast<std::uint8_t>(text[i]);
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80)
    return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  constexpr std::uint32_t smallest[]
      = { 0, 0, 0xa0, 0x800, 0x10000 }; // U+0080…9F are control characters
  if (first < 0xc2 || first > 0xf4 || text.size() < length)
    return 0;
  std::uint32_t code = first & (0x7fU >> length);
  for (std::size_t i = 1; i < length; i++) {
    if ((byte(i) & 0xc0) != 0x80)
      return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return code >= smallest[length] && code <= 0x10ffff && !surrogate ? length : 0;
}

} // namespace

std::string
legible(std::string_view text)
{
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos)
    return {};
  text = text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
  std::string result;
  for (std::size_t count = 0; count < kMostCharacters && !text.empty(); count++) {
    const std::size_t length = character(text);
    result += length > 0 ? text.substr(0, length) : kReplacement;
    text.remove_prefix(length > 0 ? length : 1);
  }
  // The cut may have left white space at the end.
  result.erase(result.find_last_not_of(kSpace) + 1);
  return result;
}

} // namespace tactor
