// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/thread.h"

#include <future>
#include <memory>
#include <string>
#include <utility>

#include "support/contains.h"
#include "support/no_threads.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

using tactor::Thread;

CHECK_TEST(test_joined)
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

/// A thread may destroy its own object. It cannot join itself, so what it runs must live on until
/// it is done.
CHECK_TEST(test_ends_itself)
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

/// Without resources for another thread, nothing is thrown.
CHECK_TEST(test_no_more_threads)
{
  {
    const NoThreads none;
    const tactor::DriverError error = refusal_of(Thread::start([] {}));
    assert_contains(error.text, { "no thread", "ulimit -u" });
  }
  unwrap(Thread::start([] {})).join();
}

CHECK_MAIN(thread)
