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

// What the handler reads. A signal's action is the process's, and so is this.
std::atomic<int> pipe_in{ -1 };
std::atomic<pid_t> owner{ 0 }; ///< a process that was forked has the handler, but not the thread
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

/// Async-signal-safe. The action is the default one by now (SA_RESETHAND).
extern "C" void
tactor_on_signal(int number)
{
  const int error = errno;
  const int fd = pipe_in;
  const auto byte = static_cast<unsigned char>(number);
  if (fd < 0 || owner != getpid() || write(fd, &byte, 1) != 1)
    raise(number); // nobody has anything to stop
  errno = error;
}

/// Sets a signal's action where it was one of `expected`. Others are the application's, which may
/// be setting its own on another thread at this moment: looking first would overwrite that.
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

/// Catches signals from its beginning to its end.
class Catcher
{
public:
  explicit Catcher(std::function<void()> caught) : caught_(std::move(caught))
  {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      return;
    // Signals are for the application's threads.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    tl::expected<Thread, DriverError> thread = Thread::start([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (!thread)
      return; // signals do what they would without a guard
    thread_ = std::move(*thread);
    pipe_in = ends_[1];
    for (const int number : kSignals) {
      struct sigaction ours
      {
      };
      ours.sa_handler = tactor_on_signal;
      ours.sa_flags = SA_RESTART | SA_RESETHAND;
      exchange(number, ours, { SIG_DFL, tactor_on_signal }); // of a parent before a fork
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
  /// Signals have their default action back, and the thread has ended.
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
    // Only if the application has taken the signal meanwhile: this is its affair now.
  }

  const std::function<void()> caught_;
  std::array<int, 2> ends_{ -1, -1 };
  Thread thread_;
};

/// All guards, and what catches for them.
struct Guards
{
  std::mutex catching;              ///< taken before the other one; guards catcher
  std::unique_ptr<Catcher> catcher; ///< while there are guards
  std::mutex mutex;                 ///< guards all
  std::vector<const TerminationGuard::Leave *> all;

  void leave()
  {
    const std::lock_guard lock(mutex);
    const auto now = std::chrono::steady_clock::now();
    for (const auto until : { now, now + TerminationGuard::kPatience }) // first all begin
      for (const TerminationGuard::Leave *leave : all)
        (*leave)(until);
  }
};

/// Never destroyed: who is still there when the process ends may leave then.
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
    // This process was forked from one with guards, and has none of its threads.
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
