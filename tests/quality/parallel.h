// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace quality {

/// Calls work(0), work(1), … work(count − 1) on `threads` ≥ 1 threads, each call once. Rethrows an
/// exception of one of them after all threads have ended.
void in_parallel(int threads, std::size_t count, const std::function<void(std::size_t)> &work);

} // namespace quality
