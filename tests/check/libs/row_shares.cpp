// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/row_shares.h"
#include "frame/thread_pool.h"

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

#include "support/check_tests.h"

using saliency::RowShares;

namespace {

/// Takes rows for a thread and counts them. Returns whether there were any.
bool
take(RowShares &shares, int thread, std::vector<int> &taken)
{
  const auto rows = shares.take(thread);
  for (int y = rows.begin; y < rows.end; ++y)
    ++taken.at(static_cast<std::size_t>(y));
  return rows.begin < rows.end;
}

bool
each_once(const std::vector<int> &taken)
{
  return std::ranges::all_of(taken, [](int n) { return n == 1; });
}

} // namespace

CHECK_TEST(test_each_row_once)
{
  // Threads of any speed: a random one is next.
  std::mt19937 generator(1);
  RowShares shares;
  for (const int rows : { 1, 7, 8, 135, 1000 })
    for (const int threads : { 1, 2, 3, 8 })
      for (int round = 0; round < 20; ++round) {
        std::vector<int> taken(static_cast<std::size_t>(rows), 0);
        shares.reset(rows, threads);
        std::vector<int> working;
        for (int i = 0; i < threads; ++i)
          working.push_back(i);
        while (!working.empty()) {
          std::uniform_int_distribution<std::size_t> place(0, working.size() - 1);
          const auto who = working.begin() + static_cast<std::ptrdiff_t>(place(generator));
          if (!take(shares, *who, taken))
            working.erase(who);
        }
        fail_unless(each_once(taken), "%d rows, %d threads", rows, threads);
      }
}

CHECK_TEST(test_late_thread)
{
  // While one thread sleeps, the other takes its own half and nearly all of the rest.
  RowShares shares;
  std::vector<int> taken(1000, 0);
  shares.reset(1000, 2);
  while (take(shares, 0, taken)) {
  }
  const auto done = std::ranges::count(taken, 1);
  fail_unless(done > 990 && done <= 1000, "%d rows", static_cast<int>(done));
  while (take(shares, 1, taken)) {
  }
  fail_unless(each_once(taken));
}

CHECK_TEST(test_threads)
{
  saliency::ThreadPool pool;
  RowShares shares;
  for (int round = 0; round < 200; ++round) {
    std::vector<int> taken(500, 0);
    shares.reset(500, 4);
    pool.run(4, [&](int thread) {
      while (take(shares, thread, taken)) {
      }
    });
    fail_unless(each_once(taken));
  }
}

CHECK_MAIN(row_shares)
