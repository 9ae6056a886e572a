// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Threads that request real-time scheduling, checked against the kernel. The requesting thread
// drops its privilege, the test keeps it.
#include "tactor/realtime/realtime_thread.h"

#include <gio/gio.h>
#include <gio/gunixsocketaddress.h>
#include <glib/gstdio.h>

#include <linux/capability.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <latch>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "fake_realtime_kit.h"
#include "support/check_tests.h"

using std::chrono::milliseconds;
using tactor::CpuBudget;
using tactor::RealtimeThread;
using tactor::Scheduling;
using tactor::Time;

namespace {

/// Drops this thread's right to raise priorities (CAP_SYS_NICE). Capabilities are per thread.
void
become_ordinary()
{
  __user_cap_header_struct header{ _LINUX_CAPABILITY_VERSION_3, 0 };
  __user_cap_data_struct data[2] = {};
  fail_unless(syscall(SYS_capget, &header, data) == 0);
  data[0].effective &= ~(1u << CAP_SYS_NICE);
  data[0].permitted &= ~(1u << CAP_SYS_NICE);
  data[0].inheritable &= ~(1u << CAP_SYS_NICE);
  fail_unless(syscall(SYS_capset, &header, data) == 0);
}

/// Sets the limit that `ulimit -r` and limits.d set. False if it may not be set.
bool
allow_priority(rlim_t most)
{
  const rlimit limit{ most, most };
  return setrlimit(RLIMIT_RTPRIO, &limit) == 0;
}

/// A thread that requests real-time scheduling and stores the answer.
class Asker
{
public:
  explicit Asker(bool wanted = true, bool ordinary = true)
  {
    thread_ = std::thread([this, wanted, ordinary] { run(wanted, ordinary); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return id_ != 0; });
  }
  ~Asker()
  {
    end();
  }
  /// Waits for the answer.
  std::pair<Scheduling, std::string> answer()
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return told_.has_value(); });
    return *told_;
  }
  bool has_answer()
  {
    std::lock_guard lock(mutex_);
    return told_.has_value();
  }
  int policy() const
  {
    return policy_of(id_);
  }
  int priority() const
  {
    sched_param parameters{};
    sched_getparam(id_, &parameters);
    return parameters.sched_priority;
  }
  pid_t id() const
  {
    return id_;
  }
  /// Makes the thread spin until its scheduling changes.
  void spin()
  {
    std::unique_lock lock(mutex_);
    told_.reset();
    spin_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return told_.has_value(); });
  }
  /// The thread's policy after it has given up real-time scheduling.
  int end()
  {
    {
      std::lock_guard lock(mutex_);
      quit_ = true;
      changed_.notify_all();
    }
    if (thread_.joinable())
      thread_.join();
    return last_;
  }

private:
  void run(bool wanted, bool ordinary)
  {
    if (ordinary)
      become_ordinary();
    {
      RealtimeThread realtime(wanted, [this](Scheduling scheduling, const std::string &text) {
        std::lock_guard lock(mutex_);
        told_.emplace(scheduling, text);
        changed_.notify_all();
      });
      std::unique_lock lock(mutex_);
      id_ = gettid();
      changed_.notify_all();
      changed_.wait(lock, [this] { return spin_ || quit_; });
      while (!quit_ && !told_) {
        lock.unlock();
        realtime.turn();
        lock.lock();
      }
      changed_.wait(lock, [this] { return quit_; });
    }
    last_ = policy_of(0);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::pair<Scheduling, std::string>> told_;
  std::atomic<pid_t> id_ = 0;
  bool spin_ = false;
  bool quit_ = false;
  int last_ = -1;
  std::thread thread_;
};

/// Whether this process lacks the right to make threads real-time, which the test needs.
bool
skipped()
{
  const bool may = may_be_realtime();
  if (!may)
    g_print("this process may not make threads real-time: skipped\n");
  return !may;
}

} // namespace

/// Permitted by the resource limit, where the test may set it, else by the capability. The object's
/// end reverts it.
CHECK_TEST(test_direct)
{
  if (skipped())
    return;
  Asker asker(true, allow_priority(1));
  fail_unless(asker.answer().first == Scheduling::direct);
  ck_assert_int_eq(asker.policy(), SCHED_RR);
  ck_assert_int_eq(asker.priority(), 1);
  fail_unless(time_limit().rlim_max == RLIM_INFINITY); // left to the process
  ck_assert_int_eq(asker.end(), SCHED_OTHER);
}

CHECK_TEST(test_not_wanted)
{
  Asker asker(false, false);
  fail_unless(asker.answer().first == Scheduling::normal);
  ck_assert_int_eq(asker.policy(), SCHED_OTHER);
}

/// Sets the limit on CPU time that RealtimeKit requires. It is kept for the next thread.
CHECK_TEST(test_realtime_kit)
{
  if (skipped())
    return;
  allow_priority(0);
  Bus bus(Bus::Service::grants);
  for (int i = 0; i < 2; i++) {
    Asker asker;
    const auto [scheduling, text] = asker.answer();
    fail_unless(scheduling == Scheduling::realtime_kit, "%s", text.c_str());
    ck_assert_str_eq(text.c_str(), "by RealtimeKit, at most 200 ms of CPU time at once");
    ck_assert_int_eq(asker.policy(), SCHED_RR);
    ck_assert_int_eq(asker.priority(), 1);
    ck_assert_uint_eq(time_limit().rlim_cur, kMostTime);
    ck_assert_uint_eq(time_limit().rlim_max, kMostTime);
    ck_assert_int_eq(asker.end(), SCHED_OTHER);
  }
}

