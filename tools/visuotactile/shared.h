// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair/settings_file.h"

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
  /// Calls soon, when no change waits.
  std::function<void(std::function<void()>)> when_changed;
  /// Shows the error of a change, or nothing if that is empty.
  std::function<void(const std::string &)> complain;
  /// Likewise of motors that ran: it stays until they have run without one.
  std::function<void(const std::string &)> report;
  /// Shows what the chair does now.
  std::function<void()> show_state;
};

/// The user's settings of all programs.
inline chair::Values
chair_values()
{
  std::vector<std::string> complaints; // printed by `visuotactile-settings list`
  const auto file = chair::SettingsFile::load();
  return file ? file->values(chair::kEveryProgram, complaints) : chair::Values();
}

/// A setting, or that.
inline std::string
setting(const chair::Values &values, const char *key, const char *otherwise)
{
  const auto found = values.find(key);
  return found == values.end() ? otherwise : found->second;
}
