// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace usb_test {

/// snprintf() to a string of at most 255 characters.
std::string
format(const char *pattern, auto... values)
{
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

inline std::string
hex(std::span<const std::uint8_t> bytes)
{
  std::string text;
  for (const std::uint8_t byte : bytes)
    text += format("%02x", byte);
  return text;
}

inline std::string
hex(const std::string &text)
{
  return hex(std::span(reinterpret_cast<const std::uint8_t *>(text.data()), text.size()));
}

} // namespace usb_test
