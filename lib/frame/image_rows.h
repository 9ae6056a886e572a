// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <hwy/aligned_allocator.h>
#include <opencv2/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>

namespace saliency {

/// A 15-bit fixed-point number, so that means and weighted sums of two take one instruction each.
/// Code values have 15 - depth fractional bits.
using Fixed = std::uint16_t;

/// Rows of samples with padding after their ends, so that kernels of any vector width may read and
/// write there. A row has one run of samples per channel.
template <typename T> class RowBuffer
{
public:
  static constexpr int kRoom = 64; ///< samples of padding after each channel

  RowBuffer(int rows, int width, int channels = 1)
      : pitch_(pitch(width)), channels_(channels),
        samples_(hwy::AllocateAligned<T>(static_cast<std::size_t>(rows)
                                         * static_cast<std::size_t>(channels)
                                         * static_cast<std::size_t>(pitch_)))
  {
    if (!samples_)
      throw std::bad_alloc(); // as std::vector would
    std::fill_n(samples_.get(), static_cast<std::ptrdiff_t>(rows) * channels * pitch_, T{});
  }

  /// Sample 0 of the first channel of row y.
  T *row(int y)
  {
    return samples_.get() + y * channels_ * pitch_;
  }

  /// Samples from one channel to the next.
  std::ptrdiff_t pitch() const
  {
    return pitch_;
  }
  static std::ptrdiff_t pitch(int width)
  {
    return (static_cast<std::ptrdiff_t>(width) + 63) / 64 * 64 + kRoom;
  }

private:
  std::ptrdiff_t pitch_;
  std::ptrdiff_t channels_;
  hwy::AlignedFreeUniquePtr<T[]> samples_;
};

/// An image whose rows are made on demand, from top to bottom, out of the rows of its source image.
/// Each row of a frame is read once, and only the rows that the next one needs are kept.
template <typename T> class ImageRows
{
public:
  explicit ImageRows(cv::Size size, int channels = 1) : size_(size), channels_(channels)
  {
  }
  virtual ~ImageRows() = default;
  ImageRows(const ImageRows &) = delete;
  ImageRows &operator=(const ImageRows &) = delete;

  /// Starts a new frame, of the geometry that these rows were made for. `frame` must stay valid
  /// until the last row is made.
  virtual void begin(const FrameView &frame) = 0;

  /// Row y, valid until the next call; several channels lie as in a RowBuffer of this width. After
  /// begin(), the first y may be any and y must not decrease.
  virtual const T *row(int y) = 0;

  cv::Size size() const
  {
    return size_;
  }
  int channels() const
  {
    return channels_;
  }

private:
  cv::Size size_;
  int channels_;
};

/// Index `i` mirrored at the ends of `length` samples without repeating the end sample
/// (BORDER_REFLECT_101). Valid for up to two samples beyond an end; the result is clamped at 0.
constexpr int
mirrored(int i, int length)
{
  i = i < 0 ? -i : i;
  return std::max(0, i < length ? i : 2 * (length - 1) - i);
}

/// The five source rows around row y of an image of half the height, mirrored at the borders
/// (BORDER_REFLECT_101). Kept in a ring buffer that is filled as y rises.
template <typename T> class FiveRows
{
public:
  /// `rows`: height of the source image.
  FiveRows(int rows, int width, int channels) : rows_(rows), ring_(kRing, width, channels)
  {
  }

  void begin()
  {
    next_ = 0;
  }

  /// Moves to row y. Calls `fill(y, row)` once for each source row.
  template <typename Fill> void advance(int y, const Fill &fill)
  {
    next_ = std::max(next_, 2 * y - 2);
    for (const int end = std::min(2 * y + 2, rows_ - 1); next_ <= end; ++next_)
      fill(next_, ring_.row(next_ % kRing));
    for (int i = 0; i < 5; ++i) {
      about_[static_cast<std::size_t>(i)] = ring_.row(mirrored(2 * y - 2 + i, rows_) % kRing);
    }
  }

  std::array<const T *, 5> channel(int c) const
  {
    auto rows = about_;
    for (const T *&row : rows)
      row += c * ring_.pitch();
    return rows;
  }

  std::ptrdiff_t pitch() const
  {
    return ring_.pitch();
  }

private:
  static constexpr int kRing = 8; ///< a power of two, at least five

  int rows_;
  int next_ = 0;
  RowBuffer<T> ring_;
  std::array<const T *, 5> about_{};
};

} // namespace saliency
