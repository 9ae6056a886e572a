// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlaypainter.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace {

constexpr int kShades = 256; ///< per level
constexpr int kFullWeight = 256;

// Palette of the grid: a tint and a gauge shade for each level, the borders, and those of sound.
constexpr std::size_t kTint = 0;
constexpr std::size_t kGauge = kShades;
constexpr std::size_t kBorder = std::size_t{ 2 } * kShades;
constexpr std::size_t kSoundBorder = kBorder + 1;
constexpr int kSoundBorderWidth = 3; ///< in border widths

constexpr int kLinesPerSide = 360; ///< a border's width is this part of the picture's shorter side
constexpr int kMetersPerSide = 60; ///< the meter's height is this part of it
constexpr int kSmallestCell = 8; ///< in border widths: smaller cells have neither borders nor gauge
constexpr int kGaugesPerCell = 12; ///< a gauge's width is this part of its cell's
constexpr int kInterpolatedRows
    = 360; ///< an interpolated field is smooth: rows of taller pictures share theirs

std::uint16_t
shade(double level)
{
  return static_cast<std::uint16_t>(std::lround(std::clamp(level, 0.0, 1.0) * (kShades - 1)));
}

/// First pixel of cell `cell` of `cells` on a side of `size` pixels.
int
edge(int cell, int cells, int size)
{
  return static_cast<int>(static_cast<std::int64_t>(cell) * size / cells);
}

/// Cell of a pixel: edge(cell) ≤ pixel < edge(cell + 1).
int
cell_of(int pixel, int cells, int size)
{
  return static_cast<int>(((static_cast<std::int64_t>(pixel) + 1) * cells - 1) / size);
}

/// A pixel's center in units of the field's cells, whose centers are integers; clamped to the first
/// and last center.
double
field_position(int pixel, int size, int cells)
{
  return std::clamp((pixel + 0.5) * cells / size - 0.5, 0.0, static_cast<double>(cells - 1));
}

/// row += weights / 256 × (values − row), rounded; samples are shifted up by `shift` bits.
template <typename Sample>
void
blend_row(Sample *__restrict row, const std::uint16_t *__restrict values,
          const std::uint16_t *__restrict weights, std::size_t count, unsigned shift)
{
  // 8-bit samples fit 16-bit arithmetic: 255 × 256 + 128 < 2¹⁶.
  using Wide = std::conditional_t<sizeof(Sample) == 1, std::uint16_t, std::uint32_t>;
  const auto unused = static_cast<Wide>((1U << shift) - 1);
  for (std::size_t i = 0; i < count; i++) {
    const auto in = static_cast<Wide>(row[i] >> shift);
    const auto kept = static_cast<Wide>(in * static_cast<Wide>(kFullWeight - weights[i]));
    const auto sum
        = static_cast<Wide>(kept + static_cast<Wide>(values[i] * weights[i]) + kFullWeight / 2);
    row[i] = static_cast<Sample>(((sum / kFullWeight) << shift) | (row[i] & unused));
  }
}

} // namespace

void
OverlayPainter::set_entry(const GstVideoInfo &info, std::size_t index, const Rgb &color,
                          double weight)
{
  palette_[index]
      = { color_codes(info, color),
          static_cast<std::uint16_t>(std::lround(std::clamp(weight, 0.0, 1.0) * kFullWeight)) };
}

void
OverlayPainter::paint_grid(GstVideoFrame *frame, const LevelField &field, double opacity)
{
  palette_.assign(kSoundBorder + 1, {});
  for (std::size_t i = 0; i < kShades; i++) {
    const double level = static_cast<double>(i) / (kShades - 1);
    const Rgb warm{ 1, 0.85 * (1 - level), 0.1 * (1 - level) }; // from yellow to red
    set_entry(frame->info, kTint + i, warm, opacity * level);
    set_entry(frame->info, kGauge + i, warm, opacity);
  }
  set_entry(frame->info, kBorder, { 1, 1, 1 }, opacity);
  set_entry(frame->info, kSoundBorder, { 0, 0.4, 1 }, opacity);
  paint(frame, [&](int y) { fill_grid_row(frame->info, field, y); });
}

