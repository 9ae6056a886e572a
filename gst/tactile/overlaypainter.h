// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "colorcodes.h"

#include <gst/video/video.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

/// Values that cover a picture as a whole: `values[row * columns + column]`, shown as `values ×
/// scale`, at most 1.
struct LevelField
{
  std::span<const float> values;
  int columns = 0;
  int rows = 0;
  double scale = 1;
};

/// Blends levels into frames of any format whose components have 8 or 16 bits of memory each. A
/// picture's row is described by indices into a palette, and a palette's entry is a value for each
/// component of the format and one weight, so that all formats, planar and packed, take one way:
/// per plane, a row of values and a row of weights.
class OverlayPainter
{
public:
  /// Each cell tinted by its level, a gauge on its left as high as its level, and thin borders.
  void paint_grid(GstVideoFrame *frame, const LevelField &field, double opacity);

  /// A color map from blue to red, interpolated between the field's values; where it is silent the
  /// picture stays.
  void paint_heatmap(GstVideoFrame *frame, const LevelField &field, double opacity);

  /// The field in gray instead of the picture, interpolated between its values.
  void paint_gray(GstVideoFrame *frame, const LevelField &field);

private:
  struct Entry
  {
    std::array<std::uint16_t, 3> value{}; ///< of each component, in the format's codes
    std::uint16_t weight = 0;             ///< of 256
  };
  /// A pixel's place between two columns of the field.
  struct Between
  {
    std::size_t left;
    std::size_t right;
    float share; ///< of the right one
  };

  void set_entry(const GstVideoInfo &info, std::size_t index, const Rgb &color, double weight);
  void fill_grid_row(const GstVideoInfo &info, const LevelField &field, int y);
  void fill_interpolated_row(const GstVideoInfo &info, const LevelField &field, int y);
  void paint_interpolated(GstVideoFrame *frame, const LevelField &field);

  /// `fill_row(y)` writes row y of the picture into row_.
  void paint(GstVideoFrame *frame, const std::function<void(int)> &fill_row);
  template <typename Sample>
  void paint_plane(GstVideoFrame *frame, unsigned plane, const std::function<void(int)> &fill_row);

  std::vector<Entry> palette_;
  std::vector<std::uint16_t> row_;
  std::vector<std::uint16_t> last_row_; ///< what values_ and weights_ were made from
  std::vector<std::uint16_t> values_;
  std::vector<std::uint16_t> weights_;
  std::vector<Between> between_; ///< of each pixel in a row
  std::vector<float> field_row_;
};
