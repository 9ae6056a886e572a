// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace tactile {

/// Times and spans of time; points in time are those of the film.
using Time = std::chrono::nanoseconds;

} // namespace tactile
