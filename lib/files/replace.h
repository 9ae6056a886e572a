// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "files/regular_file.h"

#include <string>

/// The one place that puts a complete file in the place of another.
namespace files {

/// The file that is replaced under a name: of a link the file that it leads to, so that the link
/// stays one.
std::string target_of(const std::string &path);

/// A file's folder; "." where the path has none.
std::string folder_of(const std::string &path);

/// Writes to the disk that a file of this name is there. False, with errno, if it fails; true where
/// a folder cannot be written.
bool sync_folder(const std::string &path);

/// Readers of a file that replaces another one.
enum class Readers
{
  as_before, ///< of the file that it replaces; else as the umask has it
  user,      ///< the user alone
};

/// Renames a complete file, which is in the same folder, once it is on the disk. Its permissions
/// are changed for Readers::as_before, where files have some. Only a regular file is replaced.
/// Returns whether the folder was written to the disk, too; errno has the reason if not.
tl::expected<bool, Error> replace(const File &part, const std::string &part_path,
                                  const std::string &path, Readers readers = Readers::as_before);

} // namespace files
