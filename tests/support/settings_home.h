// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

/// A user's settings, in a folder of their own: none at the beginning of a test.
class SettingsHome
{
public:
  SettingsHome()
  {
    std::filesystem::remove_all(kFolder.path + "/visuotactile");
  }
  SettingsHome(const SettingsHome &) = delete;
  SettingsHome &operator=(const SettingsHome &) = delete;

  /// Replaces the file as editors do.
  void write(const std::string &text) const
  {
    std::filesystem::create_directories(kFolder.path + "/visuotactile");
    const std::string part = kFolder.path + "/part";
    std::ofstream(part, std::ios::binary) << text;
    std::filesystem::rename(part, path());
  }
  std::string path() const
  {
    return kFolder.path + "/visuotactile/chair.conf";
  }

private:
  /// Made before main(): GLib reads the variable once, and a scan of the plugins needs it.
  struct Folder
  {
    std::string path = "/tmp/visuotactile-XXXXXX";

    Folder()
    {
      if (mkdtemp(path.data()) == nullptr || setenv("XDG_CONFIG_HOME", path.c_str(), 1) != 0)
        std::abort();
    }
    ~Folder()
    {
      std::error_code none;
      std::filesystem::remove_all(path, none);
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;
  };
  static inline const Folder kFolder;
};