void
OverlayPainter::fill_grid_row(const GstVideoInfo &info, const LevelField &field, int y)
{
  const int width = GST_VIDEO_INFO_WIDTH(&info);
  const int height = GST_VIDEO_INFO_HEIGHT(&info);
  const int line = std::max(1, std::min(width, height) / kLinesPerSide);
  const bool lines = std::min(width / field.columns, height / field.rows) >= kSmallestCell * line;

  const int r = cell_of(y, field.rows, height);
  const int top = edge(r, field.rows, height);
  const int bottom = edge(r + 1, field.rows, height);
  for (int c = 0; c < field.columns; c++) {
    const auto left = row_.begin() + edge(c, field.columns, width);
    const auto right = row_.begin() + edge(c + 1, field.columns, width);
    const std::size_t cell = static_cast<std::size_t>(r) * static_cast<std::size_t>(field.columns)
                             + static_cast<std::size_t>(c);
    const double level = field.values[cell] * field.scale;
    const bool sounds = !field.of_sound.empty() && field.of_sound[cell] > 0;
    const int border = sounds ? kSoundBorderWidth * line : line;
    const auto color = static_cast<std::uint16_t>(sounds ? kSoundBorder : kBorder);
    const std::uint16_t index = shade(level);
    std::fill(left, right, static_cast<std::uint16_t>(kTint + index));
    if (!lines)
      continue;
    if (y < top + border || y >= bottom - border) {
      std::fill(left, right, color);
      continue;
    }
    std::fill(left, left + border, color);
    std::fill(right - border, right, color);
    if (bottom - border - y <= level * (bottom - top - 2 * border))
      std::fill_n(left + border, (right - left) / kGaugesPerCell,
                  static_cast<std::uint16_t>(kGauge + index));
  }
}

void
OverlayPainter::paint_heatmap(GstVideoFrame *frame, const LevelField &field, double opacity)
{
  palette_.assign(kShades, {});
  for (std::size_t i = 0; i < kShades; i++) {
    const double level = static_cast<double>(i) / (kShades - 1);
    const Rgb color{ std::clamp(4 * level - 2, 0.0, 1.0),
                     std::clamp(2 - std::abs(4 * level - 2), 0.0, 1.0),
                     std::clamp(2 - 4 * level, 0.0, 1.0) }; // blue, cyan, green, yellow, red
    set_entry(frame->info, i, color, opacity * std::min(1.0, 4 * level));
  }
  paint_interpolated(frame, field);
}

void
OverlayPainter::paint_gray(GstVideoFrame *frame, const LevelField &field)
{
  palette_.assign(kShades, {});
  for (std::size_t i = 0; i < kShades; i++) {
    const double level = static_cast<double>(i) / (kShades - 1);
    set_entry(frame->info, i, { level, level, level }, 1);
  }
  paint_interpolated(frame, field);
}

void
OverlayPainter::paint_interpolated(GstVideoFrame *frame, const LevelField &field)
{
  between_.resize(static_cast<std::size_t>(GST_VIDEO_FRAME_WIDTH(frame)));
  for (int x = 0; x < GST_VIDEO_FRAME_WIDTH(frame); x++) {
    const double position = field_position(x, GST_VIDEO_FRAME_WIDTH(frame), field.columns);
    const auto left = static_cast<std::size_t>(position);
    between_[static_cast<std::size_t>(x)]
        = { left, std::min(left + 1, static_cast<std::size_t>(field.columns - 1)),
            static_cast<float>(position - std::floor(position)) };
  }
  field_row_.resize(static_cast<std::size_t>(field.columns));
  paint(frame, [&](int y) { fill_interpolated_row(frame->info, field, y); });
}

void
OverlayPainter::fill_interpolated_row(const GstVideoInfo &info, const LevelField &field, int y)
{
  const int height = GST_VIDEO_INFO_HEIGHT(&info);
  const int shared = std::max(1, height / kInterpolatedRows);
  if (y % shared != 0 && !last_row_.empty())
    return; // as the row before

  const double position = field_position(y, height, field.rows);
  const auto top = static_cast<std::size_t>(position);
  const auto bottom = std::min(top + 1, static_cast<std::size_t>(field.rows - 1));
  const double share = position - std::floor(position);
  const auto columns = static_cast<std::size_t>(field.columns);
  for (std::size_t c = 0; c < columns; c++)
    field_row_[c] = static_cast<float>(
        ((1 - share) * field.values[top * columns + c] + share * field.values[bottom * columns + c])
        * field.scale * (kShades - 1));
  for (std::size_t x = 0; x < row_.size(); x++) {
    const Between &between = between_[x];
    const float value = field_row_[between.left]
                        + between.share * (field_row_[between.right] - field_row_[between.left]);
    const float rounded = std::min(value, kShades - 1.0F)
                          + 0.5F; // never negative; lround would cost half of the frame's time
    row_[x] = static_cast<std::uint16_t>(rounded);
  }
}

