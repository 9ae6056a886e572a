// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/thread_pool.h"

#include <chrono>
#include <system_error>
#include <utility>

#ifdef __linux__
#include <pthread.h>
#include <sched.h>
#endif

namespace saliency {

ThreadPool::~ThreadPool()
{
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  work_to_do_.notify_all();
  for (std::thread &thread : threads_)
    thread.join();
}

void
ThreadPool::start(int threads)
{
  if (static_cast<int>(threads_.size()) < threads)
    kept_off_ = -1;
  try {
    while (static_cast<int>(threads_.size()) < threads)
      threads_.emplace_back([this] { wait_for_work(); });
  } catch (const std::system_error &) {
    // The caller does what they would have done.
  }
}

/// Where it may not, or there is no other processor, they stay as they are.
void
ThreadPool::keep_off_callers_processor()
{
#ifdef __linux__
  const int processor = sched_getcpu();
  if (processor < 0 || processor == kept_off_)
    return;
  kept_off_ = processor;
  cpu_set_t others;
  if (sched_getaffinity(0, sizeof others, &others) != 0)
    return;
  CPU_CLR(processor, &others);
  if (CPU_COUNT(&others) > 0)
    for (std::thread &thread : threads_)
      pthread_setaffinity_np(thread.native_handle(), sizeof others, &others);
#endif
}

/// Until then or until it has been as long as waking up may take.
template <typename Until>
void
ThreadPool::stay_awake(const Until &until)
{
  constexpr std::chrono::microseconds kWakingUp{ 50 };
  const auto sleep = std::chrono::steady_clock::now() + kWakingUp;
  while (!until() && std::chrono::steady_clock::now() < sleep)
    std::this_thread::yield();
}

void
ThreadPool::run(int parts, Part part, const void *work)
{
  if (parts > 1) {
    start(parts - 1);
    keep_off_callers_processor();
  }
  std::unique_lock lock(mutex_);
  part_ = part;
  work_ = work;
  next_ = 0;
  parts_ = parts;
  undone_ = parts;
  ++works_;
  if (parts > 1)
    work_to_do_.notify_all();
  do_parts(lock);
  const auto done = [this] {
    return undone_ == 0;
  };
  if (!done()) {
    lock.unlock();
    stay_awake(done);
    lock.lock();
    all_done_.wait(lock, done);
  }
  if (error_)
    std::rethrow_exception(std::exchange(error_, nullptr));
}

void
ThreadPool::wait_for_work()
{
  std::unique_lock lock(mutex_);
  while (!end_) {
    do_parts(lock);
    const unsigned known = works_;
    lock.unlock();
    stay_awake([this, known] { return end_ || works_ != known; });
    lock.lock();
    if (works_ == known)
      work_to_do_.wait(lock, [this] { return end_ || next_ < parts_; });
  }
}

/// Takes parts that nobody does yet until there are none.
void
ThreadPool::do_parts(std::unique_lock<std::mutex> &lock)
{
  while (next_ < parts_) {
    const int mine = next_++;
    lock.unlock();
    std::exception_ptr error;
    try {
      part_(work_, mine);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error)
      error_ = error;
    if (--undone_ == 0)
      all_done_.notify_one();
  }
}

} // namespace saliency
