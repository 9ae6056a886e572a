// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/thread_pool.h"

#include <utility>

namespace saliency {

ThreadPool::~ThreadPool()
{
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  work_to_do_.notify_all();
  for (const pthread_t thread : threads_)
    pthread_join(thread, nullptr);
}

void
ThreadPool::start(int threads)
{
  const auto work = [](void *self) -> void * {
    static_cast<ThreadPool *>(self)->wait_for_work();
    return nullptr;
  };
  while (static_cast<int>(threads_.size()) < threads) {
    pthread_t thread;
    if (pthread_create(&thread, nullptr, work, this) != 0)
      return; // the caller does their parts
    threads_.push_back(thread);
#ifdef __linux__
    CPU_ZERO(&processors_); // the new thread needs its affinity, too
#endif
  }
}

/// Does nothing where the affinity is unknown. A caller with a single CPU shares it with the
/// threads.
void
ThreadPool::keep_off_callers_processor()
{
#ifdef __linux__
  cpu_set_t processors;
  const int own = sched_getcpu();
  if (own < 0 || sched_getaffinity(0, sizeof processors, &processors) != 0)
    return;
  if (CPU_COUNT(&processors) > 1)
    CPU_CLR(own, &processors);
  if (CPU_EQUAL(&processors, &processors_))
    return;
  processors_ = processors;
  for (const pthread_t thread : threads_)
    pthread_setaffinity_np(thread, sizeof processors, &processors);
#endif
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
  if (parts > 1)
    work_to_do_.notify_all();
  do_parts(lock);
  all_done_.wait(lock, [this] { return undone_ == 0; });
  if (error_)
    std::rethrow_exception(std::exchange(error_, nullptr));
}

void
ThreadPool::wait_for_work()
{
  std::unique_lock lock(mutex_);
  while (!end_) {
    work_to_do_.wait(lock, [this] { return end_ || next_ < parts_; });
    do_parts(lock);
  }
}

/// Takes parts until none are left.
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
