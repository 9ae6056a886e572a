// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace tactor {

/// Times and spans of time; points in time are running times of the pipeline.
using Time = std::chrono::nanoseconds;

} // namespace tactor
