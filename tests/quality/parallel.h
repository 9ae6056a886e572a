// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace quality {

using Work = std::function<void(std::size_t)>;

/// Calls work(0), work(1), … work(count − 1) on `threads` ≥ 1 threads, each call once. Rethrows an
/// exception of one of them after all threads have ended. `what`, if any, stands before the number
/// of finished calls on standard error.
void in_parallel(int threads, std::size_t count, const Work &work, const char *what = nullptr);

/// The same where each thread makes a work of its own.
void in_parallel_each(int threads, std::size_t count, const std::function<Work()> &make_work,
                      const char *what = nullptr);

} // namespace quality
