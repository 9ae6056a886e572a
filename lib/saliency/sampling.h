// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <vector>

/// Interpolated sampling of images, vectorized for this CPU; bit-identical on every CPU (see
/// rows.h). Images are CV_32FC1 and continuous.
namespace saliency {

/// Textured points of an image, with the derivatives of their lightness with respect to a small
/// motion around the picture's center and to a change of exposure.
class TexturedPoints
{
public:
  static constexpr std::size_t kParameters = 6; ///< scale, rotation, shift in x and y, gain, offset
  static constexpr std::size_t kShiftX = 2;
  static constexpr std::size_t kShiftY = 3;

  void clear();
  void add(float x, float y, float lightness, const std::array<float, kParameters> &change);
  /// Call after the last point.
  void finish();

  std::size_t size() const
  {
    return size_;
  }

  /// All of size() rounded up to whole blocks; the padding points lie outside every image.
  std::vector<float> x, y, lightness;
  std::array<std::vector<float>, kParameters> change;

private:
  std::size_t size_ = 0;
};

/// Samples the image at `position` of each point; NaN outside the image.
void sample(const cv::Mat &image, const Similarity &position, const TexturedPoints &points,
            std::vector<float> &values);

/// Normal equations of a least-squares fit: upper triangle and right-hand side.
struct Equations
{
  std::array<std::array<double, TexturedPoints::kParameters>, TexturedPoints::kParameters> normal;
  std::array<double, TexturedPoints::kParameters> right;
};

/// The equations of all points whose residual is not NaN. A residual r has the weight 1/(1 +
/// r²/scale²)² (Geman & McClure).
Equations equations(const TexturedPoints &points, const std::vector<float> &residuals,
                    double scale);

/// The equations of a fit of the shift alone, and how many points are inside the image.
struct ShiftEquations
{
  double xx, xy, yy;
  double x, y; ///< right-hand side
  std::size_t points;
};

/// The equations of the points' shift, for the residuals of the image at `position` of each point,
/// weighted as in equations().
ShiftEquations shift_equations(const cv::Mat &image, const Similarity &position,
                               const TexturedPoints &points, float scale);

/// The image as seen at `position` of each of its samples; NaN outside.
void warp(const cv::Mat &image, const Similarity &position, cv::Mat &warped);

} // namespace saliency
