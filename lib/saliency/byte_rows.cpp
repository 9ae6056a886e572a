// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/byte_rows.h"

#include "saliency/decimation_kernels.h"
#include "saliency/pyramid.h"
#include "saliency/unpack_kernels.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace saliency {

namespace {

/// Bytes as they lie in memory: any row may be asked for.
class ByteRows : public ImageRows<std::uint8_t>
{
public:
  using ImageRows::ImageRows;

  /// Two rows, until the next call.
  virtual kernels::TwoRows rows(int first, int second) = 0;

  /// Where to find bytes that rows to come are made of, as many as the two rows have samples. Whoever
  /// works on a channel of the rows asks for them meanwhile, so that memory delivers as the processor
  /// computes.
  virtual kernels::TwoRows ahead(int channel) const = 0;
};

class ByteSamples final : public ByteRows
{
public:
  ByteSamples(const Component &component, std::size_t index)
      : ByteRows({ component.width, component.height }), index_(index), buffer_(2, component.width)
  {
  }

  void begin(const FrameView &frame) override
  {
    component_ = frame.components[index_];
  }

  const std::uint8_t *row(int y) override
  {
    return unpacked(y, 0);
  }

  kernels::TwoRows rows(int first, int second) override
  {
    at_ = { in_memory(first), in_memory(second) };
    return { unpacked(first, 0), unpacked(second, 1) };
  }

  kernels::TwoRows ahead(int) const override
  {
    constexpr int kAhead = 8192;
    return { at_[0] + kAhead, at_[1] + kAhead };
  }

private:
  const std::uint8_t *in_memory(int y) const
  {
    return component_.data + y * component_.row_stride;
  }

  const std::uint8_t *unpacked(int y, int place)
  {
    if (component_.pixel_stride == 1)
      return in_memory(y);
    kernels::unpack(in_memory(y), component_.pixel_stride, component_.width, buffer_.row(place));
    return buffer_.row(place);
  }

  std::size_t index_;
  Component component_;
  kernels::TwoRows at_{}; ///< latest rows in memory
  RowBuffer<std::uint8_t> buffer_;
};

/// That of a pixel's bytes which is first in memory.
Component
first_byte(const FrameView &frame)
{
  const auto by_address = [](const Component &a, const Component &b) {
    return std::less<>()(a.data, b.data);
  };
  return *std::ranges::min_element(frame.components, by_address);
}

/// Channels of a row in the order in which a pixel's bytes lie in memory.
template <typename T>
std::array<T *, 3>
in_memory_order(const FrameView &frame, T *row, std::ptrdiff_t pitch)
{
  std::array<T *, 3> channels{};
  const auto *first = first_byte(frame).data;
  for (std::size_t c = 0; c < 3; ++c)
    channels[static_cast<std::size_t>(frame.components[c].data - first)]
        = row + static_cast<std::ptrdiff_t>(c) * pitch;
  return channels;
}

/// The samples of pixels whose three bytes lie side by side.
class PixelRows final : public ByteRows
{
public:
  explicit PixelRows(cv::Size size) : ByteRows(size, 3), buffer_(2, size.width, 3)
  {
  }

  void begin(const FrameView &frame) override
  {
    first_ = first_byte(frame);
    for (int i = 0; i < 2; ++i)
      places_[static_cast<std::size_t>(i)]
          = in_memory_order(frame, buffer_.row(i), buffer_.pitch());
  }

  const std::uint8_t *row(int y) override
  {
    return unpacked(y, 0);
  }

  kernels::TwoRows rows(int first, int second) override
  {
    next_ = { in_memory(first + 2), in_memory(second + 2) };
    return { unpacked(first, 0), unpacked(second, 1) };
  }

  /// The next rows in as many parts as pixels have bytes.
  kernels::TwoRows ahead(int channel) const override
  {
    const std::ptrdiff_t part = static_cast<std::ptrdiff_t>(channel) * size().width;
    return { next_[0] + part, next_[1] + part };
  }

private:
  const std::uint8_t *in_memory(int y) const
  {
    return first_.data + y * first_.row_stride;
  }

  const std::uint8_t *unpacked(int y, std::size_t place)
  {
    kernels::unpack_triples(in_memory(y), first_.pixel_stride, size().width, places_[place]);
    return buffer_.row(static_cast<int>(place));
  }

