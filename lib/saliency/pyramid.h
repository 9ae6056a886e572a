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

/// One level down: the 5-tap Gaussian [1 4 6 4 1]/16 along both axes, mirrored at the borders
/// without repeating the border sample, even samples kept (Burt & Adelson 1983, REDUCE;
/// cv::pyrDown). Of float, CV_32FC1, or of Fixed, CV_16UC1, then to within a unit. Allocates only
/// when the size or the team changes.
template <typename Sample> class ReductionOf
{
public:
  void operator()(const cv::Mat &source, cv::Mat &reduced, const Team &team = {});

  /// The same in two steps: gives `reduced` its size, and makes rows begin…end - 1 as one of the
  /// team.
  void prepare(const cv::Mat &source, cv::Mat &reduced, const Team &team);
  void make_rows(int part, int begin, int end, const cv::Mat &source, cv::Mat &reduced);

private:
  cv::Size size_;                        ///< of the source
  std::vector<FiveRows<Sample>> halved_; ///< from side to side, of each part
};
using Reduction = ReductionOf<float>;

/// What a level has on a row of one finer by `octaves`: a row between two of its own, the last
/// repeated beyond it. Of float.
rows::Between between_rows(const cv::Mat &level, int row, int octaves);

/// Brings an image to a level finer by `octaves_x` and `octaves_y` ≥ 0: linear interpolation on the
/// grid above, the last sample repeated beyond it. `size`: of the finer level, whose coarser level
/// has the source's size. CV_32FC1; `source` and `upsampled` are not the same.
void upsample(const cv::Mat &source, int octaves_x, int octaves_y, cv::Size size,
              cv::Mat &upsampled);

/// The Gaussian pyramid of an L*a*b* image, from the level at which the image lies to a coarser
/// one.
class Pyramid
{
public:
  /// `image` is level `base`; levels base…coarsest are (re)built. The image is referred to, not
  /// copied.
  void build(const LabImage &image, int base, int coarsest);

  /// The same in fixed point, except that the levels are float; those finer than `chroma` have no
  /// a* and b*.
  void build(const FixedLabImage &image, int base, int coarsest, int chroma, const Team &team = {});

  /// A level between base and coarsest.
  const LabImage &level(int n) const;

private:
  void resize(int base, int coarsest);

  int base_ = 0;
  std::vector<LabImage> levels_;
  bool borrowed_ = false; ///< the base is an image of others
  std::vector<FixedLabImage> fixed_;
  std::vector<Reduction> reductions_; ///< to each level
  std::vector<std::array<ReductionOf<Fixed>, 3>> fixed_reductions_;
};

} // namespace saliency
