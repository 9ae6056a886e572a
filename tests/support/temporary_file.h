// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

/// A temporary file, removed with the object.
class TemporaryFile
{
public:
  /// Contains `text`. Its name ends in `suffix`.
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

/// A temporary folder, removed with the object and all content.
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
  /// Writes a file with these bytes.
  std::string file(const char *name, const std::string &bytes) const
  {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }

  std::string path;
};
