// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <optional>
#include <string>

namespace desk {

/// Which of the pages that are there may write. Not thread-safe.
class Seat
{
public:
  /// A page listens, perhaps to several streams of events while it loads again.
  void listens(const std::string &page);
  /// One of its streams has ended. Whether it was the last one, which gives the seat back.
  bool left(const std::string &page);

  /// Whether the page writes from now on: it listens, and nobody else writes or it insists.
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
