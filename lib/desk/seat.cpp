// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/seat.h"

namespace desk {

void
Seat::listens(const std::string &page)
{
  listening_[page]++;
}

bool
Seat::left(const std::string &page)
{
  const auto found = listening_.find(page);
  if (found == listening_.end() || --found->second > 0)
    return false;
  listening_.erase(found);
  give(page);
  return true;
}

bool
Seat::take(const std::string &page, bool insists)
{
  if (listening_.contains(page) && (!writer_ || insists))
    writer_ = page;
  return has(page);
}

void
Seat::give(const std::string &page)
{
  if (has(page))
    writer_.reset();
}

} // namespace desk
