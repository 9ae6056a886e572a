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

/// A grid of values over the whole picture: `values[row * columns + column]`, shown as `values ×
/// scale`, at most 1.
struct LevelField
{
  std::span<const float> values;
  int columns = 0;
  int rows = 0;
  double scale = 1;
  std::span<const float> of_sound{}; ///< how much of `values` the sound added; may be empty
};

/// Blends levels into frames of any format with components of 8 or 16 bits. A row is indices into a
/// palette; an entry has a value for each component and one weight. So all formats, planar and
/// packed, share one code path: per plane, a row of values and a row of weights.
class OverlayPainter
{
public:
  /// Tints each cell by its level, with a gauge on its left and thin borders. Those of a cell to
  /// which the sound added are thick and blue.
  void paint_grid(GstVideoFrame *frame, const LevelField &field, double opacity);

  /// A color map from blue to red, interpolated between the field's values. Silent parts of the
  /// picture stay as they are.
  void paint_heatmap(GstVideoFrame *frame, const LevelField &field, double opacity);

  /// The field in gray instead of the picture, interpolated.
  void paint_gray(GstVideoFrame *frame, const LevelField &field);

  /// A bar along the lower edge with a mark; both are shares of the picture's width.
  void paint_meter(GstVideoFrame *frame, double bar, double mark, double opacity);

private:
  struct Entry
  {
    std::array<std::uint16_t, 3> value{}; ///< per component, as code values
    std::uint16_t weight = 0;             ///< of 256
  };
  /// A pixel's position between two columns of the field.
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

  /// `fill_row(y)` writes row y of the picture into row_, for rows from `top` on or one before.
  void paint(GstVideoFrame *frame, const std::function<void(int)> &fill_row, int top = 0);
  template <typename Sample>
  void paint_plane(GstVideoFrame *frame, unsigned plane, const std::function<void(int)> &fill_row,
                   int top);

  std::vector<Entry> palette_;
  std::vector<std::uint16_t> row_;
  std::vector<std::uint16_t> last_row_; ///< source of values_ and weights_
  std::vector<std::uint16_t> values_;
  std::vector<std::uint16_t> weights_;
  std::vector<Between> between_; ///< of each pixel in a row
  std::vector<float> field_row_;
};
