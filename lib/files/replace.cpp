// SPDX-License-Identifier: LGPL-2.1-or-later
#include "files/replace.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace fs = std::filesystem;

namespace files {

std::string
target_of(const std::string &path)
{
  std::error_code error;
  if (!fs::is_symlink(path, error))
    return path;
  const fs::path target = fs::canonical(path, error);
  return error ? path : target.string();
}

std::string
folder_of(const std::string &path)
{
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

bool
sync_folder(const std::string &path)
{
  const File folder(open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some folders can be written to but not read, and some file systems cannot do that.
  return folder ? fsync(folder.descriptor()) == 0 || errno == EINVAL : errno == EACCES;
}

tl::expected<bool, Error>
replace(const File &part, const std::string &part_path, const std::string &path, Readers readers)
{
  if (const auto expected = expect_regular(path); !expected)
    return tl::unexpected(expected.error());
  struct stat before
  {
  };
  const bool keeps_mode = readers == Readers::user || stat(path.c_str(), &before) != 0
                          || fchmod(part.descriptor(), before.st_mode & 07777) == 0
                          || errno == EPERM; // FAT has no permissions
  if (!keeps_mode || fsync(part.descriptor()) != 0
      || std::rename(part_path.c_str(), path.c_str()) != 0)
    return tl::unexpected(Error{ errno, std::generic_category().message(errno) });
  return sync_folder(path);
}

} // namespace files
