// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

/// Ends the process, with the stacks of all its threads, where something takes too long. Time is
/// counted in turns of its own thread: a process that was stopped for minutes, or a machine that
/// was, is not late.
class Watchdog
{
public:
  /// `report` says what was going on; it is called once, on the watchdog's thread, before the
  /// stacks are printed.
  Watchdog(int seconds, std::function<void()> report);
  ~Watchdog();
  Watchdog(const Watchdog &) = delete;
  Watchdog &operator=(const Watchdog &) = delete;

  /// From any thread: the time begins anew.
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
  std::thread thread_; ///< last: it uses the others
};

/// Prints the stack of the thread that calls it to stderr; a handler of signals.
void print_own_stack(int signal);

/// Prints the stack of each thread to stderr. Threads that hold malloc's lock may not be able to.
void print_stacks();
