// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chairturns.h"

#include <algorithm>

ChairTurns &
ChairTurns::of_process()
{
  static ChairTurns turns;
  return turns;
}

/// The waiting film with the strongest claim.
std::deque<ChairTurns::Claimant>::iterator
ChairTurns::next()
{
  return std::ranges::max_element(waiting_, {}, &Claimant::claim); // the first of equals
}

/// Whether a waiting film outranks the holder of the chair.
bool
ChairTurns::wanted()
{
  const auto best = next();
  return best != waiting_.end() && best->claim.state == Claim::State::kPlays
         && best->claim > holder_.claim;
}

void
ChairTurns::settle()
{
  const auto best = next();
  if (holder_.element != nullptr && wanted())
    gst_element_call_async(holder_.element, holder_.asked, nullptr, nullptr);
  else if (holder_.element == nullptr && best != waiting_.end()
           && best->claim.state != Claim::State::kEnded)
    gst_element_call_async(best->element, best->offered, nullptr, nullptr);
}

bool
ChairTurns::take(const Film &film, Claim claim)
{
  const std::lock_guard lock(mutex_);
  if (holder_.element == film.element)
    return true;
  auto place = std::ranges::find(waiting_, film.element, &Claimant::element);
  if (place == waiting_.end())
    place = waiting_.insert(waiting_.end(), { film, claim });
  place->claim = claim;
  if (holder_.element == nullptr && claim.state != Claim::State::kEnded && place == next()) {
    holder_ = *place;
    waiting_.erase(place);
    return true;
  }
  settle();
  return false;
}

void
ChairTurns::claim(GstElement *element, Claim claim)
{
  const std::lock_guard lock(mutex_);
  const auto place = std::ranges::find(waiting_, element, &Claimant::element);
  if (holder_.element == element)
    holder_.claim = claim;
  else if (place != waiting_.end())
    place->claim = claim;
  settle();
}

bool
ChairTurns::outranked(GstElement *element)
{
  const std::lock_guard lock(mutex_);
  return holder_.element == element && wanted();
}

void
ChairTurns::leave(GstElement *element)
{
  const std::lock_guard lock(mutex_);
  std::erase_if(waiting_, [element](const Claimant &film) { return film.element == element; });
  if (holder_.element == element)
    holder_ = {};
  settle();
}
