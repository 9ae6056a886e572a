// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair/settings.h"
#include "command_line.h"

#include <functional>
#include <string>
#include <vector>

/// The user's settings (visuotactile-settings) as the defaults of a program's options. Options are
/// filled before the command line is read, which then overrides them.
class UserDefaults
{
public:
  /// Without settings: fills nothing.
  UserDefaults() = default;
  /// Reads the settings. Prints a line for each entry that cannot be read or used.
  explicit UserDefaults(const char *program, bool plays_on_shakers = false);

  /// Does nothing if the user has not set `key`. The option must outlive this object.
  void fill(const char *key, TextOption &option);
  void fill(const char *key, gdouble &option);
  void fill(const char *key, gboolean &option);
  /// `device`, `mapping` or `calibration`, which belong to the driver: see keep_to_driver().
  void fill_of_driver(const char *key, TextOption &option);

  /// After the command line: undoes the settings that belong to the user's driver, if `driver` is
  /// another.
  void keep_to_driver(const std::string &driver);
  /// After that: `grid`, which belongs to the driver, too, for sides that are `not_given`.
  void fill_grid(gint &rows, gint &columns, gint not_given);

  /// After the command line: the driver, its reason, and which settings apply.
  std::string text(const std::string &driver) const;
  void print(const std::string &driver) const;

private:
  struct Filled
  {
    std::string key;
    std::string value;
    std::function<bool()> holds;     ///< not overridden
    TextOption *of_driver = nullptr; ///< the option, if it belongs to the driver
  };

  const std::string *find(const char *key) const;

  std::string program_;
  chair::Values values_;
  std::vector<Filled> filled_;
  bool has_own_driver_ = true; ///< the user's
};
