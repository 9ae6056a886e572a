// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>

#include <tl/expected.hpp>

namespace study {

/// The lateness of a play's commands by the clock: issued − due, in ms.
struct Timing
{
  std::int64_t commands = 0;
  std::int64_t late = 0; ///< by more than 5 ms
  double p50 = 0;
  double p99 = 0;
  double max = 0;
};

/// Reads a command trace of tactorsink.
tl::expected<Timing, std::string> read_timing(const std::string &trace);

} // namespace study
