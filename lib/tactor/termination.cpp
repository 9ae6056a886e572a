// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/termination.h"

#include "tactor/thread.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <mutex>
#include <poll.h>
#include <sched.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tactor {

namespace {

/// What ends a process by default and is no fault of its code.
constexpr std::array kSignals{ SIGHUP,    SIGINT,  SIGQUIT, SIGABRT, SIGPIPE,
                               SIGALRM,   SIGTERM, SIGUSR1, SIGUSR2, SIGPOLL,
                               SIGVTALRM, SIGPROF, SIGXCPU, SIGXFSZ, SIGPWR };

// What the handler reads; process-wide, as a signal's action is.
std::atomic<int> pipe_in{ -1 };
std::atomic<pid_t> owner{ 0 }; ///< a forked process has the handler, but not the thread
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

/// Async-signal-safe.
extern "C" void
tactor_on_signal(int number, siginfo_t *info, void *)
{
  const int error = errno;
  const int fd = pipe_in;
  const auto byte = static_cast<unsigned char>(number);
  if (fd < 0 || owner != getpid() || (write(fd, &byte, 1) != 1 && errno != EAGAIN)) {
    // Nothing to stop: the default action, once the handler has returned.
    std::signal(number, SIG_DFL);
    raise(number);
  } else if (number == SIGABRT && info->si_code == SI_TKILL) {
    // abort() ends the process when the handler returns. The thread does so earlier.
    constexpr auto kWait = std::chrono::milliseconds(TerminationGuard::kPatience);
    poll(nullptr, 0, static_cast<int>(kWait.count()));
  }
  errno = error;
}

bool
is_ours(const struct sigaction &action)
{
  return (action.sa_flags & SA_SIGINFO) != 0 && action.sa_sigaction == tactor_on_signal;
}

bool
is_default(const struct sigaction &action)
{
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_DFL;
}

/// Sets a signal's action if it is one that `may_change`. It is looked at first: an application's
/// own is never replaced, but for a moment if it is set on another thread meanwhile.
void
exchange(int number, const struct sigaction &action, bool (*may_change)(const struct sigaction &))
{
  struct sigaction before
  {
  };
  if (sigaction(number, nullptr, &before) == 0 && may_change(before)
      && sigaction(number, &action, &before) == 0 && !may_change(before))
    sigaction(number, &before, nullptr);
}

void
catch_signals()
{
  struct sigaction ours
  {
  };
  ours.sa_sigaction = tactor_on_signal;
  ours.sa_flags = SA_RESTART | SA_SIGINFO;
  sigfillset(&ours.sa_mask);
  for (const int number : kSignals)
    exchange(number, ours, is_default);
}

void
restore(int number)
{
  struct sigaction none
  {
  };
  none.sa_handler = SIG_DFL;
  exchange(number, none, is_ours);
}

/// Catches signals while it lives.
class Catcher
{
public:
  /// `pipe` outlives it: a handler may still write.
  Catcher(const std::array<int, 2> &pipe, std::function<void()> caught)
      : pipe_(pipe), caught_(std::move(caught))
  {
    tl::expected<Thread, DriverError> thread = Thread::start([this] { run(); });
    if (!thread)
      return; // signals keep their default action
    thread_ = std::move(*thread);
    pipe_in = pipe_[1];
    catch_signals();
  }

  ~Catcher()
  {
    for (const int number : kSignals)
      restore(number);
    pipe_in = -1;
    const unsigned char stop = 0;
    while (thread_ && write(pipe_[1], &stop, 1) < 0 && (errno == EINTR || errno == EAGAIN))
      sched_yield(); // full of signals
    thread_.join();
  }

  Catcher(const Catcher &) = delete;
  Catcher &operator=(const Catcher &) = delete;

private:
  void run()
  {
    pollfd in{ .fd = pipe_[0], .events = POLLIN, .revents = 0 };
    for (;;) {
      unsigned char number = 0;
      const int ready = poll(&in, 1, static_cast<int>(TerminationGuard::kLook.count()));
      if (ready > 0 && read(pipe_[0], &number, 1) == 1) {
        if (number == 0)
          return;
        caught_();
        die(number);
      }
      catch_signals(); // those whose handlers the application has dropped
    }
  }

  /// Returns only if the application handles or ignores the signal by now.
  static void die(int number)
  {
    restore(number);
    struct sigaction action
    {
    };
    sigaction(number, nullptr, &action);
    if (!is_default(action)) {
      kill(getpid(), number); // on a thread of the application's
      return;
    }
    // On this thread, at once: one that dumps core is only noted on others.
    sigset_t one;
    sigemptyset(&one);
    sigaddset(&one, number);
    pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
    raise(number);
    pthread_sigmask(SIG_BLOCK, &one, nullptr);
  }

  const std::array<int, 2> pipe_;
  const std::function<void()> caught_;
  Thread thread_;
};

struct Guards
{
  std::mutex catching;               ///< locked before `mutex`; guards pipe and catcher
  std::array<int, 2> pipe{ -1, -1 }; ///< made once
  std::unique_ptr<Catcher> catcher;  ///< while there are guards
  std::mutex mutex;                  ///< guards all
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
    guards.pipe = { -1, -1 };
    guards.all.clear();
  }
  {
    const std::lock_guard lock(guards.mutex);
    guards.all.push_back(&leave_);
  }
  if (guards.catcher || std::getenv("VISUOTACTILE_NO_SIGNALS"))
    return;
  if (guards.pipe[0] >= 0 || pipe2(guards.pipe.data(), O_CLOEXEC | O_NONBLOCK) == 0)
    guards.catcher = std::make_unique<Catcher>(guards.pipe, [&guards] { guards.leave(); });
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
