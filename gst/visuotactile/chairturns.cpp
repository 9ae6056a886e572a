// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chairturns.h"

#include <algorithm>

ChairTurns &
ChairTurns::of_process()
{
  static ChairTurns turns;
  return turns;
}

void
ChairTurns::offer()
{
  if (holder_.element == nullptr && !waiting_.empty())
    gst_element_call_async(waiting_.front().element, waiting_.front().offered, nullptr, nullptr);
}

bool
ChairTurns::take(const Film &film)
{
  const std::lock_guard lock(mutex_);
  if (holder_.element == film.element)
    return true;
  const auto place = std::ranges::find(waiting_, film.element, &Film::element);
  const bool is_first = place == waiting_.begin(); // also where nobody waits
  if (holder_.element == nullptr && is_first) {
    if (place != waiting_.end())
      waiting_.pop_front();
    holder_ = film;
    return true;
  }
  if (place == waiting_.end())
    waiting_.push_back(film);
  if (holder_.element != nullptr)
    gst_element_call_async(holder_.element, holder_.asked, nullptr, nullptr);
  return false;
}

void
ChairTurns::leave(GstElement *element)
{
  const std::lock_guard lock(mutex_);
  std::erase_if(waiting_, [element](const Film &film) { return film.element == element; });
  if (holder_.element == element)
    holder_ = {};
  offer();
}

void
ChairTurns::end(GstElement *element)
{
  const std::lock_guard lock(mutex_);
  if (holder_.element == element && !waiting_.empty())
    gst_element_call_async(element, holder_.asked, nullptr, nullptr);
}
