// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frameshrinker.h"

#include <memory>

/// Shrinks frames with elements of GStreamer that take their memory, such as vapostproc, which
/// share the context of their neighbors as any other. They run on the thread that calls shrink().
///
/// `owner` is the element whose sink pad the frames come from; it outlives the shrinker. NULL if no
/// element is there for such caps.
std::unique_ptr<FrameShrinker> make_element_shrinker(GstElement *owner, GstCaps *caps,
                                                     int halvings);
