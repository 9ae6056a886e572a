// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Each case is a process that receives a signal while it has something to release.
#include "tactor/termination.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <functional>
#include <memory>
#include <optional>
#include <poll.h>
#include <sched.h>
#include <string>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/contains.h"

using namespace std::chrono_literals;
using tactor::TerminationGuard;

namespace {

/// What ends a process by default.
constexpr std::array kSignals{
  SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGUSR1, SIGABRT
};

/// In the child of a process with threads, ThreadSanitizer passes over its interceptors, which hand
/// signals to handlers, and refuses to start threads.
#ifdef __SANITIZE_THREAD__
constexpr bool kForksWithThreads = false;
#else
constexpr bool kForksWithThreads = true;
#endif

/// Until a signal ends the process. Not by pause(): ThreadSanitizer holds a signal back that came
/// just before.
[[noreturn]] void
rest()
{
  for (;;)
    poll(nullptr, 0, 10);
}

/// A child process, what it writes and how it ends.
class Process
{
public:
  explicit Process(const std::function<void(Process &)> &act)
  {
    fail_unless(pipe(ends_) == 0 && pipe(permission_) == 0);
    pid_ = fork();
    if (pid_ == 0) {
      close(permission_[1]);
      for (const int number : kSignals)
        std::signal(number, SIG_DFL);
      act(*this);
      std::_Exit(0);
    }
    close(ends_[1]);
    close(permission_[0]);
  }
  ~Process()
  {
    close(ends_[0]);
    permit();
    if (status_)
      return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Process(const Process &) = delete;
  Process &operator=(const Process &) = delete;

  /// In the child: with each thread traced by the parent, which goes on with follow().
  static void be_traced()
  {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    raise(SIGSTOP);
  }
  // In the child
  void say(char c)
  {
    fail_unless(write(ends_[1], &c, 1) == 1);
  }
  /// Writes 'l' when it leaves, which is on each second call.
  std::unique_ptr<TerminationGuard> guard(const std::function<void()> &meanwhile = nullptr)
  {
    return std::make_unique<TerminationGuard>([this, meanwhile, calls = 0](auto) mutable {
      if (++calls % 2 != 0)
        return;
      if (meanwhile)
        meanwhile();
      say('l');
    });
  }
  void wait_for_permission()
  {
    char c = 0;
    static_cast<void>(!read(permission_[0], &c, 1)); // until it is closed
  }
  void wait_for_a_signal()
  {
    say('b');
    rest();
  }

  // In the parent
  char hear()
  {
#ifdef __SANITIZE_THREAD__
    // Its runtime (GCC 12) loses a signal now and then, between the kernel, which has delivered it
    // to the runtime's handler by the trace point signal_deliver, and ours, which is not called.
    // It is sent once more.
    pollfd in{ .fd = ends_[0], .events = POLLIN, .revents = 0 };
    if (sent_ != 0 && poll(&in, 1, 10000) == 0)
      kill(pid_, std::exchange(sent_, 0));
#endif
    char c = 0;
    return read(ends_[0], &c, 1) == 1 ? c : 0; // 0: the process has ended
  }
  void send(int signal)
  {
    fail_unless(kill(pid_, signal) == 0);
    sent_ = signal;
  }
  void permit()
  {
    if (permission_[1] >= 0)
      close(std::exchange(permission_[1], -1));
  }
  /// Runs a process that is traced to its end. The thread that got `signal` last.
  pid_t follow(int signal)
  {
    pid_t last = 0;
    int status = 0;
    fail_unless(waitpid(pid_, &status, 0) == pid_ && WIFSTOPPED(status));
    ptrace(PTRACE_SETOPTIONS, pid_, nullptr, PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    ptrace(PTRACE_CONT, pid_, nullptr, nullptr);
    for (pid_t thread = 0; (thread = waitpid(-1, &status, __WALL)) > 0;) {
      if (WIFSTOPPED(status)) {
        // A new thread, and the one that made it, stop without a signal.
        const int got
            = WSTOPSIG(status) == SIGSTOP || WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
        if (got == signal)
          last = thread;
        ptrace(PTRACE_CONT, thread, nullptr, got);
      } else if (thread == pid_) {
        status_ = status;
        break;
      }
    }
    return last;
  }
  pid_t id() const
  {
    return pid_;
  }
  /// Everything it writes until its end.
  std::string end()
  {
    std::string said;
    while (const char c = hear())
      said += c;
    int status = 0;
    if (!status_ && waitpid(pid_, &status, 0) == pid_)
      status_ = status;
    return said;
  }
  /// Whether this signal killed it.
  bool died_of(int signal) const
  {
    return WIFSIGNALED(*status_) && WTERMSIG(*status_) == signal;
  }

private:
  int ends_[2]{ -1, -1 };
  int permission_[2]{ -1, -1 };
  pid_t pid_ = -1;
  int sent_ = 0;
  std::optional<int> status_;
};

} // namespace

/// Guards leave, then the process dies of the signal.
CHECK_TEST(test_signals)
{
  for (const int signal : kSignals) {
    Process process([](Process &self) {
      const auto guard = self.guard();
      self.wait_for_a_signal();
    });
    fail_unless(process.hear() == 'b');
    process.send(signal);
    assert_text(process.end(), "l");
    fail_unless(process.died_of(signal));
  }
}

/// Any other signals while a way out is under way, in any order and number, end nothing: the motors
/// are stopped, then the process dies of the first one.
CHECK_TEST(test_further_signals)
{
  for (const int first : kSignals)
    for (const int second : kSignals) {
      Process process([](Process &self) {
        const auto guard = self.guard([&self] {
          self.say('w');
          self.wait_for_permission();
        });
        self.wait_for_a_signal();
      });
      fail_unless(process.hear() == 'b');
      process.send(first);
      fail_unless(process.hear() == 'w');
      for (const int further : { second, first, second, SIGTERM })
        process.send(further);
      process.permit();
      assert_text(process.end(), "l");
      fail_unless(process.died_of(first));
    }
}

/// abort() is a signal, too, but ends the process when its handler returns.
CHECK_TEST(test_abort)
{
  for (const bool on_a_thread : { false, true }) {
    Process process([on_a_thread](Process &self) {
      const auto guard = self.guard();
      if (on_a_thread)
        std::thread([] { std::abort(); }).join();
      std::abort();
    });
    assert_text(process.end(), "l");
    fail_unless(process.died_of(SIGABRT));
  }
}

/// The core is that of the thread which called abort(): that one gets the last signal.
CHECK_TEST(test_core_of_abort)
{
  Process process([](Process &self) {
    Process::be_traced();
    const auto guard = self.guard();
    std::abort();
  });
  ck_assert_int_eq(process.follow(SIGABRT), process.id());
  assert_text(process.end(), "l");
  fail_unless(process.died_of(SIGABRT));
}

/// gst-launch-1.0 -e drops its handler at the first Ctrl-C: from then on the signal is caught.
CHECK_TEST(test_application_drops_its_handler)
{
  Process process([](Process &self) {
    static Process *process = nullptr;
    process = &self;
    std::signal(SIGINT, [](int) { process->say('h'); });
    const auto guard = self.guard();
    self.say('b');
    self.wait_for_permission();
    std::signal(SIGINT, SIG_DFL);
    struct sigaction action
    {
    };
    do {
      sigaction(SIGINT, nullptr, &action);
      sched_yield();
    } while (action.sa_handler == SIG_DFL);
    self.wait_for_a_signal();
  });
  fail_unless(process.hear() == 'b');
  process.send(SIGINT);
  fail_unless(process.hear() == 'h');
  process.permit();
  fail_unless(process.hear() == 'b');
  process.send(SIGINT);
  assert_text(process.end(), "l");
  fail_unless(process.died_of(SIGINT));
}

/// An application that handles the signal when the motors have been stopped goes on, which is told,
/// and is as well guarded as before.
CHECK_TEST(test_application_handles_it_meanwhile)
{
  Process process([](Process &self) {
    static Process *process = nullptr;
    process = &self;
    const auto guard = self.guard([] { std::signal(SIGTERM, [](int) { process->say('h'); }); });
    const TerminationGuard told([](auto) {}, [&self] { self.say('s'); });
    self.wait_for_a_signal();
  });
  fail_unless(process.hear() == 'b');
  process.send(SIGTERM);
  fail_unless(process.hear() == 'l');
  const std::array said{ process.hear(), process.hear() }; // on two threads
  const std::string both{ said.begin(), said.end() };
  fail_unless(both == "hs" || both == "sh", "%s", both.c_str());
  process.send(SIGHUP);
  assert_text(process.end(), "l");
  fail_unless(process.died_of(SIGHUP));
}

/// All guards leave at the same time: each begins before the first one is waited for.
CHECK_TEST(test_all_guards_leave)
{
  Process process([](Process &self) {
    const auto say = [&self](char begin, char done) {
      return [&self, begin, done, calls = 0](auto) mutable {
        self.say(++calls == 1 ? begin : done);
      };
    };
    const TerminationGuard first(say('1', 'a'));
    const TerminationGuard second(say('2', 'b'));
    self.wait_for_a_signal();
  });
  fail_unless(process.hear() == 'b');
  process.send(SIGTERM);
  assert_text(process.end(), "12ab");
}

CHECK_TEST(test_exit)
{
  Process process([](Process &self) {
    const auto guard = self.guard();
    std::exit(3);
  });
  assert_text(process.end(), "l");
}

/// A handler of the application, or its wish to ignore a signal, takes precedence, whether set
/// before or after. The environment can disable all handling.
CHECK_TEST(test_application_takes_precedence)
{
  Process ignores([](Process &self) {
    std::signal(SIGTERM, SIG_IGN);
    const auto guard = self.guard();
    self.wait_for_a_signal();
  });
  fail_unless(ignores.hear() == 'b');
  ignores.send(SIGTERM);
  ignores.send(SIGKILL);
  assert_text(ignores.end(), "");
  fail_unless(ignores.died_of(SIGKILL));

  for (const bool before : { true, false }) {
    Process handles([before](Process &self) {
      static Process *process = nullptr;
      process = &self;
      const auto handle = [] {
        std::signal(SIGTERM, [](int) {
          process->say('h');
          std::_Exit(0);
        });
      };
      if (before)
        handle();
      const auto guard = self.guard();
      if (!before)
        handle();
      self.wait_for_a_signal();
    });
    fail_unless(handles.hear() == 'b');
    handles.send(SIGTERM);
    assert_text(handles.end(), "h");
  }

  Process refuses([](Process &self) {
    setenv("VISUOTACTILE_NO_SIGNALS", "1", 1);
    const auto guard = self.guard();
    self.wait_for_a_signal();
  });
  fail_unless(refuses.hear() == 'b');
  refuses.send(SIGTERM);
  assert_text(refuses.end(), "");
  fail_unless(refuses.died_of(SIGTERM));
}

/// Without guards the signal handlers are as before. The same holds after new ones.
CHECK_TEST(test_handlers_are_restored)
{
  Process process([](Process &self) {
    for (int i = 0; i < 3; i++) {
      auto first = self.guard();
      auto second = self.guard();
      first.reset();
      struct sigaction action
      {
      };
      sigaction(SIGTERM, nullptr, &action);
      self.say(action.sa_handler == SIG_DFL ? 'd' : 'c');
      second.reset();
      sigaction(SIGTERM, nullptr, &action);
      self.say(action.sa_handler == SIG_DFL ? 'd' : 'c');
    }
    self.wait_for_a_signal();
  });
  for (const char c : std::string("cdcdcdb"))
    fail_unless(process.hear() == c);
  process.send(SIGTERM);
  assert_text(process.end(), "");
  fail_unless(process.died_of(SIGTERM));
}

namespace {

// Where the catcher's thread is while the main thread ends it: about to catch signals once more.
std::atomic<bool> catches_late{ false };
std::atomic<bool> has_come{ false };
std::atomic<bool> is_awaited{ false };

} // namespace

extern "C" int
sigaction(int number, const struct sigaction *action, struct sigaction *before) noexcept
{
  static const auto next = reinterpret_cast<decltype(&sigaction)>(dlsym(RTLD_NEXT, "sigaction"));
  if (catches_late && gettid() != getpid()) {
    has_come = true;
    while (!is_awaited)
      sched_yield();
  }
  return next(number, action, before);
}

extern "C" int
pthread_join(pthread_t thread, void **result)
{
  static const auto next
      = reinterpret_cast<decltype(&pthread_join)>(dlsym(RTLD_NEXT, "pthread_join"));
  is_awaited = true;
  return next(thread, result);
}

/// Whatever the thread is about to do when the last guard goes.
CHECK_TEST(test_handlers_are_restored_last)
{
  Process process([](Process &self) {
    auto guard = self.guard();
    is_awaited = false;
    catches_late = true;
    while (!has_come)
      sched_yield();
    guard.reset();
    catches_late = false;
    struct sigaction action
    {
    };
    sigaction(SIGTERM, nullptr, &action);
    self.say(action.sa_handler == SIG_DFL ? 'd' : 'c');
  });
  assert_text(process.end(), "d");
}

/// A forked child has the handler but nothing to leave, and its parent plays on.
CHECK_LOOP_TEST(test_children, 0, kForksWithThreads)
{
  Process process([](Process &self) {
    const auto guard = self.guard();
    const pid_t child = fork();
    if (child == 0)
      rest();
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0);
    self.say(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM ? 'd' : 'x');
    self.wait_for_a_signal();
  });
  fail_unless(process.hear() == 'd');
  fail_unless(process.hear() == 'b');
  process.send(SIGTERM);
  assert_text(process.end(), "l");
}

/// A child with a guard of its own leaves only that, and its parent plays on.
CHECK_LOOP_TEST(test_children_with_boards, 0, kForksWithThreads)
{
  Process process([](Process &self) {
    const auto guard = self.guard();
    int ready[2];
    fail_unless(pipe(ready) == 0);
    const pid_t child = fork();
    if (child == 0) {
      const auto own = self.guard();
      fail_unless(write(ready[1], "r", 1) == 1);
      rest();
    }
    char c = 0;
    fail_unless(read(ready[0], &c, 1) == 1);
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0); // it has written 'l' by now
    self.say(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM ? 'd' : 'x');
    self.wait_for_a_signal();
  });
  for (const char c : std::string("ldb"))
    fail_unless(process.hear() == c);
  process.send(SIGTERM);
  assert_text(process.end(), "l");
}

/// A guard may take kPatience at most.
CHECK_TEST(test_time_limit)
{
  Process process([](Process &self) {
    const TerminationGuard guard([&, calls = 0](auto until) mutable {
      if (++calls == 1)
        return;
      self.say('w');
      std::this_thread::sleep_until(until);
    });
    self.wait_for_a_signal();
  });
  fail_unless(process.hear() == 'b');
  process.send(SIGTERM);
  fail_unless(process.hear() == 'w');
  assert_text(process.end(), "");
  fail_unless(process.died_of(SIGTERM));
}

CHECK_MAIN(termination)
