// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/thread_pool.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <sched.h>
#include <sys/resource.h>

#include "support/check_tests.h"

using saliency::ThreadPool;

CHECK_TEST(test_each_part_once)
{
  ThreadPool pool;
  for (const int parts : { 0, 1, 2, 7, 3, 1, 7 })
    for (int i = 0; i < 200; ++i) {
      std::vector<int> done(static_cast<std::size_t>(parts), 0);
      pool.run(parts, [&done](int part) { done[static_cast<std::size_t>(part)]++; });
      fail_unless(std::ranges::all_of(done, [](int n) { return n == 1; }));
    }
}

CHECK_TEST(test_exceptions)
{
  // Whichever part throws, the caller gets the exception, the other parts are done, and the pool
  // stays usable.
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

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
static std::atomic<int> thrown = 0;

/// Replaces libstdc++'s function to count exceptions.
extern "C" void *
__cxa_allocate_exception(std::size_t size) noexcept
{
  using Allocate = void *(*)(std::size_t);
  static const auto original
      = reinterpret_cast<Allocate>(dlsym(RTLD_NEXT, "__cxa_allocate_exception"));
  ++thrown;
  return original(size);
}

CHECK_TEST(test_no_more_threads)
{
  // Without memory for a stack the caller does all parts, and nothing is thrown.
  rlimit before;
  fail_unless_equals_int(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit none{ 1, before.rlim_max };
  std::array<int, 5> done{};
  ThreadPool pool;
  pool.run(1, [&done](int part) { done[static_cast<std::size_t>(part)]++; });
  fail_unless_equals_int(setrlimit(RLIMIT_AS, &none), 0);
  const int thrown_before = thrown;
  pool.run(5, [&done](int part) { done[static_cast<std::size_t>(part)]++; });
  fail_unless_equals_int(setrlimit(RLIMIT_AS, &before), 0);
  fail_unless_equals_int(thrown, thrown_before);
  fail_unless((done == std::array{ 2, 1, 1, 1, 1 }));
  pool.run(5, [&done](int part) { done[static_cast<std::size_t>(part)]++; });
  fail_unless((done == std::array{ 3, 2, 2, 2, 2 }));
}
#endif

CHECK_TEST(test_idle_pools)
{
  for (int i = 0; i < 50; ++i) {
    ThreadPool unused;
    ThreadPool once;
    once.run(3, [](int) {});
  }
}

CHECK_TEST(test_teams)
{
  // Parts are contiguous and about equally long, also with fewer items than threads.
  ThreadPool pool;
  for (const saliency::Team &team :
       { saliency::Team(), saliency::Team(pool, 1), saliency::Team(pool, 3) })
    for (const int count : { 0, 1, 2, 3, 10, 11 }) {
      std::vector<std::pair<int, int>> parts(static_cast<std::size_t>(team.threads()));
      team.share(count, [&parts](int part, int begin, int end) {
        parts[static_cast<std::size_t>(part)] = { begin, end };
      });
      int next = 0;
      for (const auto &[begin, end] : parts) {
        ck_assert_int_eq(begin, next);
        fail_unless(std::abs((end - begin) * team.threads() - count) < team.threads());
        next = end;
      }
      ck_assert_int_eq(next, count);

      std::vector<int> done(static_cast<std::size_t>(count), 0);
      team.each(count, [&done](int i) { done[static_cast<std::size_t>(i)]++; });
      fail_unless(std::ranges::all_of(done, [](int n) { return n == 1; }));
    }
}

/// Parts wait for each other, so each has a thread of its own. Then each does `work`.
template <typename Work>
static void
run_on_threads(ThreadPool &pool, int threads, const Work &work)
{
  std::atomic<int> there = 0;
  pool.run(threads, [&](int part) {
    ++there;
    while (there < threads)
      std::this_thread::yield();
    work(part);
  });
}

CHECK_TEST(test_sleeping_threads_are_woken)
{
  // Idle workers sleep and are woken, and a sleeping caller is woken by them.
  ThreadPool pool;
  for (int i = 0; i < 20; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    run_on_threads(pool, 2, [begin](int part) {
      if (part == 1)
        while (std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(2))
          std::this_thread::yield();
    });
  }
}

#ifdef __linux__
static std::atomic<int> callers_processor;

/// Replaces glibc's function: the scheduler may move the caller at any time.
extern "C" int
sched_getcpu() noexcept
{
  return callers_processor;
}

static cpu_set_t
own_processors()
{
  cpu_set_t own;
  ck_assert_int_eq(sched_getaffinity(0, sizeof own, &own), 0);
  return own;
}

static void
move_to(const cpu_set_t &processors)
{
  ck_assert_int_eq(sched_setaffinity(0, sizeof processors, &processors), 0);
}

/// Whether all of the pool's threads may run on exactly these CPUs while they work.
static bool
are_on(ThreadPool &pool, int threads, const cpu_set_t &expected)
{
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> elsewhere = 0;
  run_on_threads(pool, threads, [&](int) {
    const cpu_set_t own = own_processors();
    if (std::this_thread::get_id() != caller && !CPU_EQUAL(&own, &expected))
      ++elsewhere;
  });
  return elsewhere == 0;
}

CHECK_TEST(test_off_the_callers_processor)
{
  const cpu_set_t all = own_processors();
  const auto others = [&all](int processor) {
    cpu_set_t set = all;
    if (CPU_COUNT(&all) > 1)
      CPU_CLR(processor, &set);
    return set;
  };
  ThreadPool moved;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(processor, &all))
      continue;
    callers_processor = processor;
    fail_unless(are_on(moved, 3, others(processor)),
                "a worker stayed on CPU %d after the caller moved there", processor);

    ThreadPool pool;
    fail_unless(are_on(pool, 2, others(processor)));
    fail_unless(are_on(pool, 4, others(processor)), "a new worker is on the caller's CPU %d",
                processor);

    // With a single CPU they share it with the caller, until there are others again.
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    move_to(one);
    fail_unless(are_on(pool, 4, one));
    move_to(all);
    fail_unless(are_on(pool, 4, others(processor)));

    // Where the caller's CPU is unknown they stay where they are.
    callers_processor = -1;
    fail_unless(are_on(pool, 4, others(processor)));
  }
}
#endif

CHECK_MAIN(thread_pool)
