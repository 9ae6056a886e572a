// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>

/// A file that appears under its name when it is complete. Until commit() it is written to a part
/// file in the same folder, and an existing file is kept. Without commit() the part is removed. A
/// link stays one: the file that it leads to is written.
class Output
{
public:
  /// Throws std::runtime_error if a folder has the name.
  Output(const std::filesystem::path &directory, const std::string &name);
  ~Output();
  Output(const Output &) = delete;
  Output &operator=(const Output &) = delete;

  const std::filesystem::path &final_path() const
  {
    return final_;
  }

  /// The part file.
  const std::filesystem::path &part_path() const
  {
    return part_;
  }

  /// Renames the part if anything was written, which is then on the disk, and returns whether it
  /// was. A file that is replaced keeps its permissions. Throws std::runtime_error if the file
  /// cannot have its name.
  bool commit();

private:
  std::filesystem::path final_;
  std::filesystem::path part_;
};

/// Makes the folder if it does not exist. Throws std::runtime_error if it cannot be written to.
void prepare_directory(const std::filesystem::path &directory);
