// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <optional>
#include <string>

namespace desk {

/// Grants one of the open pages the right to write. Not thread-safe.
class Seat
{
public:
  /// A page listens, maybe to several streams of events while it reloads.
  void listens(const std::string &page);
  /// One of its streams has ended. Returns whether it was the last one, which ends the right to
  /// write.
  bool left(const std::string &page);

  /// Returns whether the page writes from now on: it listens, and no other page writes or it
  /// insists.
  bool take(const std::string &page, bool insists);
  void give(const std::string &page);

  bool has(const std::string &page) const
  {
    return writer_ == page;
  }
  const std::optional<std::string> &writer() const
  {
    return writer_;
  }

private:
  std::map<std::string, int> listening_;
  std::optional<std::string> writer_;
};

} // namespace desk
