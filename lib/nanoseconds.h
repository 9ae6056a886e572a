// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace visuotactile {

/// Times and spans of time. A point in time is a running time of the pipeline where motors are
/// concerned and a time of the film elsewhere.
using Time = std::chrono::nanoseconds;

} // namespace visuotactile

// Under the same name in each library.
namespace saliency {
using visuotactile::Time;
}
namespace sound {
using visuotactile::Time;
}
namespace tactile {
using visuotactile::Time;
}
namespace tactor {
using visuotactile::Time;
}
