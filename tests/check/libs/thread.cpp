// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/thread.h"

#include <future>
#include <memory>
#include <string>
#include <utility>

#include "support/contains.h"
#include "support/no_threads.h"
#include "support/unwrap.h"

using tactor::Thread;

GST_START_TEST(test_joined)
{
  bool done = false;
  Thread moved;
  fail_if(moved);
  moved.join();
  {
    Thread thread = unwrap(Thread::start([&] { done = true; }));
    moved = std::move(thread);
    // cppcheck-suppress accessMoved ; it is empty then
    fail_unless(!thread && !moved.is_current());
  }
  fail_unless(moved);
  moved.join();
  fail_unless(done && !moved);

  done = false;
  moved = unwrap(Thread::start([&] { done = true; }));
  moved = Thread(); // this joins, too
  fail_unless(done);
}
GST_END_TEST;

/// A thread may destroy its own object. It cannot join itself, so what it runs must live on until
/// it is done.
GST_START_TEST(test_ends_itself)
{
  std::promise<void> owned;
  std::promise<std::string> done;
  auto owner = std::make_unique<Thread>();
  const std::string text(100, 'x'); // too long for the small string optimization
  *owner = unwrap(Thread::start([&owner, &owned, &done, text] {
    owned.get_future().wait();
    owner.reset();
    done.set_value(text);
  }));
  owned.set_value();
  ck_assert_uint_eq(done.get_future().get().size(), text.size());
}
GST_END_TEST;

/// Without resources for another thread, nothing is thrown.
GST_START_TEST(test_no_more_threads)
{
  {
    const NoThreads none;
    const tactor::DriverError error = refusal_of(Thread::start([] {}));
    assert_contains(error.text, { "no thread", "ulimit -u" });
  }
  unwrap(Thread::start([] {})).join();
}
GST_END_TEST;

static Suite *
thread_suite(void)
{
  Suite *suite = suite_create("thread");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_joined);
  tcase_add_test(tests, test_ends_itself);
  tcase_add_test(tests, test_no_more_threads);
  return suite;
}

GST_CHECK_MAIN(thread)
