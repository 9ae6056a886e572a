// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Helpers for tests of malicious files.
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <sys/resource.h>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/temporary_file.h"

constexpr std::size_t kMiB = std::size_t{ 1 } << 20;

inline std::string
times(std::size_t count, const std::string &text)
{
  std::string all;
  all.reserve(count * text.size());
  for (std::size_t i = 0; i < count; i++)
    all += text;
  return all;
}

/// Limits this process, which runs a single test.
inline void
limit_memory([[maybe_unused]] rlim_t gibibytes = 1)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit limit{ gibibytes * 1024 * kMiB, gibibytes * 1024 * kMiB };
  setrlimit(RLIMIT_AS, &limit);
#endif
}

/// An error message is short, whatever the file contains.
inline void
assert_short(const std::string &reason)
{
  fail_unless(!reason.empty() && reason.size() < 1000, "an error message of %u bytes",
              static_cast<guint>(reason.size()));
}
