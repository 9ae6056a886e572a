// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

#include <array>

/// The options that every command of every program takes: `-f` and `-q`, of which each says what
/// they mean to it.
struct Manner
{
  static constexpr const char *kWritesAnyway
      = "Write anew what is there already, as it does anyway";
  static constexpr const char *kSaysOnlyFaults = "Say only what goes wrong";

  gboolean force = FALSE;
  gboolean quiet = FALSE;

  /// For GOptionContext, ended by an empty one; the object has to outlive the parsing.
  std::array<GOptionEntry, 3> entries(const char *force_means, const char *quiet_means)
  {
    return { { { "force", 'f', 0, G_OPTION_ARG_NONE, &force, force_means, nullptr },
               { "quiet", 'q', 0, G_OPTION_ARG_NONE, &quiet, quiet_means, nullptr },
               {} } };
  }
};
