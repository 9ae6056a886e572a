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

/// A number of 15 bits in fixed point, so that means and weighted sums of two are one instruction
/// each. Code values have 15 - depth bits after the point.
using Fixed = std::uint16_t;

/// Rows of samples with room after their ends, which kernels of any vector width may use. A row has
/// one run of samples for each channel.
template <typename T> class RowBuffer
{
public:
  static constexpr int kRoom = 64; ///< samples after a channel's last

  RowBuffer(int rows, int width, int channels = 1)
      : pitch_(pitch(width)), channels_(channels),
        samples_(hwy::AllocateAligned<T>(static_cast<std::size_t>(rows)
                                         * static_cast<std::size_t>(channels)
                                         * static_cast<std::size_t>(pitch_)))
  {
    if (!samples_)
      throw std::bad_alloc(); // as a vector would
    std::fill_n(samples_.get(), static_cast<std::ptrdiff_t>(rows) * channels * pitch_, T{});
  }

  /// Sample 0 of the row's first channel.
  T *row(int y)
  {
    return samples_.get() + y * channels_ * pitch_;
  }

  /// From a channel's sample to the next channel's.
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

/// An image that is made row by row, from top to bottom, by asking for rows of the image that it is
/// made of. So each row of a frame is read once, and only what the next row needs is kept.
template <typename T> class ImageRows
{
public:
  explicit ImageRows(cv::Size size, int channels = 1) : size_(size), channels_(channels)
  {
  }
  virtual ~ImageRows() = default;
  ImageRows(const ImageRows &) = delete;
  ImageRows &operator=(const ImageRows &) = delete;

  /// What follows is of this frame, which stays where it is until the last row is made; it has the
  /// geometry that these rows were made for.
  virtual void begin(const FrameView &frame) = 0;

  /// Row y, until the next call; of several channels, as in a RowBuffer of this width. After
  /// begin(), y does not fall from call to call; the first may be any.
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

/// Place `i`, up to two beyond an end of `length` samples, mirrored there without repeating the
/// last; what lies further away is some place.
constexpr int
mirrored(int i, int length)
{
  i = i < 0 ? -i : i;
  return std::max(0, i < length ? i : 2 * (length - 1) - i);
}

/// The five rows about row y of an image of half the height, mirrored at the borders without
/// repeating the border row: kept in a ring that is filled as y rises.
template <typename T> class FiveRows
{
public:
  /// `rows` of the image that they are taken from.
  FiveRows(int rows, int width, int channels) : rows_(rows), ring_(kRing, width, channels)
  {
  }

  void begin()
  {
    next_ = 0;
  }

  /// `fill(y, row)` is asked for each row once.
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
  static constexpr int kRing = 8; ///< a power of two that holds five

  int rows_;
  int next_ = 0;
  RowBuffer<T> ring_;
  std::array<const T *, 5> about_{};
};

} // namespace saliency
