// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <vector>

#include <pthread.h>
#ifdef __linux__
#include <sched.h>
#endif

namespace saliency {

/// A pool of threads that run the parts of one piece of work. Threads start when work first has
/// that many parts and end with the pool; later calls allocate nothing. Not thread-safe: one
/// caller.
///
/// On Linux the threads run on the caller's CPUs except the one it is running on. The kernel of a
/// virtual machine often wakes a thread on the caller's CPU rather than on a halted one, and then
/// nothing runs in parallel.
class ThreadPool
{
public:
  ThreadPool() = default;
  ~ThreadPool();
  ThreadPool(const ThreadPool &) = delete;
  ThreadPool &operator=(const ThreadPool &) = delete;

  /// Runs work(0)…work(parts - 1), once each, on this and other threads; returns when all are done.
  /// If the system has no more threads, the existing ones do all parts. A part that runs out of
  /// memory throws; one of these exceptions is rethrown.
  template <typename Work> void run(int parts, const Work &work)
  {
    run(
        parts, [](const void *w, int part) { (*static_cast<const Work *>(w))(part); }, &work);
  }

private:
  using Part = void (*)(const void *work, int part);

  void run(int parts, Part part, const void *work);
  void start(int threads);
  void keep_off_callers_processor();
  void wait_for_work();
  void do_parts(std::unique_lock<std::mutex> &lock);

  /// Not std::thread, which throws when the system has no more threads.
  std::vector<pthread_t> threads_; ///< used by the caller only, like processors_
#ifdef __linux__
  cpu_set_t processors_{}; ///< affinity set on all threads; empty if some lack it
#endif
  std::mutex mutex_;
  std::condition_variable work_to_do_;
  std::condition_variable all_done_;
  Part part_ = nullptr; ///< from here on under mutex_; this and work_ change only between runs
  const void *work_ = nullptr;
  int next_ = 0;  ///< first part not taken yet
  int parts_ = 0; ///< of the current work
  int undone_ = 0;
  bool end_ = false;
  std::exception_ptr error_;
};

/// A number of threads of a pool, or the caller alone.
class Team
{
public:
  Team() = default;
  Team(ThreadPool &pool, int threads) : pool_(&pool), threads_(std::max(1, threads))
  {
  }

  int threads() const
  {
    return threads_;
  }

  /// Splits 0…count - 1 into threads() ranges of about equal length and runs work(part, begin, end)
  /// for each; otherwise as ThreadPool::run().
  template <typename Work> void share(int count, const Work &work) const
  {
    if (threads() == 1) {
      work(0, 0, count);
      return;
    }
    pool_->run(threads_, [&work, count, parts = threads_](int part) {
      work(part, count * part / parts, count * (part + 1) / parts);
    });
  }

  /// Runs work(0)…work(count - 1), split in the same way.
  template <typename Work> void each(int count, const Work &work) const
  {
    share(count, [&work](int, int begin, int end) {
      for (int i = begin; i < end; ++i)
        work(i);
    });
  }

private:
  ThreadPool *pool_ = nullptr;
  int threads_ = 1;
};

} // namespace saliency