/// A lower limit is not raised.
CHECK_TEST(test_limit_is_never_raised)
{
  if (skipped())
    return;
  allow_priority(0);
  const rlimit low{ 50000, 100000 };
  setrlimit(RLIMIT_RTTIME, &low);
  Bus bus(Bus::Service::grants);
  Asker asker;
  fail_unless(asker.answer().first == Scheduling::realtime_kit);
  ck_assert_uint_eq(time_limit().rlim_cur, 50000);
  ck_assert_uint_eq(time_limit().rlim_max, 100000);
}

/// The limit would apply to the application's real-time threads, too, and kill the process. So it
/// is not set if there are any.
CHECK_TEST(test_other_realtime_threads)
{
  if (skipped())
    return;
  allow_priority(0);
  std::latch ready(1);
  std::latch checked(1);
  std::thread other([&] {
    const sched_param parameters{ .sched_priority = 5 };
    sched_setscheduler(0, SCHED_FIFO, &parameters);
    ready.count_down();
    checked.wait();
  });
  ready.wait();
  Bus bus(Bus::Service::grants);
  Asker asker;
  const auto [scheduling, text] = asker.answer();
  fail_unless(scheduling == Scheduling::normal);
  fail_unless(text.find("other threads of this process are real-time") != std::string::npos, "%s",
              text.c_str());
  ck_assert_int_eq(asker.policy(), SCHED_OTHER);
  fail_unless(time_limit().rlim_max == RLIM_INFINITY);
  checked.count_down();
  other.join();
}

/// No service, or one that refuses: the thread runs at normal priority and reports why.
CHECK_TEST(test_no_service)
{
  allow_priority(0);
  g_unsetenv("DBUS_SESSION_BUS_ADDRESS");
  g_setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent/bus", TRUE);
  const auto check = [](const char *why) {
    Asker asker;
    const auto [scheduling, text] = asker.answer();
    fail_unless(scheduling == Scheduling::normal);
    fail_unless(text.find("RLIMIT_RTPRIO") != std::string::npos, "%s", text.c_str());
    fail_unless(text.find(why) != std::string::npos, "%s", text.c_str());
    ck_assert_int_eq(asker.policy(), SCHED_OTHER);
  };
  check("No such file or directory");
  {
    const Bus bus(Bus::Service::none);
    check("org.freedesktop.RealtimeKit1 was not provided");
  }
  const Bus bus(Bus::Service::refuses);
  check("not for you");
}

/// A service or a bus that never answers blocks nothing: the request is canceled with the thread.
/// An answer would mean a time-out.
CHECK_TEST(test_service_that_never_answers)
{
  allow_priority(0);
  {
    Bus bus(Bus::Service::silent);
    Asker asker;
    ck_assert_int_eq(bus.asked(), asker.id());
    asker.end();
    fail_if(asker.has_answer());
  }
  g_unsetenv("DBUS_SESSION_BUS_ADDRESS");
  g_autofree gchar *folder = g_dir_make_tmp(nullptr, nullptr);
  g_autofree gchar *path = g_build_filename(folder, "bus", nullptr);
  g_autofree gchar *address = g_strdup_printf("unix:path=%s", path);
  g_setenv("DBUS_SYSTEM_BUS_ADDRESS", address, TRUE);
  g_autoptr(GSocketListener) listener = g_socket_listener_new();
  g_autoptr(GSocketAddress) where = g_unix_socket_address_new(path);
  fail_unless(g_socket_listener_add_address(listener, where, G_SOCKET_TYPE_STREAM,
                                            G_SOCKET_PROTOCOL_DEFAULT, nullptr, nullptr, nullptr));
  {
    Asker asker;
    g_autoptr(GSocketConnection) line
        = g_socket_listener_accept(listener, nullptr, nullptr, nullptr);
    fail_unless(line != nullptr);
    asker.end();
    fail_if(asker.has_answer());
  }
  g_unlink(path);
  g_rmdir(folder);
}

/// A quarter of the time, with bursts of 50 ms.
CHECK_TEST(test_cpu_budget)
{
  constexpr Time kStart = std::chrono::hours(5);
  // 24 of every 100 ms, for an hour.
  CpuBudget busy(kStart, Time(0));
  for (int i = 1; i <= 36000; i++)
    fail_unless(busy.allows(kStart + i * milliseconds(100), i * milliseconds(24)));
  // 26 of every 100 ms exceed the quarter by 1 ms each, so a burst allowance of 50 ms lasts at most
  // 50 rounds.
  CpuBudget greedy(kStart, Time(0));
  int turns = 0;
  while (greedy.allows(kStart + (turns + 1) * milliseconds(100), (turns + 1) * milliseconds(26)))
    turns++;
  ck_assert_int_ge(turns, 24);
  ck_assert_int_le(turns, 50);
  // All of the time: x ms are used while 50 + x / 4 are allowed, so x = 66.7.
  CpuBudget runaway(kStart, Time(0));
  int used = 0;
  while (runaway.allows(kStart + milliseconds(used), milliseconds(used)))
    used++;
  ck_assert_int_ge(used, 50);
  ck_assert_int_le(used, 67);
  // Unused time is not saved up.
  CpuBudget rested(kStart, Time(0));
  fail_unless(rested.allows(kStart + std::chrono::hours(1), milliseconds(50)));
  fail_if(rested.allows(kStart + std::chrono::hours(1), milliseconds(101)));
}

/// A runaway thread loses its priority before it starves others.
CHECK_TEST(test_runaway)
{
  if (skipped())
    return;
  Asker asker(true, allow_priority(1));
  fail_unless(asker.answer().first == Scheduling::direct);
  asker.spin();
  fail_unless(asker.answer().first == Scheduling::given_back);
  ck_assert_int_eq(asker.policy(), SCHED_OTHER);
}

CHECK_MAIN(realtime_thread)
