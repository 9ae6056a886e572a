// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/image_rows.h"

#include <memory>

namespace saliency {

/// k of a component of ⌈frame / 2ᵏ⌉ samples along an axis, or -1. Of one sample of one: 0.
int subsampling(int frame, int component);

/// A component of frames such as `frame` on the pyramid's grid at `level`, in code values, from
/// where it lies in memory: of the level's size, one channel.
///
/// Samples are halved along both axes as long as both need it, in fixed point: eight bits after the
/// point for bytes, as many as 16 bits leave for deeper samples. Then they are halved along the one axis
/// that is not subsampled as much as the other; an axis that is subsampled further than `level` is
/// interpolated.
std::unique_ptr<ImageRows<float>> component_rows(const FrameView &frame, std::size_t component,
                                                 int level);

/// Whether all samples are bytes and those of a pixel lie side by side, in any order, as in R'G'B'x.
bool has_byte_triples(const FrameView &frame);

/// All components of frames such as `frame`, which has_byte_triples(), at `level`: as component_rows(),
/// but three channels, which are read together.
std::unique_ptr<ImageRows<float>> pixel_rows(const FrameView &frame, int level);

/// An image halved along both axes: cv::pyrDown with BORDER_REFLECT_101.
std::unique_ptr<ImageRows<float>> halved_rows(std::unique_ptr<ImageRows<float>> source);

} // namespace saliency
