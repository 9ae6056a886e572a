// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <vector>

/// Images read between their samples, vectorized for the processor at hand; the same to the bit on
/// all of them (see rows.h). Images are CV_32FC1 and continuous.
namespace saliency {

/// Textured points of an image: what a small motion, about the middle of the picture, does to its
/// lightness there, and what a change of exposure does.
class TexturedPoints
{
public:
  static constexpr std::size_t kParameters
      = 6; ///< scale, turn, shift along x and y, gain and offset

  void clear();
  void add(float x, float y, float lightness, const std::array<float, kParameters> &change);
  /// To be called after the last.
  void finish();

  std::size_t size() const
  {
    return size_;
  }

  /// Equal lengths: size() rounded up to whole blocks by points that lie outside every image.
  std::vector<float> x, y, lightness;
  std::array<std::vector<float>, kParameters> change;

private:
  std::size_t size_ = 0;
};

/// The image at `position` of each point, NaN where that is not between samples.
void sample(const cv::Mat &image, const Similarity &position, const TexturedPoints &points,
            std::vector<float> &values);

/// The normal equations of the parameters' least squares: upper triangle and right side.
struct Equations
{
  std::array<std::array<double, TexturedPoints::kParameters>, TexturedPoints::kParameters> normal;
  std::array<double, TexturedPoints::kParameters> right;
};

/// Of the points whose residual is a number; a residual r weighs 1/(1 + r²/scale²)² (Geman &
/// McClure).
Equations equations(const TexturedPoints &points, const std::vector<float> &residuals,
                    double scale);

/// sum += image at `position` - length × now, at each sample for which that is at least `border`
/// inside the image. All are of one size.
void add_sampled(const cv::Mat &image, const Similarity &position, float border, const cv::Mat &now,
                 float length, cv::Mat &sum);

} // namespace saliency
