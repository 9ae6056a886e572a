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

/// Signals that end a process by default and are no fault of its code.
constexpr std::array kSignals{ SIGHUP,    SIGINT,  SIGQUIT, SIGABRT, SIGPIPE,
                               SIGALRM,   SIGTERM, SIGUSR1, SIGUSR2, SIGPOLL,
                               SIGVTALRM, SIGPROF, SIGXCPU, SIGXFSZ, SIGPWR };

// Data of the handler; process-wide, as a signal's action is.
std::atomic<int> pipe_in{ -1 };
std::atomic<pid_t> owner{ 0 };           ///< a forked process has the handler, but not the thread
std::atomic<bool> abort_is_due{ false }; ///< the motors stand
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free
              && std::atomic<bool>::is_always_lock_free);

constexpr unsigned char kWaits = 0x80; ///< beside a signal's number in the pipe: abort() waits

extern "C" void tactor_on_signal(int number, siginfo_t *info, void *);

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

/// Sets a signal's action if it is one that `may_change`. The present action is read first: an
/// application's own is never replaced, but for a moment if it is set on another thread meanwhile.
/// Async-signal-safe.
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

/// Async-signal-safe.
void
restore(int number)
{
  struct sigaction none
  {
  };
  none.sa_handler = SIG_DFL;
  exchange(number, none, is_ours);
}

/// Async-signal-safe.
extern "C" void
tactor_on_signal(int number, siginfo_t *info, void *)
{
  const int error = errno;
  const int fd = pipe_in;
  const bool is_abort = number == SIGABRT && info->si_code == SI_TKILL;
  const auto byte = static_cast<unsigned char>(is_abort ? number | kWaits : number);
  if (is_abort)
    abort_is_due = false;
  const bool is_written
      = fd >= 0 && owner == getpid() && (write(fd, &byte, 1) == 1 || errno == EAGAIN);
  constexpr auto kWait = std::chrono::milliseconds(TerminationGuard::kPatience);
  for (int i = 0; is_written && is_abort && !abort_is_due && i < kWait.count(); i++)
    poll(nullptr, 0, 1);
  if (!is_written || is_abort) {
    // The default action, once the handler has returned: the core is that of abort()'s thread.
    restore(number);
    raise(number);
  }
  errno = error;
}

/// An abort() that is under way goes on by itself.
void
catch_signals(bool aborts)
{
  struct sigaction ours
  {
  };
  ours.sa_sigaction = tactor_on_signal;
  ours.sa_flags = SA_RESTART | SA_SIGINFO;
  sigfillset(&ours.sa_mask);
  for (const int number : kSignals)
    if (number != SIGABRT || !aborts)
      exchange(number, ours, is_default);
}

/// Catches signals while it lives.
class Catcher
{
public:
  /// `pipe` outlives it: a handler may still write.
  Catcher(const std::array<int, 2> &pipe, std::function<void()> caught, std::function<void()> stays)
      : pipe_(pipe), caught_(std::move(caught)), stays_(std::move(stays))
  {
    tl::expected<Thread, DriverError> thread = Thread::start([this] { run(); });
    if (!thread)
      return; // signals keep their default action
    thread_ = std::move(*thread);
    pipe_in = pipe_[1];
    catch_signals(false);
  }

  ~Catcher()
  {
    const unsigned char stop = 0;
    while (thread_ && write(pipe_[1], &stop, 1) < 0 && (errno == EINTR || errno == EAGAIN))
      sched_yield(); // full of signals
    thread_.join();  // it catches signals
    for (const int number : kSignals)
      restore(number);
    pipe_in = -1;
    abort_is_due = true;
    // Signals that came meanwhile.
    for (unsigned char byte = 0; read(pipe_[0], &byte, 1) == 1;)
      if (byte != 0 && (byte & kWaits) == 0)
        die(byte);
  }

  Catcher(const Catcher &) = delete;
  Catcher &operator=(const Catcher &) = delete;

private:
  void run()
  {
    pollfd in{ .fd = pipe_[0], .events = POLLIN, .revents = 0 };
    bool aborts = false;
    for (;;) {
      unsigned char byte = 0;
      const int ready = poll(&in, 1, static_cast<int>(TerminationGuard::kLook.count()));
      if (ready > 0 && read(pipe_[0], &byte, 1) == 1) {
        if (byte == 0)
          return;
        caught_();
        if ((byte & kWaits) != 0) {
          abort_is_due = aborts = true;
        } else {
          die(byte);
          stays_();
        }
      }
      catch_signals(aborts); // those whose handlers the application has dropped
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
    sigset_t before;
    sigemptyset(&one);
    sigaddset(&one, number);
    pthread_sigmask(SIG_UNBLOCK, &one, &before);
    raise(number);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  const std::array<int, 2> pipe_;
  const std::function<void()> caught_;
  const std::function<void()> stays_; ///< the process goes on
  Thread thread_;
};

struct Guards
{
  std::mutex catching;               ///< locked before `mutex`; guards pipe and catcher
  std::array<int, 2> pipe{ -1, -1 }; ///< made once
  std::unique_ptr<Catcher> catcher;  ///< while there are guards
  std::mutex mutex;                  ///< guards all
  std::vector<const TerminationGuard::Calls *> all;

  void leave()
  {
    const std::lock_guard lock(mutex);
    const auto now = std::chrono::steady_clock::now();
    for (const auto until : { now, now + TerminationGuard::kPatience }) // all begin first
      for (const TerminationGuard::Calls *calls : all)
        calls->leave(until);
  }

  void stay()
  {
    const std::lock_guard lock(mutex);
    for (const TerminationGuard::Calls *calls : all)
      if (calls->stay)
        calls->stay();
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

TerminationGuard::TerminationGuard(Leave leave, std::function<void()> stay)
    : calls_{ std::move(leave), std::move(stay) }
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
    guards.all.push_back(&calls_);
  }
  if (guards.catcher || std::getenv("VISUOTACTILE_NO_SIGNALS"))
    return;
  if (guards.pipe[0] >= 0 || pipe2(guards.pipe.data(), O_CLOEXEC | O_NONBLOCK) == 0)
    guards.catcher = std::make_unique<Catcher>(
        guards.pipe, [&guards] { guards.leave(); }, [&guards] { guards.stay(); });
}

TerminationGuard::~TerminationGuard()
{
  Guards &guards = tactor::guards();
  const std::lock_guard catching(guards.catching);
  bool is_last = false;
  {
    const std::lock_guard lock(guards.mutex);
    std::erase(guards.all, &calls_);
    is_last = guards.all.empty();
  }
  if (is_last)
    guards.catcher.reset();
}

} // namespace tactor
