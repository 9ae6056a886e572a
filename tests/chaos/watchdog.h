// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

/// Ends the process, and prints the stacks of all threads, if something takes too long. It counts
/// wakeups of its own thread, so that a process or machine that was suspended is not late.
class Watchdog
{
public:
  /// `report` is called once, from the watchdog's thread, before the stacks are printed.
  Watchdog(int seconds, std::function<void()> report);
  ~Watchdog();
  Watchdog(const Watchdog &) = delete;
  Watchdog &operator=(const Watchdog &) = delete;

  /// Restarts the timeout. From any thread.
  void feed();

private:
  void run();

  static constexpr int kTurnsPerSecond = 10;
  const int turns_;
  const std::function<void()> report_;
  std::atomic<int> left_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool quit_ = false;
  std::thread thread_; ///< last, as it uses the others
};

/// Signal handler that prints the stack of the current thread to stderr.
void print_own_stack(int signal);

/// Prints the stack of each thread to stderr. May fail for threads that hold malloc's lock.
void print_stacks();
