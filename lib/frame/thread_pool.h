// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <vector>

#include <pthread.h>
#ifdef __linux__
#include <sched.h>
#endif

namespace saliency {

/// Threads that wait for parts of a piece of work. They are started when work first has that many
/// parts and end with the pool; no allocation once they run. Not thread-safe itself: one caller.
///
/// Who has done all there is stays awake a while, as more work often follows at once and waking up
/// takes longer than the smallest piece of it; whoever else wants the processor then has it.
///
/// On Linux the threads run on the caller's processors, but not on the one that it calls from: the
/// kernel of a virtual machine often wakes a thread there rather than on one that halted, and then
/// nothing is done at once.
class ThreadPool
{
public:
  ThreadPool() = default;
  ~ThreadPool();
  ThreadPool(const ThreadPool &) = delete;
  ThreadPool &operator=(const ThreadPool &) = delete;

  /// Does work(0)…work(parts - 1), each once, on this and other threads, and returns when all are
  /// done. Where the system has no more threads, those that there are do it. Parts that find no
  /// memory throw; one of these exceptions is rethrown.
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
  template <typename Until> static void stay_awake(const Until &until);

  /// Not std::thread, which throws where the system has no more of them.
  std::vector<pthread_t> threads_; ///< the caller's only, as what follows
#ifdef __linux__
  cpu_set_t processors_{}; ///< that the threads were told to run on; none: not all of them were
#endif
  std::mutex mutex_;
  std::condition_variable work_to_do_;
  std::condition_variable all_done_;
  Part part_ = nullptr; ///< what follows changes under the mutex, this and work_ only between works
  const void *work_ = nullptr;
  int next_ = 0;  ///< part that nobody does yet
  int parts_ = 0; ///< of the work at hand
  std::exception_ptr error_;
  std::atomic<int> undone_ = 0;     ///< also read without it, as what follows
  std::atomic<unsigned> works_ = 0; ///< that there were
  std::atomic<bool> end_ = false;
};

/// So many threads of a pool, or the caller alone.
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

  /// work(part, begin, end) for threads() parts of 0…count - 1, which are about as long; otherwise
  /// as ThreadPool::run().
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

  /// work(0)…work(count - 1), likewise.
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
