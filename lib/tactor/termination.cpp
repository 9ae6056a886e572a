// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/termination.h"

#include "tactor/thread.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tactor {

namespace {

constexpr std::array kSignals{ SIGTERM, SIGINT, SIGHUP };

// What the handler reads; process-wide, as a signal's action is.
std::atomic<int> pipe_in{ -1 };
std::atomic<pid_t> owner{ 0 }; ///< a forked process has the handler, but not the thread
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

/// Async-signal-safe. SA_RESETHAND has restored the default action.
extern "C" void
tactor_on_signal(int number)
{
  const int error = errno;
  const int fd = pipe_in;
  const auto byte = static_cast<unsigned char>(number);
  if (fd < 0 || owner != getpid() || write(fd, &byte, 1) != 1)
    raise(number); // nothing to stop
  errno = error;
}

/// Sets a signal's action if it was one of `expected`; others are the application's. Exchanges
/// rather than looks first, as the application may set its own on another thread meanwhile.
void
exchange(int number, const struct sigaction &action, std::initializer_list<sighandler_t> expected)
{
  struct sigaction before
  {
  };
  if (sigaction(number, &action, &before) == 0
      && ((before.sa_flags & SA_SIGINFO) != 0
          || std::ranges::count(expected, before.sa_handler) == 0))
    sigaction(number, &before, nullptr);
}

/// Catches signals while it lives.
class Catcher
{
public:
  explicit Catcher(std::function<void()> caught) : caught_(std::move(caught))
  {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      return;
    // Signals are delivered to the application's threads.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    tl::expected<Thread, DriverError> thread = Thread::start([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (!thread)
      return; // signals keep their default action
    thread_ = std::move(*thread);
    pipe_in = ends_[1];
    for (const int number : kSignals) {
      struct sigaction ours
      {
      };
      ours.sa_handler = tactor_on_signal;
      ours.sa_flags = SA_RESTART | SA_RESETHAND;
      exchange(number, ours, { SIG_DFL, tactor_on_signal }); // ours: inherited by a fork
    }
  }

  ~Catcher()
  {
    if (thread_)
      release();
    for (const int end : ends_)
      if (end >= 0)
        close(end);
  }

  Catcher(const Catcher &) = delete;
  Catcher &operator=(const Catcher &) = delete;

private:
  /// Restores the default actions and ends the thread.
  void release()
  {
    for (const int number : kSignals) {
      struct sigaction none
      {
      };
      none.sa_handler = SIG_DFL;
      exchange(number, none, { tactor_on_signal });
    }
    pipe_in = -1;
    const unsigned char stop = 0;
    while (write(ends_[1], &stop, 1) < 0 && errno == EINTR) {
    }
    thread_.join();
  }

  void run()
  {
    unsigned char number = 0;
    while (read(ends_[0], &number, 1) < 0 && errno == EINTR) {
    }
    if (number == 0)
      return;
    caught_();
    sigset_t one;
    sigemptyset(&one);
    sigaddset(&one, number);
    pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
    kill(getpid(), number);
    // Reached only if the application handles the signal by now.
  }

  const std::function<void()> caught_;
  std::array<int, 2> ends_{ -1, -1 };
  Thread thread_;
};

struct Guards
{
  std::mutex catching;              ///< locked before `mutex`; guards catcher
  std::unique_ptr<Catcher> catcher; ///< while there are guards
  std::mutex mutex;                 ///< guards all
  std::vector<const TerminationGuard::Leave *> all;

  void leave()
  {
    const std::lock_guard lock(mutex);
    const auto now = std::chrono::steady_clock::now();
    for (const auto until : { now, now + TerminationGuard::kPatience }) // all begin first
      for (const TerminationGuard::Leave *leave : all)
        (*leave)(until);
  }
};

/// Never destroyed: guards may still exist at exit().
Guards &
guards()
{
  static Guards *const instance = [] {
    static_cast<void>(std::atexit([] {
      if (owner == getpid())
        guards().leave();
    }));
    return std::make_unique<Guards>().release();
  }();
  return *instance;
}

} // namespace

TerminationGuard::TerminationGuard(Leave leave) : leave_(std::move(leave))
{
  Guards &guards = tactor::guards();
  const std::lock_guard catching(guards.catching);
  if (const pid_t parent = owner.exchange(getpid()); parent != getpid() && guards.catcher) {
    // Forked from a process with guards, without its threads.
    static_cast<void>(guards.catcher.release());
    guards.all.clear();
  }
  {
    const std::lock_guard lock(guards.mutex);
    guards.all.push_back(&leave_);
  }
  if (!guards.catcher && !std::getenv("VISUOTACTILE_NO_SIGNALS"))
    guards.catcher = std::make_unique<Catcher>([&guards] { guards.leave(); });
}

TerminationGuard::~TerminationGuard()
{
  Guards &guards = tactor::guards();
  const std::lock_guard catching(guards.catching);
  bool is_last = false;
  {
    const std::lock_guard lock(guards.mutex);
    std::erase(guards.all, &leave_);
    is_last = guards.all.empty();
  }
  if (is_last)
    guards.catcher.reset();
}

} // namespace tactor
