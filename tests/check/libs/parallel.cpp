// SPDX-License-Identifier: LGPL-2.1-or-later
#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "quality/parallel.h"

#include "support/check_tests.h"

CHECK_TEST(test_each_once)
{
  for (const int threads : { 1, 3 }) {
    std::vector<std::atomic<int>> calls(20);
    quality::in_parallel(threads, calls.size(), [&](std::size_t i) { ++calls[i]; });
    for (const auto &number : calls)
      ck_assert_int_eq(number, 1);
  }
}

CHECK_TEST(test_own_work)
{
  // No thread uses the work of another.
  std::atomic<int> works{ 0 };
  std::atomic<int> sum{ 0 };
  quality::in_parallel_each(3, 1000, [&]() -> quality::Work {
    ++works;
    return [&sum, calls = std::make_shared<int>(0)](std::size_t) {
      ++*calls;
      ++sum;
    };
  });
  ck_assert_int_eq(works, 3);
  ck_assert_int_eq(sum, 1000);
}

CHECK_TEST(test_failure)
{
  for (const int threads : { 1, 3 })
    for (const bool making : { false, true }) {
      std::string message;
      try {
        quality::in_parallel_each(threads, 100, [&]() -> quality::Work {
          if (making)
            throw std::runtime_error("no work");
          return [](std::size_t i) {
            if (i == 4)
              throw std::runtime_error("no film 4");
          };
        });
      } catch (const std::exception &problem) {
        message = problem.what();
      }
      ck_assert_str_eq(message.c_str(), making ? "no work" : "no film 4");
    }
}

CHECK_MAIN(parallel)
