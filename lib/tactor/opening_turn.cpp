// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/opening_turn.h"

#include <condition_variable>
#include <mutex>
#include <set>

namespace tactor {

namespace {

/// The queue.
struct Line
{
  std::mutex mutex;
  std::condition_variable_any changed;
  std::set<unsigned long> places;
  unsigned long last = 0;

  unsigned long add()
  {
    const std::lock_guard lock(mutex);
    places.insert(++last);
    return last;
  }
};

Line &
line()
{
  static Line instance;
  return instance;
}

} // namespace

OpeningTurn::OpeningTurn() : place_(line().add())
{
}

OpeningTurn::~OpeningTurn()
{
  const std::lock_guard lock(line().mutex);
  line().places.erase(place_);
  line().changed.notify_all();
}

bool
OpeningTurn::wait(const std::stop_token &stop) const
{
  std::unique_lock lock(line().mutex);
  return line().changed.wait(lock, stop, [this] { return *line().places.begin() == place_; });
}

} // namespace tactor
