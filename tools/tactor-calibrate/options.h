// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "calibration/envelope.h"

#include "../manner.h"
#include "player.h"

#include <glib.h>

#include <array>
#include <string>
#include <vector>

/// A string option, freed with the object.
struct TextOption
{
  gchar *value = nullptr;

  TextOption() = default;
  explicit TextOption(const char *text) : value(g_strdup(text))
  {
  }
  ~TextOption()
  {
    g_free(value);
  }
  TextOption(const TextOption &) = delete;
  TextOption &operator=(const TextOption &) = delete;

  bool is_set() const
  {
    return value != nullptr;
  }
  std::string text() const
  {
    return value ? value : "";
  }
};

/// Which board is driven and what hears it: options that measure and check share.
struct PlayOptions
{
  TextOption driver{ "auto" };
  TextOption device{};
  TextOption source{ "autoaudiosrc" };
  TextOption simulated_motors{};

  std::vector<GOptionEntry> entries();
  PlayerSettings settings(double volts_max) const;
};

/// Reads a command's arguments; what is left goes to `arguments`. False, and the reason on standard
/// error, if they are wrong.
bool parse_options(int argc, char **argv, const char *arguments_name, const char *summary,
                   std::vector<GOptionEntry> entries, const std::array<GOptionEntry, 3> &manner,
                   std::vector<std::string> &arguments);

/// `0,2,5` or `0-8`. Throws std::runtime_error with what was expected and what came.
std::vector<int> parse_tactors(const std::string &text);

/// `LOW:HIGH` in Hz; {0, 0} for an empty text. Throws as above.
tactor::Band parse_band(const std::string &text);

/// True from the moment at which the user wants to stop (SIGINT, SIGTERM).
const std::atomic<bool> &interruption();
