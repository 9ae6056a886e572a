// SPDX-License-Identifier: LGPL-2.1-or-later
#include "watchdog.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <execinfo.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/syscall.h>
#include <unistd.h>

using std::chrono::milliseconds;

Watchdog::Watchdog(int seconds, std::function<void()> report)
    : turns_(seconds * kTurnsPerSecond), report_(std::move(report)), left_(turns_),
      thread_([this] { run(); })
{
}

Watchdog::~Watchdog()
{
  {
    std::lock_guard lock(mutex_);
    quit_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void
Watchdog::feed()
{
  left_ = turns_;
}

void
Watchdog::run()
{
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, milliseconds(1000 / kTurnsPerSecond), [this] { return quit_; })) {
    if (--left_ > 0)
      continue;
    report_();
    print_stacks();
    std::_Exit(1);
  }
}

namespace {

std::atomic<int> printed{ 0 };

} // namespace

void
print_own_stack(int)
{
  void *frames[64];
  const int count = backtrace(frames, 64);
  const char line[] = "---- stack of a thread\n";
  (void)!write(STDERR_FILENO, line, sizeof line - 1);
  backtrace_symbols_fd(frames, count, STDERR_FILENO);
  printed++;
}

void
print_stacks()
{
  void *frames[1];
  backtrace(frames, 1); // loads libgcc outside of signal handlers
  std::signal(SIGUSR2, print_own_stack);
  for (const auto &entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(entry.path().filename());
    std::string name;
    std::getline(std::ifstream(entry.path() / "comm"), name);
    std::fprintf(stderr, "==== thread %d \"%s\"\n", thread, name.c_str());
    const int before = printed;
    syscall(SYS_tgkill, getpid(), thread, SIGUSR2);
    for (int i = 0; i < 100 && printed == before; i++)
      std::this_thread::sleep_for(milliseconds(10));
  }
}
