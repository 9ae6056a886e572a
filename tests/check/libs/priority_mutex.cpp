// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/priority_mutex.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/realtime.h"

using namespace std::chrono_literals;
using tactor::PriorityCondition;
using tactor::PriorityLock;
using tactor::PriorityMutex;

namespace {

/// A field of /proc/PID/stat, 3 or above (proc(5)).
std::string
field_of(pid_t thread, int number)
{
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  const std::string text{ std::istreambuf_iterator<char>(file), {} };
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string field;
  for (int i = 3; i <= number; i++)
    fields >> field;
  return field;
}

/// The present priority of a thread: −2 for the lowest real-time one, else 0 to 39.
int
priority_of(pid_t thread)
{
  return std::stoi(field_of(thread, 18));
}

} // namespace

/// An ordinary thread that has the mutex runs at the priority of the real-time thread that waits
/// for it, until it gives it back.
CHECK_TEST(test_holder_inherits_priority)
{
  if (!may_be_realtime())
    return;
  PriorityMutex mutex;
  fail_unless(priority_of(gettid()) >= 0);
  mutex.lock();
  std::thread urgent([&] {
    const sched_param parameters{ .sched_priority = 1 };
    fail_unless(sched_setscheduler(0, SCHED_RR, &parameters) == 0);
    const std::lock_guard lock(mutex);
  });
  while (priority_of(gettid()) != -2)
    std::this_thread::yield();
  mutex.unlock();
  fail_unless(priority_of(gettid()) >= 0);
  urgent.join();
}

CHECK_TEST(test_excludes_others)
{
  PriorityMutex mutex;
  int count = 0;
  const auto work = [&] {
    for (int i = 0; i < 20'000; i++) {
      const std::lock_guard lock(mutex);
      count++;
    }
  };
  std::thread one(work);
  std::thread other(work);
  one.join();
  other.join();
  ck_assert_int_eq(count, 40'000);

  // One that comes meanwhile sleeps.
  mutex.lock();
  std::atomic<pid_t> comes{ 0 };
  std::atomic<bool> has_it{ false };
  std::thread late([&] {
    comes = gettid();
    const std::lock_guard lock(mutex);
    has_it = true;
  });
  while (!comes || (field_of(comes, 3) != "S" && !has_it))
    std::this_thread::yield();
  fail_if(has_it);
  mutex.unlock();
  late.join();
  fail_unless(mutex.try_lock());
  std::thread([&] {
    fail_if(mutex.try_lock());
    const auto soon = std::chrono::steady_clock::now() + 5ms;
    fail_if(mutex.try_lock_until(soon));
    fail_unless(std::chrono::steady_clock::now() >= soon);
  }).join();
  mutex.unlock();
  fail_unless(mutex.try_lock_until({})); // nobody has it
  mutex.unlock();
}

CHECK_TEST(test_condition)
{
  PriorityMutex mutex;
  PriorityCondition changed;
  int turn = 0;
  std::thread other([&] {
    PriorityLock lock(mutex);
    for (int i = 0; i < 100; i++) {
      changed.wait(lock, [&] { return turn % 2 == 1; });
      turn++;
      changed.notify_all();
    }
  });
  PriorityLock lock(mutex);
  for (int i = 0; i < 100; i++) {
    turn++;
    changed.notify_all();
    fail_unless(changed.wait_for(lock, 1h, [&] { return turn % 2 == 0; }));
  }
  ck_assert_int_eq(turn, 200);
  lock.unlock();
  other.join();
  lock.lock();
  using Clock = PriorityCondition::Clock;
  fail_unless(changed.wait_until(lock, Clock::time_point(-1s)) == std::cv_status::timeout);
  fail_unless(changed.wait_until(lock, Clock::time_point{}) == std::cv_status::timeout);
  const Clock::time_point soon = Clock::now() + 5ms;
  fail_if(changed.wait_until(lock, soon, [] { return false; }));
  fail_unless(Clock::now() >= soon);
  fail_unless(changed.wait_until(lock, Clock::time_point::max(), [] { return true; }));
}

/// All that wait are woken.
CHECK_TEST(test_all_are_notified)
{
  PriorityMutex mutex;
  PriorityCondition changed;
  int waiting = 0;
  bool is_over = false;
  const auto wait = [&] {
    PriorityLock lock(mutex);
    waiting++;
    changed.wait(lock, [&] { return is_over; });
  };
  std::thread one(wait);
  std::thread other(wait);
  const auto both_wait = [&] {
    const std::lock_guard lock(mutex);
    is_over = waiting == 2;
    return is_over;
  };
  while (!both_wait())
    std::this_thread::yield();
  changed.notify_all();
  one.join();
  other.join();
}

CHECK_MAIN(priority_mutex)
