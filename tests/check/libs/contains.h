// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <initializer_list>
#include <string>

// After the standard library's headers: gstcheck.h defines a macro named fail.
#include <gst/check/gstcheck.h>

inline void
assert_contains(const std::string &text, std::initializer_list<const char *> parts)
{
  for (const char *part : parts)
    fail_unless(text.find(part) != std::string::npos, "no '%s' in: %s", part, text.c_str());
}
