// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

// After the standard library's headers: gstcheck.h defines a macro named fail.
#include <gst/check/gstcheck.h>

/// A file of its own, gone with the object.
class TemporaryFile
{
public:
  /// With this text in it, and a name that ends on `suffix`.
  explicit TemporaryFile(const std::string &text = "", const std::string &suffix = "")
      : path("/tmp/visuotactile-XXXXXX" + suffix)
  {
    const int fd = mkstemps(path.data(), static_cast<int>(suffix.size()));
    fail_unless(fd >= 0);
    close(fd);
    std::ofstream(path) << text;
  }
  ~TemporaryFile()
  {
    unlink(path.c_str());
  }
  TemporaryFile(const TemporaryFile &) = delete;
  TemporaryFile &operator=(const TemporaryFile &) = delete;

  std::string path;
};

/// A folder of its own, gone with the object and with all that is in it.
class TemporaryFolder
{
public:
  TemporaryFolder() : path("/tmp/visuotactile-XXXXXX")
  {
    fail_unless(mkdtemp(path.data()) != nullptr);
  }
  ~TemporaryFolder()
  {
    std::filesystem::remove_all(path);
  }
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;

  std::string file(const char *name) const
  {
    return path + "/" + name;
  }
  /// With these bytes in it.
  std::string file(const char *name, const std::string &bytes) const
  {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }

  std::string path;
};
