// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <initializer_list>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

/// Like ck_assert_str_eq(), which would read a temporary string after its end.
inline void
assert_text(const std::string &text, const std::string &expected)
{
  fail_unless(text == expected, "expected '%s', got '%s'", expected.c_str(), text.c_str());
}

inline void
assert_contains(const std::string &text, std::initializer_list<const char *> parts)
{
  for (const char *part : parts)
    fail_unless(text.find(part) != std::string::npos, "no '%s' in: %s", part, text.c_str());
}
