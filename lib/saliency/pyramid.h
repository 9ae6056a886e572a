// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"
#include "frame/lab_image.h"
#include "frame/levels.h"
#include "frame/thread_pool.h"
#include "saliency/rows.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// One pyramid level down: the 5-tap Gaussian [1 4 6 4 1]/16 along both axes, borders mirrored
/// (BORDER_REFLECT_101), even samples kept (REDUCE in Burt & Adelson 1983; cv::pyrDown). For float,
/// CV_32FC1, or Fixed, CV_16UC1, which is exact to one unit. Allocates only when the size or the
/// team changes.
template <typename Sample> class ReductionOf
{
public:
  void operator()(const cv::Mat &source, cv::Mat &reduced, const Team &team = {});

  /// The same in two steps: prepare() allocates `reduced`, make_rows() makes rows [begin, end) as
  /// member `part` of the team.
  void prepare(const cv::Mat &source, cv::Mat &reduced, const Team &team);
  void make_rows(int part, int begin, int end, const cv::Mat &source, cv::Mat &reduced);

private:
  cv::Size size_;                        ///< of the source
  std::vector<FiveRows<Sample>> halved_; ///< per thread: rows halved horizontally
};
using Reduction = ReductionOf<float>;

/// Row `row` of a grid finer by `octaves`, as a row between two of the level's own. The last row is
/// repeated. CV_32FC1.
rows::Between between_rows(const cv::Mat &level, int row, int octaves);

/// Upsamples to a level finer by `octaves_x` and `octaves_y` ≥ 0: linear interpolation on the
/// pyramid's grid, the last sample repeated. `size`: of the finer level. CV_32FC1; not in place.
void upsample(const cv::Mat &source, int octaves_x, int octaves_y, cv::Size size,
              cv::Mat &upsampled);

/// The Gaussian pyramid of an L*a*b* image, from the image's own level to a coarser one.
class Pyramid
{
public:
  /// (Re)builds levels base…coarsest from `image`, which is level `base`. The image is referenced,
  /// not copied.
  void build(const LabImage &image, int base, int coarsest);

  /// The same from fixed point, to float levels. Levels finer than `chroma` have no a* and b*.
  void build(const FixedLabImage &image, int base, int coarsest, int chroma, const Team &team = {});

  /// Level n, base ≤ n ≤ coarsest.
  const LabImage &level(int n) const;

private:
  void resize(int base, int coarsest);

  int base_ = 0;
  std::vector<LabImage> levels_;
  bool borrowed_ = false; ///< the base level belongs to the caller
  std::vector<FixedLabImage> fixed_;
  std::vector<Reduction> reductions_; ///< to each level
  std::vector<std::array<ReductionOf<Fixed>, 3>> fixed_reductions_;
};

} // namespace saliency
