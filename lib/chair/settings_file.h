// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair/settings.h"

#include <memory>
#include <string>
#include <vector>

#include <glib.h>
#include <tl/expected.hpp>

namespace chair {

/// The section of all programs.
inline constexpr const char *kEveryProgram = "chair";

/// $XDG_CONFIG_HOME/visuotactile/chair.conf
std::string settings_path();

/// The user's key file: [chair] for all programs, and a section for each program.
class SettingsFile
{
public:
  /// A file that does not exist is empty. One of over a MiB or with a line that is none of a key
  /// file is an error, in one line with the path.
  static tl::expected<SettingsFile, std::string> load(const std::string &path = settings_path());

  /// As load(), and no other program changes the file until this object is gone. Makes the folder.
  static tl::expected<SettingsFile, std::string> load_to_change(const std::string &path
                                                                = settings_path());

  /// Sections in the order of the file.
  std::vector<std::string> sections() const;

  /// Valid values; adds a line to `complaints` for each other.
  Values values(const std::string &section, std::vector<std::string> &complaints) const;

  /// `value` must be one that the key takes. Comments and other keys are kept.
  void set(const std::string &section, const std::string &key, const std::string &value);

  /// Whether it was set. The last key takes its section with it.
  bool unset(const std::string &section, const std::string &key);

  /// Makes a device that of [chair]. Grid, mapping and calibration of the former one are kept for
  /// it, and those of this one are back. `device` may be empty: the driver's usual one.
  void use(const std::string &driver, const std::string &device);

  /// Writes atomically, and makes the folder. An error is one line with the path.
  tl::expected<void, std::string> save() const;

private:
  explicit SettingsFile(std::string path);
  void move_keys(const std::string &from, const std::string &to);

  std::string path_;
  std::unique_ptr<GKeyFile, void (*)(GKeyFile *)> file_;
  std::shared_ptr<const int> lock_; ///< descriptor of the locked folder
};

/// Makes the folder of the file: a change in a folder that was made later is noticed late. False
/// with an errno.
bool make_settings_folder(const std::string &path = settings_path());

/// Whether a program may have a section of that name.
bool is_program_name(const std::string &name);

} // namespace chair
