// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Texts in the user's language, from po/, where the program has chosen it: see parse_options().
#pragma once

#include <libintl.h>

#include <string>
#include <string_view>

/// Marks a literal that is translated later.
#define N_(text) text

/// The translation of a literal.
[[gnu::format_arg(1)]] inline const char *
_(const char *text)
{
  return dgettext(PACKAGE, text);
}

/// The translation of a literal with the values in the places of its `{}`, in order.
template <typename... Values>
std::string
in_text(const char *text, const Values &...values)
{
  std::string whole = _(text);
  std::size_t at = 0;
  for (const std::string_view value : { std::string_view(values)... })
    if ((at = whole.find("{}", at)) != std::string::npos) {
      whole.replace(at, 2, value);
      at += value.size();
    }
  return whole;
}
