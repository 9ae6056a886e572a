// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frameshrinker.h"

#include <memory>

/// Shrinks frames with the feature memory:GLMemory by OpenGL, at least one halving. NULL where the
/// module for that (gst/saliency/gl) is missing. It is loaded on first use.
std::unique_ptr<FrameShrinker> make_gl_shrinker(GstCaps *caps, int halvings);
