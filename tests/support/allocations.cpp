// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace {

std::atomic<std::uint64_t> bytes{ 0 };
thread_local std::uint64_t calls = 0;

} // namespace

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CAN_COUNT

namespace {

void
count(std::size_t size)
{
  bytes.fetch_add(size, std::memory_order_relaxed);
  calls++;
}

} // namespace

// Replacements call glibc's own ("Replacing malloc" in its manual). operator new of libstdc++ and
// OpenCV's fastMalloc end here. free() stays glibc's.
extern "C" {
void *__libc_malloc(std::size_t size);
void *__libc_calloc(std::size_t number, std::size_t size);
void *__libc_realloc(void *block, std::size_t size);
void *__libc_memalign(std::size_t alignment, std::size_t size);

__attribute__((visibility("default"))) void *
malloc(std::size_t size) noexcept
{
  count(size);
  return __libc_malloc(size);
}

__attribute__((visibility("default"))) void *
calloc(std::size_t number, std::size_t size) noexcept
{
  count(number * size);
  return __libc_calloc(number, size);
}

__attribute__((visibility("default"))) void *
realloc(void *block, std::size_t size) noexcept
{
  count(size);
  return __libc_realloc(block, size);
}

__attribute__((visibility("default"))) void *
memalign(std::size_t alignment, std::size_t size) noexcept
{
  count(size);
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) void *
aligned_alloc(std::size_t alignment, std::size_t size) noexcept
{
  return memalign(alignment, size);
}

__attribute__((visibility("default"))) int
posix_memalign(void **block, std::size_t alignment, std::size_t size) noexcept
{
  *block = memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
}
#endif

namespace allocations {

bool
are_counted()
{
#ifdef CAN_COUNT
  return true;
#else
  return false;
#endif
}

std::uint64_t
bytes_of_all_threads()
{
  return bytes.load(std::memory_order_relaxed);
}

std::uint64_t
of_this_thread()
{
  return calls;
}

} // namespace allocations
