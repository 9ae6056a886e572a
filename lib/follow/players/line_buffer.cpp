// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/line_buffer.h"

namespace follow {

bool
LineBuffer::add(std::string_view bytes)
{
  bytes_ += bytes;
  const std::size_t last = bytes_.rfind('\n');
  const std::size_t unfinished
      = last == std::string::npos ? bytes_.size() : bytes_.size() - last - 1;
  return unfinished <= kLongestLine;
}

std::optional<std::string>
LineBuffer::next()
{
  const std::size_t end = bytes_.find('\n');
  if (end == std::string::npos)
    return std::nullopt;
  std::string line = bytes_.substr(0, end);
  bytes_.erase(0, end + 1);
  return line;
}

} // namespace follow