void
OverlayPainter::paint_meter(GstVideoFrame *frame, double bar, double mark, double opacity)
{
  constexpr std::uint16_t kNothing = 0;
  constexpr std::uint16_t kGround = 1;
  constexpr std::uint16_t kBar = 2;
  constexpr std::uint16_t kMark = 3;
  palette_.assign(kMark + 1, {});
  set_entry(frame->info, kGround, { 0, 0, 0 }, opacity / 2);
  set_entry(frame->info, kBar, { 1, 1, 1 }, opacity);
  set_entry(frame->info, kMark, { 1, 0, 0 }, opacity);

  const int width = GST_VIDEO_FRAME_WIDTH(frame);
  const int height = GST_VIDEO_FRAME_HEIGHT(frame);
  const int thickness = std::clamp(std::min(width, height) / kMetersPerSide, 2, height);
  const auto place = [&](double share) {
    return static_cast<std::ptrdiff_t>(std::clamp(share, 0.0, 1.0) * (width - thickness));
  };
  paint(
      frame,
      [&](int y) {
        std::ranges::fill(row_, y < height - thickness ? kNothing : kGround);
        if (y < height - thickness)
          return;
        std::fill_n(row_.begin(), place(bar), kBar);
        std::fill_n(row_.begin() + place(mark), thickness, kMark);
      },
      height - thickness);
}

void
OverlayPainter::paint(GstVideoFrame *frame, const std::function<void(int)> &fill_row, int top)
{
  row_.resize(static_cast<std::size_t>(GST_VIDEO_FRAME_WIDTH(frame)));
  for (unsigned plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(frame); plane++) {
    if (GST_VIDEO_FRAME_COMP_DEPTH(frame, 0) > 8)
      paint_plane<std::uint16_t>(frame, plane, fill_row, top);
    else
      paint_plane<std::uint8_t>(frame, plane, fill_row, top);
  }
}

template <typename Sample>
void
OverlayPainter::paint_plane(GstVideoFrame *frame, unsigned plane,
                            const std::function<void(int)> &fill_row, int top)
{
  const GstVideoFormatInfo *format = frame->info.finfo;
  const unsigned components = std::min(3U, GST_VIDEO_FRAME_N_COMPONENTS(frame)); // never alpha
  const auto in_plane = [=](unsigned c) {
    return GST_VIDEO_FORMAT_INFO_PLANE(format, c) == plane;
  };
  unsigned first = 0;
  while (first < components && !in_plane(first))
    first++;
  if (first == components)
    return;

  // Padding and alpha have a weight of 0. GStreamer 1.22 has an offset of one byte, not of one
  // sample, for P010's second chroma component: rounded up.
  const auto position = [=](unsigned c, int x) {
    const auto offset = static_cast<std::size_t>(GST_VIDEO_FORMAT_INFO_POFFSET(format, c));
    const auto stride = static_cast<std::size_t>(GST_VIDEO_FORMAT_INFO_PSTRIDE(format, c));
    return (offset + sizeof(Sample) - 1) / sizeof(Sample)
           + static_cast<std::size_t>(x) * stride / sizeof(Sample);
  };
  std::size_t count = 0;
  for (unsigned c = first; c < components; c++)
    if (in_plane(c))
      count = std::max(count, position(c, GST_VIDEO_FRAME_COMP_WIDTH(frame, c) - 1) + 1);
  values_.assign(count, 0);
  weights_.assign(count, 0);
  last_row_.clear();

  for (int r = top >> GST_VIDEO_FORMAT_INFO_H_SUB(format, first);
       r < GST_VIDEO_FRAME_COMP_HEIGHT(frame, first); r++) {
    fill_row(std::min(r << GST_VIDEO_FORMAT_INFO_H_SUB(format, first),
                      GST_VIDEO_FRAME_HEIGHT(frame) - 1));
    if (row_ != last_row_) {
      for (unsigned c = first; c < components; c++) {
        if (!in_plane(c))
          continue;
        for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(frame, c); x++) {
          const Entry &entry = palette_[row_[static_cast<std::size_t>(x)
                                             << GST_VIDEO_FORMAT_INFO_W_SUB(format, c)]];
          values_[position(c, x)] = entry.value[c];
          weights_[position(c, x)] = entry.weight;
        }
      }
      last_row_ = row_;
    }
    auto *row = static_cast<std::uint8_t *>(GST_VIDEO_FRAME_PLANE_DATA(frame, plane))
                + static_cast<std::ptrdiff_t>(r) * GST_VIDEO_FRAME_PLANE_STRIDE(frame, plane);
    blend_row(reinterpret_cast<Sample *>(row), values_.data(), weights_.data(), count,
              static_cast<unsigned>(GST_VIDEO_FORMAT_INFO_SHIFT(format, first)));
  }
}
