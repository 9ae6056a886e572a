// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/priority_mutex.h"

#include <cerrno>
#include <ctime>

namespace tactor {

static timespec
as_timespec(std::chrono::nanoseconds time)
{
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  return { .tv_sec = static_cast<time_t>(seconds.count()),
           .tv_nsec = static_cast<long>((time - seconds).count()) };
}

PriorityMutex::PriorityMutex()
{
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  if (pthread_mutex_init(&mutex_, &attributes) != 0)
    pthread_mutex_init(&mutex_, nullptr);
  pthread_mutexattr_destroy(&attributes);
}

PriorityMutex::~PriorityMutex()
{
  pthread_mutex_destroy(&mutex_);
}

void
PriorityMutex::lock()
{
  pthread_mutex_lock(&mutex_);
}

bool
PriorityMutex::try_lock()
{
  return pthread_mutex_trylock(&mutex_) == 0;
}

/// Waits by the wall clock: kernels before 5.14 have no other clock for such a mutex.
bool
PriorityMutex::try_lock_until(std::chrono::steady_clock::time_point time)
{
  const auto rest = time - std::chrono::steady_clock::now();
  const timespec until = as_timespec(std::chrono::system_clock::now().time_since_epoch() + rest);
  return pthread_mutex_timedlock(&mutex_, &until) == 0;
}

void
PriorityMutex::unlock()
{
  pthread_mutex_unlock(&mutex_);
}

PriorityCondition::PriorityCondition()
{
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC); // that of std::chrono::steady_clock
  pthread_cond_init(&condition_, &attributes);
  pthread_condattr_destroy(&attributes);
}

PriorityCondition::~PriorityCondition()
{
  pthread_cond_destroy(&condition_);
}

void
PriorityCondition::notify_all()
{
  pthread_cond_broadcast(&condition_);
}

void
PriorityCondition::wait(PriorityLock &lock)
{
  pthread_cond_wait(&condition_, &lock.mutex()->mutex_);
}

std::cv_status
PriorityCondition::wait_until(PriorityLock &lock, Clock::time_point time)
{
  const timespec until = as_timespec(time.time_since_epoch());
  return pthread_cond_timedwait(&condition_, &lock.mutex()->mutex_, &until) == ETIMEDOUT
             ? std::cv_status::timeout
             : std::cv_status::no_timeout;
}

} // namespace tactor
