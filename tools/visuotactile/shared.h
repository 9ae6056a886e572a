// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair/settings.h"

#include <functional>
#include <string>
#include <vector>

/// The window as its pages know it.
struct Shared
{
  /// Whether a command worked.
  using Done = std::function<void(bool worked)>;

  /// Runs a command that changes something, after those before it, and shows its complaint. Then
  /// `done`, if any.
  std::function<void(std::vector<std::string> arguments, Done done)> change;
  /// Shows an error, or nothing if that is empty.
  std::function<void(const std::string &)> complain;
  /// Shows what the chair does now.
  std::function<void()> show_state;
};

/// The user's setting of all programs, or that.
inline std::string
setting(const chair::Settings &settings, const char *key, const char *otherwise)
{
  const auto found = settings.values.find(key);
  return found == settings.values.end() ? otherwise : found->second;
}
