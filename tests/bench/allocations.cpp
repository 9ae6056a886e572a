// SPDX-License-Identifier: LGPL-2.1-or-later
#include "allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace {

std::atomic<std::uint64_t> bytes{ 0 };

} // namespace

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CAN_COUNT

// glibc's own, which those below stand before ("Replacing malloc" in its manual).
extern "C" {
void *__libc_malloc(std::size_t size);
void *__libc_calloc(std::size_t count, std::size_t size);
void *__libc_realloc(void *block, std::size_t size);
void *__libc_memalign(std::size_t alignment, std::size_t size);

__attribute__((visibility("default"))) void *
malloc(std::size_t size)
{
  bytes.fetch_add(size, std::memory_order_relaxed);
  return __libc_malloc(size);
}

__attribute__((visibility("default"))) void *
calloc(std::size_t count, std::size_t size)
{
  bytes.fetch_add(count * size, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}

__attribute__((visibility("default"))) void *
realloc(void *block, std::size_t size)
{
  bytes.fetch_add(size, std::memory_order_relaxed);
  return __libc_realloc(block, size);
}

__attribute__((visibility("default"))) void *
aligned_alloc(std::size_t alignment, std::size_t size)
{
  bytes.fetch_add(size, std::memory_order_relaxed);
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) int
posix_memalign(void **block, std::size_t alignment, std::size_t size)
{
  bytes.fetch_add(size, std::memory_order_relaxed);
  *block = __libc_memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
}
#endif

namespace bench {

bool
counts_allocations()
{
#ifdef CAN_COUNT
  return true;
#else
  return false;
#endif
}

std::uint64_t
allocated_bytes()
{
  return bytes.load(std::memory_order_relaxed);
}

} // namespace bench
