// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/files.h"

#include <string>
#include <string_view>
#include <vector>

namespace desk {

/// A file of edits that are not yet saved: a line with the text that they are for, then one for
/// each. When append() returns, the edit is on the disk. Not thread-safe; one process has it.
class Journal
{
public:
  /// Makes the file if it is not there. Fails if another process has it.
  static tl::expected<Journal, std::string> open(const std::string &path);

  struct Content
  {
    std::string base;               ///< the text
    std::vector<std::string> edits; ///< complete lines
    bool damaged = false;           ///< it is none of ours, or too large for one
  };
  /// Its content. An unfinished last line, which was never answered, is left out; the next append()
  /// cuts it off.
  tl::expected<Content, std::string> read();

  /// Adds an edit, after `base` if it is the first. Without room, on the disk or below 1 GiB,
  /// nothing has changed.
  tl::expected<void, std::string> append(std::string_view base, std::string_view edit);

  /// Without edits from now on.
  tl::expected<void, std::string> clear();

  /// Removes the file.
  void remove();
  /// Keeps the file under another name, and makes a new one. Returns the name.
  tl::expected<std::string, std::string> set_aside();

  bool is_empty() const
  {
    return size_ == 0;
  }

private:
  Journal(File file, std::string path) : file_(std::move(file)), path_(std::move(path))
  {
  }

  File file_;
  std::string path_;
  std::size_t size_ = 0; ///< of what counts
};

} // namespace desk
