// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "files/whole_file.h"

#include <string>
#include <string_view>
#include <vector>

namespace files {

/// A file that grows by lines: one with a text that they are for, then one for each entry. When
/// append() returns, the entry is on the disk. Not thread-safe; one process has it.
class Journal
{
public:
  /// The journals of a program.
  struct Kind
  {
    std::string_view header; ///< begins the first line, such as "visuotactile desk journal 1 "
    const char *name;        ///< for messages, such as "the journal of edits"
    const char *in_use;      ///< what to do while another process has the file
    const char *if_full;     ///< what to do then
  };
  /// Makes the file if it does not exist. Fails if another process has it open.
  static tl::expected<Journal, std::string> open(const std::string &path, const Kind &kind);

  struct Content
  {
    std::string base;                 ///< the text
    std::vector<std::string> entries; ///< complete lines
    bool damaged = false;             ///< it is none of ours, or too large for one
  };
  /// Reads the content. An unfinished last line, which was never answered, is skipped; the next
  /// append() cuts it off.
  tl::expected<Content, std::string> read();
  /// The content of a file that another process may have.
  static tl::expected<Content, std::string> peek(const std::string &path, const Kind &kind);

  /// Adds an entry, after `base` if it is the first. Without room, on the disk or below 1 GiB,
  /// nothing has changed.
  tl::expected<void, std::string> append(std::string_view base, std::string_view entry);

  /// Without entries from now on.
  tl::expected<void, std::string> clear();

  /// A file with this one entry in its place: either the old one or the new one is on the disk.
  tl::expected<void, std::string> replace(std::string_view base, std::string_view entry);

  /// Removes the file.
  void remove();
  /// Keeps the file under another name, and makes a new one. Returns the name.
  tl::expected<std::string, std::string> set_aside();

  bool is_empty() const
  {
    return size_ == 0;
  }

private:
  std::string header(std::string_view base) const;
  static Content parse(std::string_view bytes, const Kind &kind, std::size_t &size);
  Journal(File file, std::string path, const Kind &kind)
      : file_(std::move(file)), path_(std::move(path)), kind_(kind)
  {
  }

  File file_;
  std::string path_;
  Kind kind_;
  std::size_t size_ = 0; ///< of what counts
};

} // namespace files
