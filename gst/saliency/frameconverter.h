// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frameshrinker.h"

#include <memory>

/// Shrinks frames of any raw format in readable memory, by GstVideoConverter. NULL if it does not
/// know the format.
std::unique_ptr<FrameShrinker> make_frame_converter(const GstVideoInfo &info, int halvings);
