// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/json_stream.h"

#include <algorithm>

namespace follow {

namespace {

constexpr std::string_view kSpace = " \t\r\n";

} // namespace

bool
JsonStream::add(std::string_view bytes)
{
  bytes_ += bytes;
  if (known_ == 0)
    bytes_.erase(0, bytes_.find_first_not_of(kSpace));
  return (bytes_.empty() || bytes_.front() == '{') && known_ <= kLongest;
}

bool
JsonStream::ends(char c)
{
  if (is_escaped_)
    is_escaped_ = false;
  else if (c == '"')
    in_string_ = !in_string_;
  else if (in_string_)
    is_escaped_ = c == '\\';
  else if (c == '{')
    depth_++;
  else if (c == '}')
    return --depth_ == 0;
  return false;
}

std::optional<std::string>
JsonStream::next()
{
  if (bytes_.empty() || bytes_.front() != '{')
    return std::nullopt;
  while (known_ < bytes_.size())
    if (ends(bytes_[known_++])) {
      std::string object = bytes_.substr(0, known_);
      bytes_.erase(0, std::min(bytes_.find_first_not_of(kSpace, known_), bytes_.size()));
      known_ = 0;
      return object;
    }
  return std::nullopt;
}

} // namespace follow
