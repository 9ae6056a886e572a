// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>

/// A file that appears under its name only when it is complete: until commit() it is written beside
/// it, and what was there before stays. Without commit() the part is removed.
class Output
{
public:
  /// Throws std::runtime_error in one line if something else than a file has the name.
  Output(const std::filesystem::path &directory, const std::string &name);
  ~Output();
  Output(const Output &) = delete;
  Output &operator=(const Output &) = delete;

  const std::filesystem::path &final_path() const
  {
    return final_;
  }

  /// Where to write meanwhile.
  const std::filesystem::path &part_path() const
  {
    return part_;
  }

  /// Gives the file its name if anything was written. Returns whether anything was; throws
  /// std::runtime_error in one line if it can't have that name.
  bool commit();

private:
  std::filesystem::path final_;
  std::filesystem::path part_;
};

/// Makes the folder if need be. Throws std::runtime_error in one line if it can't be written to.
void prepare_directory(const std::filesystem::path &directory);
