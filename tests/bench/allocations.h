// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

namespace bench {

/// Whether this build can count: with glibc and without a sanitizer, which has its own allocator.
bool counts_allocations();

/// Bytes that the whole program has asked malloc and its kin for.
std::uint64_t allocated_bytes();

} // namespace bench
