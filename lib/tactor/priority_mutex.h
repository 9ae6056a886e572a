// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace tactor {

/// A mutex for what a real-time thread shares with others. Whoever holds it has the priority of
/// the most urgent thread that waits for it. With std::mutex, a real-time thread waits until its
/// holder, which may be of the lowest priority on a busy machine, gets CPU time. Where the kernel
/// has no priority inheritance it is an ordinary mutex.
class PriorityMutex
{
public:
  PriorityMutex();
  ~PriorityMutex();
  PriorityMutex(const PriorityMutex &) = delete;
  PriorityMutex &operator=(const PriorityMutex &) = delete;

  // As of std::mutex.
  void lock();
  bool try_lock();
  bool try_lock_until(std::chrono::steady_clock::time_point time);
  void unlock();

private:
  friend class PriorityCondition;

  pthread_mutex_t mutex_;
};

using PriorityLock = std::unique_lock<PriorityMutex>;

/// As std::condition_variable, for a PriorityMutex. std::condition_variable_any has a mutex of its
/// own, without priority inheritance.
class PriorityCondition
{
public:
  using Clock = std::chrono::steady_clock;

  PriorityCondition();
  ~PriorityCondition();
  PriorityCondition(const PriorityCondition &) = delete;
  PriorityCondition &operator=(const PriorityCondition &) = delete;

  void notify_all();
  void wait(PriorityLock &lock);
  std::cv_status wait_until(PriorityLock &lock, Clock::time_point time);

  std::cv_status wait_for(PriorityLock &lock, Clock::duration time)
  {
    return wait_until(lock, Clock::now() + time);
  }
  template <typename Predicate> void wait(PriorityLock &lock, Predicate is_met)
  {
    while (!is_met())
      wait(lock);
  }
  template <typename Predicate>
  bool wait_until(PriorityLock &lock, Clock::time_point time, Predicate is_met)
  {
    while (!is_met())
      if (wait_until(lock, time) == std::cv_status::timeout)
        return is_met();
    return true;
  }
  template <typename Predicate>
  bool wait_for(PriorityLock &lock, Clock::duration time, Predicate is_met)
  {
    return wait_until(lock, Clock::now() + time, is_met);
  }

private:
  pthread_cond_t condition_;
};

} // namespace tactor
