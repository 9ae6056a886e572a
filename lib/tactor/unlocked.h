// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/priority_mutex.h"

namespace tactor {

/// Releases a lock for as long as it lives.
class Unlocked
{
public:
  explicit Unlocked(PriorityLock &lock) : lock_(lock)
  {
    lock_.unlock();
  }
  ~Unlocked()
  {
    lock_.lock();
  }
  Unlocked(const Unlocked &) = delete;
  Unlocked &operator=(const Unlocked &) = delete;

private:
  PriorityLock &lock_;
};

/// Runs `call` without the lock and returns its result.
template <class Call>
auto
without(PriorityLock &lock, const Call &call)
{
  const Unlocked unlocked(lock);
  return call();
}

} // namespace tactor
