// SPDX-License-Identifier: LGPL-2.1-or-later
#include "house/translation.h"

#include <glib.h>

#include <clocale>

void
use_translations()
{
  const char *folder = g_getenv("VISUOTACTILE_LOCALE"); // of a build that is not installed
  std::setlocale(LC_CTYPE, "");
  std::setlocale(LC_MESSAGES, "");
  bindtextdomain(PACKAGE, folder != nullptr ? folder : LOCALE_DIR);
  bind_textdomain_codeset(PACKAGE, "UTF-8");
}

std::string
in_text(const char *text, const std::string &value)
{
  std::string whole = _(text);
  if (const std::size_t at = whole.find("{}"); at != std::string::npos)
    whole.replace(at, 2, value);
  return whole;
}
