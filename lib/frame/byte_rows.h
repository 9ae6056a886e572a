// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/image_rows.h"

#include <cstddef>
#include <memory>

namespace saliency {

/// How far 8-bit rows are decimated as they are read.
enum class ByteDecimation
{
  none,
  halved,    ///< along both axes
  quartered, ///< vertically, and halved horizontally
};

/// Fewest rows of an image that can be quartered: in a smaller one, the first rows would have to be
/// mirrored more than once.
constexpr int kFewestToQuarter = 16;

/// Samples of the frame's 8-bit component number `index`, in code values times 128.
std::unique_ptr<ImageRows<Fixed>> byte_samples(const Component &component, std::size_t index,
                                               ByteDecimation decimation);

/// The second and third component of a frame with has_byte_pairs(), in the same units. `decimation`
/// must not be `none`.
std::unique_ptr<ImageRows<Fixed>> byte_pairs(const FrameView &frame, ByteDecimation decimation);

/// All three components of a frame with has_byte_triples(), in the same units.
std::unique_ptr<ImageRows<Fixed>> byte_pixels(const FrameView &frame, ByteDecimation decimation);

} // namespace saliency
