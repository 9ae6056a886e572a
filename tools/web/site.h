// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <string>

/// The site of a server. Its requests have been admitted. Main context's thread.
class Site
{
public:
  static constexpr goffset kLargestBody = goffset{ 64 } << 10;

  Site() = default;
  virtual ~Site() = default;
  Site(const Site &) = delete;
  Site &operator=(const Site &) = delete;

  /// The methods of a path, such as "GET, HEAD".
  virtual std::string methods(const std::string &path) const = 0;
  /// Most bytes of a body for this path.
  virtual goffset largest_body(const std::string &) const
  {
    return kLargestBody;
  }
  /// Answers, or throws.
  virtual void answer(SoupServerMessage *message, const std::string &path) = 0;
};
