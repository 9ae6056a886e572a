// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/image_rows.h"

#include <cstddef>
#include <memory>

namespace saliency {

/// How far rows of bytes are decimated as they are read.
enum class ByteDecimation
{
  none,
  halved,    ///< along both axes
  quartered, ///< from top to bottom, and halved from side to side
};

/// Images of fewer rows are not quartered, which begins so far above the first that rows have to be
/// mirrored there more than once.
constexpr int kFewestToQuarter = 16;

/// Samples of a component of 8 bits, the frame's `index`-th.
std::unique_ptr<ImageRows<Fixed>> byte_samples(const Component &component, std::size_t index,
                                               ByteDecimation decimation);

/// The second and the third component of a frame with has_byte_pairs(), likewise; they are
/// decimated.
std::unique_ptr<ImageRows<Fixed>> byte_pairs(const FrameView &frame, ByteDecimation decimation);

/// All three components of a frame with has_byte_triples(), likewise.
std::unique_ptr<ImageRows<Fixed>> byte_pixels(const FrameView &frame, ByteDecimation decimation);

} // namespace saliency
