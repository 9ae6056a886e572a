// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/image_rows.h"
#include "frame/lab_image.h"
#include "frame/row_shares.h"
#include "frame/thread_pool.h"

#include <opencv2/core/types.hpp>

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace saliency {

/// The level at which L*a*b* is computed for an image at `level`, unless that is to be exact: the
/// earlier, the more of what is not smooth is left as it was. Of frames of up to 480,000 pixels
/// (800×600), which take less than a millisecond, it is 0. Larger ones are to take no longer than
/// they must: it is the first level of no more than 150,000 samples, or `level`.
int conversion_level(cv::Size frame, int level);

/// Why that cannot be a frame: no size, no data, impossible depth, matrix or strides. Empty if it
/// can.
std::string_view fault_of(const FrameView &frame);

/// Frame → L*a*b* image at one level of the pyramid: the only part that reads a frame's memory.
///
/// L*a*b* may be computed at any level up to that one. At level 0 it is that of every pixel,
/// decimated afterwards, as in the paper. Otherwise the components are decimated first, each from
/// its own resolution, and L*a*b* is computed on what is left: a sixteenth of the work for each two
/// levels, for a small difference where the picture is not smooth, as the conversion is not linear.
///
/// Subsampled chroma is taken to lie on the pyramid's grid, sample i at pixel 2ᵏ·i, which is where
/// MPEG-2, H.264 and later put it horizontally; vertically it is half a pixel off.
///
/// Rows are made on demand from the rows that they are made of (ImageRows): the frame is read once,
/// and beside the result about nine rows of each level are held, less than 80 bytes for each pixel
/// of a wide frame's width and each thread. Several threads make bands of rows (RowShares); the
/// result is the same for any number of them, and on any processor.
class FrontEnd
{
public:
  /// How many threads at most, 0 for as many as pay: one for each million pixels, up to four and to
  /// the processor's own. One at first. Below 0 is 0.
  void set_threads(int threads);

  /// The frame's L*a*b* image at `level`, computed at level `converted`, valid until the next call.
  /// A component's width must be ⌈frame width / 2ᵏ⌉ for some k ≥ 0, likewise its height; the first
  /// component has the frame's size: it is without fault_of(). 0 ≤ converted ≤ level. Allocates
  /// only when geometry, format or levels change.
  const FixedLabImage &lab(const FrameView &frame, int level, int converted);

  /// The threads that made the latest image, for what is done with it.
  Team team()
  {
    return { pool_, static_cast<int>(bands_.size()) };
  }

private:
  /// What the bands are made for.
  struct Geometry
  {
    ColorModel model = ColorModel::yuv;
    bool bytes = true;
    int triple_stride = 0; ///< of has_byte_triples(): bytes from pixel to pixel
    bool byte_pairs = false;
    int level = -1;
    int converted = -1; ///< level of the conversion
    std::array<cv::Size, 3> components;

    bool operator==(const Geometry &) const = default;
  };

  void make_bands(const FrameView &frame, const Geometry &geometry);

  int threads_ = 1;
  Geometry geometry_;
  std::vector<std::unique_ptr<ImageRows<Fixed>>> bands_; ///< each makes rows of its own
  ThreadPool pool_;
  RowShares shares_;
  FixedLabImage lab_;
};

} // namespace saliency