  Component first_;                                       ///< in memory
  std::array<std::array<std::uint8_t *, 3>, 2> places_{}; ///< rows for the bytes of a pixel
  kernels::TwoRows next_{};                               ///< rows in memory
  RowBuffer<std::uint8_t> buffer_;
};

/// Bytes as Fixed.
class WidenedRows final : public ImageRows<Fixed>
{
public:
  explicit WidenedRows(std::unique_ptr<ImageRows<std::uint8_t>> source)
      : ImageRows(source->size(), source->channels()), source_(std::move(source)),
        buffer_(1, size().width, channels())
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const Fixed *row(int y) override
  {
    const std::uint8_t *samples = source_->row(y);
    for (int c = 0; c < channels(); ++c)
      kernels::widen(samples + c * RowBuffer<std::uint8_t>::pitch(size().width), size().width,
                     buffer_.row(0) + c * buffer_.pitch());
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<std::uint8_t>> source_;
  RowBuffer<Fixed> buffer_;
};

/// Of bytes, halved along both axes, two rows at a time.
class HalvedByteRows : public ImageRows<Fixed>
{
public:
  /// `numbers`: how many of a place are worked on at once, in each of `sums` rows.
  HalvedByteRows(cv::Size source, int channels, int numbers, int sums)
      : ImageRows(level_size(source, 1), channels), height_(source.height),
        offset_(kAligned - numbers), sums_(2, offset_ + numbers * size().width, sums)
  {
  }

  void begin(const FrameView &) override
  {
    made_ = kNone;
  }

  const Fixed *row(int y) final
  {
    if (y != made_) {
      if (y != made_ + 1)
        for (int before = 2 * y - 2; before <= 2 * y; before += 2)
          add(before - 1, before);
      add(2 * y + 1, 2 * y + 2);
      made_ = y;
    }
    return made();
  }

protected:
  kernels::RowSums sums(int i)
  {
    const std::ptrdiff_t at = i * sums_.pitch() + offset_;
    return { sums_.row(0) + at, sums_.row(1) + at };
  }

private:
  /// Vectors begin with place 1, so this is what is aligned.
  static constexpr int kAligned = 32;
  static constexpr int kNone = -2;

  /// Adds two rows of the source.
  virtual void add_rows(int first, int second) = 0;
  virtual const Fixed *made() = 0;

  void add(int first, int second)
  {
    add_rows(mirrored(first, height_), mirrored(second, height_));
  }

  int height_; ///< of the source
  int made_ = kNone;
  int offset_; ///< of place 0 in the rows of sums
  RowBuffer<std::uint16_t> sums_;
};

class HalvedBytes final : public HalvedByteRows
{
public:
  explicit HalvedBytes(std::unique_ptr<ByteRows> source)
      : HalvedByteRows(source->size(), source->channels(), 1, source->channels()),
        source_(std::move(source)), buffer_(1, size().width, channels()),
        source_pitch_(RowBuffer<std::uint8_t>::pitch(source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    HalvedByteRows::begin(frame);
    source_->begin(frame);
  }

private:
  void add_rows(int first, int second) override
  {
    const auto rows = source_->rows(first, second);
    for (int c = 0; c < channels(); ++c)
      kernels::halve_bytes({ rows[0] + c * source_pitch_, rows[1] + c * source_pitch_ },
                           source_->size().width, sums(c), buffer_.row(0) + c * buffer_.pitch(),
                           source_->ahead(c));
  }

  const Fixed *made() override
  {
    return buffer_.row(0);
  }

  std::unique_ptr<ByteRows> source_;
  RowBuffer<Fixed> buffer_;
  std::ptrdiff_t source_pitch_;
};

/// Of pixels of four bytes, three of which matter.
class HalvedPixels final : public HalvedByteRows
{
public:
  explicit HalvedPixels(cv::Size source)
      : HalvedByteRows(source, 3, 4, 1), width_(source.width), buffer_(1, size().width, 3)
  {
  }

  void begin(const FrameView &frame) override
  {
    HalvedByteRows::begin(frame);
    first_ = first_byte(frame);
    places_ = in_memory_order(frame, buffer_.row(0), buffer_.pitch());
  }

private:
  void add_rows(int first, int second) override
  {
    const auto in_memory = [this](int y) {
      return first_.data + y * first_.row_stride;
    };
    kernels::halve_pixels({ in_memory(first), in_memory(second) }, width_, sums(0), places_,
                          { in_memory(first + 2), in_memory(second + 2) });
  }

  const Fixed *made() override
  {
    return buffer_.row(0);
  }

  int width_;
  Component first_;                 ///< in memory
  std::array<Fixed *, 3> places_{}; ///< rows for the bytes of a pixel
  RowBuffer<Fixed> buffer_;
};

std::unique_ptr<ImageRows<Fixed>>
widened_or_halved(std::unique_ptr<ByteRows> rows, bool halved)
{
  if (halved)
    return std::make_unique<HalvedBytes>(std::move(rows));
  return std::make_unique<WidenedRows>(std::move(rows));
}

} // namespace

std::unique_ptr<ImageRows<Fixed>>
byte_samples(const Component &component, std::size_t index, bool halved)
{
  return widened_or_halved(std::make_unique<ByteSamples>(component, index), halved);
}

std::unique_ptr<ImageRows<Fixed>>
byte_pixels(const FrameView &frame, bool halved)
{
  const cv::Size size(frame.width, frame.height);
  if (halved && frame.components[0].pixel_stride == 4)
    return std::make_unique<HalvedPixels>(size);
  return widened_or_halved(std::make_unique<PixelRows>(size), halved);
}

} // namespace saliency
