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
#include "support/realtime.h"
#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;
using tactor::PriorityCondition;
using tactor::PriorityLock;
using tactor::PriorityMutex;

namespace {

/// The present priority of a thread: −2 for the lowest real-time one, else 0 to 39 (proc(5)).
int
priority_of(pid_t thread)
{
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  const std::string text{ std::istreambuf_iterator<char>(file), {} };
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string field;
  for (int i = 3; i <= 18; i++)
    fields >> field;
  return std::stoi(field);
}

} // namespace

/// An ordinary thread that has the mutex runs at the priority of the real-time thread that waits
/// for it, until it gives it back.
GST_START_TEST(test_holder_inherits_priority)
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
GST_END_TEST;

GST_START_TEST(test_excludes_others)
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
GST_END_TEST;

GST_START_TEST(test_condition)
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
GST_END_TEST;

static Suite *
priority_mutex_suite(void)
{
  Suite *suite = suite_create("priority_mutex");
  TCase *cases = tcase_create("general");
  tcase_add_test(cases, test_holder_inherits_priority);
  tcase_add_test(cases, test_excludes_others);
  tcase_add_test(cases, test_condition);
  suite_add_tcase(suite, cases);
  return suite;
}

GST_CHECK_MAIN(priority_mutex);
