// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"

#include <memory>

namespace saliency {

/// k of a component of ⌈frame / 2ᵏ⌉ samples along an axis, or -1. Of one sample of one: 0.
int subsampling(int frame, int component);

/// A component of frames such as `frame` on the pyramid's grid at `level`, from where it lies in
/// memory: of the level's size, one channel, code values times 2^(15 - depth).
///
/// Samples are halved along both axes as long as both need it, then along the one axis that is not
/// subsampled as much as the other; an axis that is subsampled further than `level` is
/// interpolated.
std::unique_ptr<ImageRows<Fixed>> component_rows(const FrameView &frame, std::size_t component,
                                                 int level);

/// Whether all samples are bytes and those of a pixel lie side by side, in any order, as in
/// R'G'B'x.
bool has_byte_triples(const FrameView &frame);

/// Whether the second and the third component are bytes side by side, in either order, as in NV12.
bool has_byte_pairs(const FrameView &frame);

/// The second and the third component of frames such as `frame`, which has_byte_pairs(), at
/// `level`: as component_rows(), but two channels, which are read together. Null where they are not
/// to be halved, as often along both axes.
std::unique_ptr<ImageRows<Fixed>> pair_rows(const FrameView &frame, int level);

/// All components of frames such as `frame`, which has_byte_triples(), at `level`: as
/// component_rows(), but three channels, which are read together.
std::unique_ptr<ImageRows<Fixed>> pixel_rows(const FrameView &frame, int level);

/// An image halved along both axes: cv::pyrDown with BORDER_REFLECT_101, to within a unit.
std::unique_ptr<ImageRows<Fixed>> halved_rows(std::unique_ptr<ImageRows<Fixed>> source);

} // namespace saliency
