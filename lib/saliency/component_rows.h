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
/// Samples are halved along both axes in their own depth as long as both need it, rounded each time
/// as cv::pyrDown does; then along the one axis that is not subsampled as much as the other,
/// unrounded; an axis that is subsampled further than `level` is interpolated.
std::unique_ptr<ImageRows<float>> component_rows(const FrameView &frame, std::size_t component,
                                                 int level);

/// An image halved along both axes: cv::pyrDown with BORDER_REFLECT_101.
std::unique_ptr<ImageRows<float>> halved_rows(std::unique_ptr<ImageRows<float>> source);

} // namespace saliency
