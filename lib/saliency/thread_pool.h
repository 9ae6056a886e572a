// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace saliency {

/// Threads that wait for parts of a piece of work. They are started when work first has that many
/// parts and end with the pool; no allocation once they run. Not thread-safe itself: one caller.
class ThreadPool
{
public:
  ThreadPool() = default;
  ~ThreadPool();
  ThreadPool(const ThreadPool &) = delete;
  ThreadPool &operator=(const ThreadPool &) = delete;

  /// Does work(0)…work(parts - 1), each once, on this and other threads, and returns when all are
  /// done; rethrows one of the exceptions that parts threw. Where the system has no more threads,
  /// those that there are do it.
  template <typename Work> void run(int parts, const Work &work)
  {
    run(
        parts, [](const void *w, int part) { (*static_cast<const Work *>(w))(part); }, &work);
  }

private:
  using Part = void (*)(const void *work, int part);

  void run(int parts, Part part, const void *work);
  void start(int threads);
  void wait_for_work();
  void do_parts(std::unique_lock<std::mutex> &lock);

  std::vector<std::thread> threads_; ///< the caller's only
  std::mutex mutex_;
  std::condition_variable work_to_do_;
  std::condition_variable all_done_;
  Part part_ = nullptr; ///< what follows is guarded by the mutex
  const void *work_ = nullptr;
  int next_ = 0;  ///< part that nobody does yet
  int parts_ = 0; ///< of the work at hand
  int undone_ = 0;
  std::exception_ptr error_;
  bool end_ = false;
};

} // namespace saliency
