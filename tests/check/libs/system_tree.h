// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/system_roots.h"

#include "support/temporary_file.h"

#include <filesystem>
#include <fstream>
#include <string>

/// A fake of what the kernel and udev report, in a temporary folder.
class SystemTree
{
public:
  SystemTree()
      : roots{ .sys = path / "sys",
               .proc = path / "proc",
               .locks = path / "lock",
               .udev_data = path / "udev",
               .rules = { path / "etc", path / "usr" } }
  {
  }

  /// Writes a file of the tree.
  void write(const std::filesystem::path &file, const std::string &text) const
  {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  void link(const std::filesystem::path &target, const std::filesystem::path &link) const
  {
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::create_symlink(target, link);
  }

private:
  const TemporaryFolder folder_;

public:
  const std::filesystem::path path = folder_.path;
  tactor::SystemRoots roots;
};
