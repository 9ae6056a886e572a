// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The stages of saliency by their definitions, in double precision and without regard to speed: the
// reference for tests. It uses no code of the library but the names of its types.

#include "frame/frame_view.h"
#include "frame/lab_image.h"
#include "saliency/profile.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace oracle {

struct Image
{
  int width = 0;
  int height = 0;
  std::vector<double> values;

  Image() = default;
  Image(int w, int h, double value = 0)
      : width(w), height(h),
        values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value)
  {
  }
  double &operator()(int x, int y)
  {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)
                  + static_cast<std::size_t>(x)];
  }
  double operator()(int x, int y) const
  {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)
                  + static_cast<std::size_t>(x)];
  }
  double maximum() const
  {
    return *std::max_element(values.begin(), values.end());
  }
};

using Lab = std::array<double, 3>;
using LabImage = std::array<Image, 3>;

Image random_image(int width, int height, double low, double high, unsigned seed);
/// With structure at several scales.
LabImage picture_of_many_scales(int width, int height, unsigned seed);
cv::Mat to_mat(const Image &image);
saliency::LabImage to_planes(const LabImage &image);
/// Largest difference, or infinity if the sizes differ or a value is not finite.
double difference(const cv::Mat &mat, const Image &image);
/// Largest ΔE, or infinity.
double difference(const saliency::LabImage &found, const LabImage &image);
double difference(const saliency::FixedLabImage &found, const LabImage &image);

// ---- color

/// R'G'B' in [0, 1] → L*a*b*, D65 (IEC 61966-2-1, CIE 15).
Lab rgb_to_lab(std::array<double, 3> rgb);
/// Code values of a pixel → L*a*b* (ITU-R BT.601/709/2020, quantization as in BT.2100 table 9).
Lab samples_to_lab(std::array<double, 3> code, saliency::ColorModel model, int depth,
                   bool full_range, saliency::YuvMatrix matrix);

// ---- pyramid

/// The 25 (or 5) taps at the even samples. Borders are mirrored.
Image pyr_down(const Image &image, bool along_x = true, bool along_y = true);
LabImage pyr_down(const LabImage &image);
/// Bilinear interpolation. Borders are repeated.
double bilinear(const Image &image, double x, double y);
Image up(const Image &image, int octaves_x, int octaves_y, int width, int height);

// ---- frames

/// Every pixel of a frame of three components of 8 bits; chroma has all samples or half of them.
/// `threads` ≥ 1 share the pixels.
LabImage lab_image(const saliency::FrameView &frame, int threads = 1);
/// The levels down to `coarsest` of an image that is level `base`. Finer ones are empty.
std::vector<LabImage> pyramid_of(LabImage image, int base, int coarsest);

// ---- saliency

/// Lightness and chroma each have a pair of levels (level 0 first).
Image contrast(const std::vector<LabImage> &pyramid, saliency::LevelPair lightness,
               saliency::LevelPair chroma, double chroma_weight);
/// For each threshold, flood fills each region from one of its pixels.
Image surroundedness(const LabImage &lab, double step, double exponent);
/// For each pixel, the share of the picture (or of its border) with about the same color, bin by
/// bin.
Image rarity(const LabImage &lab, double border);
/// N(·) with M = 1. Differences up to 1e-4 do not count.
Image itti(const Image &map);
/// Contrast maps of a Lab pyramid (level 0 first), resampled to a level and summed.
Image spatial_saliency(const std::vector<LabImage> &pyramid,
                       const std::vector<saliency::LevelPair> &lightness,
                       const std::vector<saliency::LevelPair> &chroma, int level,
                       double chroma_weight, bool normalize);

} // namespace oracle
