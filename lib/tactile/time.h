// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace tactile {

/// Durations, and points in time of the film.
using Time = std::chrono::nanoseconds;

} // namespace tactile
