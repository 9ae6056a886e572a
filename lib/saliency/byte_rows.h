// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"
#include "saliency/image_rows.h"

#include <cstddef>
#include <memory>

namespace saliency {

/// Samples of a component of 8 bits, the frame's `index`-th; `halved`: a level up along both axes.
std::unique_ptr<ImageRows<Fixed>> byte_samples(const Component &component, std::size_t index,
                                               bool halved);

/// All three components of a frame with has_byte_triples(), likewise.
std::unique_ptr<ImageRows<Fixed>> byte_pixels(const FrameView &frame, bool halved);

} // namespace saliency
