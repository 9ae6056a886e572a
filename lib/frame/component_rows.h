// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"

#include <memory>

namespace saliency {

/// The k for which a component has ⌈frame / 2ᵏ⌉ samples along an axis, or -1 if there is none. The
/// smallest such k.
int subsampling(int frame, int component);

/// Rows of a frame's component at pyramid `level`, read from the frame's memory. One channel of the
/// level's size, in code values times 2^(15 - depth).
///
/// Samples are halved along both axes for as long as both need it, then along the less subsampled
/// axis. An axis that is subsampled further than `level` is interpolated.
std::unique_ptr<ImageRows<Fixed>> component_rows(const FrameView &frame, std::size_t component,
                                                 int level);

/// Whether all samples are bytes and those of a pixel are adjacent, in any order, as in RGBx.
bool has_byte_triples(const FrameView &frame);

/// Whether the second and third component are adjacent bytes, in either order, as in NV12.
bool has_byte_pairs(const FrameView &frame);

/// The second and third component of a frame with has_byte_pairs() at `level`, read together: as
/// component_rows(), but two channels. Null unless both axes are halved equally often, at least
/// once.
std::unique_ptr<ImageRows<Fixed>> pair_rows(const FrameView &frame, int level);

/// All components of a frame with has_byte_triples() at `level`, read together: as
/// component_rows(), but three channels.
std::unique_ptr<ImageRows<Fixed>> pixel_rows(const FrameView &frame, int level);

/// Rows of an image halved along both axes: cv::pyrDown with BORDER_REFLECT_101, to within one
/// unit.
std::unique_ptr<ImageRows<Fixed>> halved_rows(std::unique_ptr<ImageRows<Fixed>> source);

} // namespace saliency
