// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libintl.h>

#include <string>

/// Texts in the user's language, from po/. Sets no other part of the locale.
void use_translations();

/// The translation of a literal.
inline const char *
_(const char *text)
{
  return dgettext(PACKAGE, text);
}

/// The translation of a literal with `{}` in the place of `value`.
std::string in_text(const char *text, const std::string &value);

/// Marks a literal that is translated later.
#define N_(text) text
