// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"

#include <hwy/aligned_allocator.h>
#include <opencv2/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <new>

namespace saliency {

/// Rows of samples with room around them: kernels of any vector width read and write beyond a row's
/// end instead of treating its last samples apart, and mirror samples before its start. A row has
/// one run of samples for each channel.
template <typename T> class RowBuffer
{
public:
  static constexpr int kBefore = 64; ///< samples of room before a channel's first
  static constexpr int kAfter = 192; ///< and after its last

  RowBuffer(int rows, int width, int channels = 1)
      : pitch_(pitch(width)), channels_(channels),
        samples_(hwy::AllocateAligned<T>(static_cast<std::size_t>(rows)
                                         * static_cast<std::size_t>(channels)
                                         * static_cast<std::size_t>(pitch_)))
  {
    if (!samples_)
      throw std::bad_alloc();
    std::fill_n(samples_.get(), static_cast<std::ptrdiff_t>(rows) * channels * pitch_, T{});
  }

  /// Sample 0 of the row's first channel.
  T *row(int y)
  {
    return samples_.get() + y * channels_ * pitch_ + kBefore;
  }

  /// From a channel's sample to the next channel's.
  std::ptrdiff_t pitch() const
  {
    return pitch_;
  }
  static std::ptrdiff_t pitch(int width)
  {
    return kBefore + (static_cast<std::ptrdiff_t>(width) + 63) / 64 * 64 + kAfter;
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

  /// Row y, in a RowBuffer with `size().width` and `channels()`; until the next call. After begin(),
  /// y does not fall from call to call; the first may be any.
  virtual T *row(int y) = 0;

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

} // namespace saliency
