// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parallel.h"

#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace quality {

void
in_parallel(int threads, std::size_t count, const Work &work, const char *what)
{
  in_parallel_each(
      threads, count, [&] { return work; }, what);
}

void
in_parallel_each(int threads, std::size_t count, const std::function<Work()> &make_work,
                 const char *what)
{
  std::atomic<std::size_t> next{ 0 };
  std::size_t done = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto run = [&] {
    try {
      const Work work = make_work();
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        const std::lock_guard lock(mutex);
        ++done;
        if (what)
          std::fprintf(stderr, "\r%s: %zu of %zu", what, done, count);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < threads; ++i)
      helpers.emplace_back(run);
    run();
  }
  if (what)
    std::fputc('\n', stderr);
  if (failure)
    std::rethrow_exception(failure);
}

} // namespace quality
