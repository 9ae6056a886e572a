// SPDX-License-Identifier: LGPL-2.1-or-later
//
// malloc and its kin, counted since the program began.
#pragma once

#include <cstdint>

namespace allocations {

/// Whether this build counts: with glibc and without a sanitizer, which has its own allocator.
bool are_counted();

/// Bytes requested.
std::uint64_t bytes_of_all_threads();

/// Calls of the thread that asks.
std::uint64_t of_this_thread();

} // namespace allocations
