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

/// The level at which L*a*b* is computed for an image at `level`, unless the exact map is
/// requested: the first of at most 150,000 samples, or `level` if that is first. Converting at an
/// early level is more accurate, converting at a late one is faster.
int decimation_level(cv::Size frame, int level);

/// Why `frame` is invalid: size, data, depth, matrix or strides. Empty if it is valid.
std::string_view fault_of(const FrameView &frame);

/// Frame → L*a*b* image at one pyramid level: the only part that reads a frame's memory.
///
/// L*a*b* may be computed at any level up to that one. At level 0 every pixel is converted and then
/// decimated, as in the paper. At a later level, the components are decimated first, each from its
/// own resolution, and L*a*b* is computed from the result. That is a sixteenth of the work for
/// every two levels. Results differ slightly where the picture is not smooth, because the
/// conversion is not linear.
///
/// Subsampled chroma is assumed to lie on the pyramid's grid, sample i at pixel 2ᵏ·i. Horizontally
/// this is the siting of MPEG-2, H.264 and later; vertically it is half a pixel off.
///
/// Rows are made on demand from the rows they depend on (ImageRows), so the frame is read once.
/// Besides the result, about nine rows of each level are held: less than 80 bytes per pixel of
/// frame width and thread. Threads share the rows in bands (RowShares). The result is the same for
/// any number of threads and on every CPU.
class FrontEnd
{
public:
  /// Sets the maximum number of threads; initially 1, and 1 with 0 or less: waking other
  /// threads takes about as long as they save (docs/measured/speed.csv).
  void set_threads(int threads);

  /// Returns the frame's L*a*b* image at `level`, computed at level `converted`; it is valid until
  /// the next call. Requires an empty fault_of(frame) and 0 ≤ converted ≤ level. Allocates only
  /// when geometry, format or levels change.
  const FixedLabImage &lab(const FrameView &frame, int level, int converted);

  /// The threads that made the latest image, for further work on it.
  Team team()
  {
    return { pool_, static_cast<int>(bands_.size()) };
  }

private:
  /// The bands depend on this geometry.
  struct Geometry
  {
    ColorModel model = ColorModel::yuv;
    bool bytes = true;
    int triple_stride = 0; ///< of has_byte_triples(): bytes per pixel
    bool byte_pairs = false;
    int level = -1;
    int converted = -1; ///< level of the conversion
    std::array<cv::Size, 3> components;

    bool operator==(const Geometry &) const = default;
  };

  void make_bands(const FrameView &frame, const Geometry &geometry);

  int threads_ = 1;
  Geometry geometry_;
  std::vector<std::unique_ptr<ImageRows<Fixed>>> bands_; ///< one chain of rows per band
  ThreadPool pool_;
  RowShares shares_;
  FixedLabImage lab_;
};

} // namespace saliency
