// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/thread_pool.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include <gst/check/gstcheck.h>

using saliency::ThreadPool;

GST_START_TEST(test_each_part_once)
{
  ThreadPool pool;
  for (const int parts : { 0, 1, 2, 7, 3, 1, 7 })
    for (int i = 0; i < 200; ++i) {
      std::vector<int> done(static_cast<std::size_t>(parts), 0);
      pool.run(parts, [&done](int part) { done[static_cast<std::size_t>(part)]++; });
      fail_unless(std::ranges::all_of(done, [](int n) { return n == 1; }));
    }
}
GST_END_TEST;

GST_START_TEST(test_exceptions)
{
  // Whichever part throws, the caller hears of it, the others are done, and the pool goes on.
  ThreadPool pool;
  for (int thrower = 0; thrower < 5; ++thrower) {
    std::array<int, 5> done{};
    bool caught = false;
    try {
      pool.run(5, [&](int part) {
        done[static_cast<std::size_t>(part)]++;
        if (part == thrower)
          throw std::runtime_error("part");
      });
    } catch (const std::runtime_error &) {
      caught = true;
    }
    fail_unless(caught);
    fail_unless(std::ranges::all_of(done, [](int n) { return n == 1; }));
    pool.run(5, [&](int part) { done[static_cast<std::size_t>(part)]++; });
    fail_unless(std::ranges::all_of(done, [](int n) { return n == 2; }));
  }
}
GST_END_TEST;

GST_START_TEST(test_pools_that_do_nothing)
{
  for (int i = 0; i < 50; ++i) {
    ThreadPool unused;
    ThreadPool once;
    once.run(3, [](int) {});
  }
}
GST_END_TEST;

static Suite *
thread_pool_suite(void)
{
  Suite *suite = suite_create("thread_pool");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_each_part_once);
  tcase_add_test(tc, test_exceptions);
  tcase_add_test(tc, test_pools_that_do_nothing);
  return suite;
}

GST_CHECK_MAIN(thread_pool);
