// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/temporary_file.h"

#include <cstdlib>
#include <filesystem>
#include <string>

/// A user's settings, in a folder of their own. One per process: GLib reads the variable once.
class SettingsHome
{
public:
  SettingsHome()
  {
    setenv("XDG_CONFIG_HOME", folder_.path.c_str(), 1);
  }
  /// Replaces the file as editors do.
  void write(const std::string &text) const
  {
    std::filesystem::create_directories(folder_.path + "/visuotactile");
    std::filesystem::rename(folder_.file("new", text), path());
  }
  std::string path() const
  {
    return folder_.path + "/visuotactile/chair.conf";
  }

private:
  TemporaryFolder folder_;
};
