// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/byte_rows.h"

#include "frame/byte_kernels.h"
#include "frame/levels.h"
#include "frame/prefetch.h"
#include "frame/unpack_kernels.h"

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <utility>

namespace saliency {

namespace {

/// Source rows from y on of an image of that height, mirrored at its end. `row(y, i)` returns the
/// i-th.
template <typename Row>
kernels::SourceRows
rows_from(int y, int height, const Row &row)
{
  kernels::SourceRows rows;
  for (int i = 0; i < static_cast<int>(rows.size()); ++i)
    rows[static_cast<std::size_t>(i)] = row(mirrored(y + i, height), i);
  return rows;
}

/// Bytes as they lie in memory, with random access to rows.
class ByteRows : public ImageRows<std::uint8_t>
{
public:
  using ImageRows::ImageRows;

  /// Rows from y on, mirrored beyond the borders; valid until the next call.
  virtual kernels::SourceRows rows(int y) = 0;

  /// The rows to prefetch while a channel of those rows is processed.
  virtual Prefetch ahead(int channel) const = 0;
  static_assert(kernels::kSourceRows <= Prefetch::kRows);
};

class ByteSamples final : public ByteRows
{
public:
  ByteSamples(const Component &component, std::size_t index)
      : ByteRows({ component.width, component.height }), index_(index),
        buffer_(kernels::kSourceRows, component.width)
  {
  }

  void begin(const FrameView &frame) override
  {
    component_ = frame.components[index_];
    others_ = 0;
    for (std::size_t i = 0; i < index_ && component_.pixel_stride > 1; ++i)
      others_ += frame.components[i].pixel_stride > 1 ? frame.components[i].width : 0;
  }

  const std::uint8_t *row(int y) override
  {
    return unpacked(y, 0);
  }

  kernels::SourceRows rows(int y) override
  {
    y_ = y;
    return rows_from(y, size().height, [this](int row, int place) { return unpacked(row, place); });
  }

  Prefetch ahead(int) const override
  {
    Prefetch ahead = plan_prefetch(component_, y_, kernels::kSourceRows);
    ahead.first += others_;
    return ahead;
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
  /// Bytes of a row that other components of the same pixels prefetch.
  std::ptrdiff_t others_ = 0;
  int y_ = 0; ///< first of the latest rows
  RowBuffer<std::uint8_t> buffer_;
};

template <std::size_t count>
std::span<const Component, count>
last_components(const FrameView &frame)
{
  return std::span(frame.components).template last<count>();
}

/// The component among the last `count` whose byte comes first in a pixel.
template <std::size_t count>
Component
first_byte(const FrameView &frame)
{
  const auto by_address = [](const Component &a, const Component &b) {
    return std::less<>()(a.data, b.data);
  };
  return *std::ranges::min_element(last_components<count>(frame), by_address);
}

/// Where to write the channels of a row, in the order of a pixel's bytes in memory.
template <std::size_t count, typename T>
std::array<T *, count>
in_memory_order(const FrameView &frame, T *row, std::ptrdiff_t pitch)
{
  std::array<T *, count> channels{};
  const auto *first = first_byte<count>(frame).data;
  for (const Component &component : last_components<count>(frame)) {
    channels[static_cast<std::size_t>(component.data - first)] = row;
    row += pitch;
  }
  return channels;
}

/// Samples of pixels whose three bytes are adjacent.
class PixelRows final : public ByteRows
{
public:
  explicit PixelRows(cv::Size size)
      : ByteRows(size, 3), buffer_(kernels::kSourceRows, size.width, 3)
  {
  }

  void begin(const FrameView &frame) override
  {
    first_ = first_byte<3>(frame);
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i] = in_memory_order<3>(frame, buffer_.row(static_cast<int>(i)), buffer_.pitch());
  }

  const std::uint8_t *row(int y) override
  {
    return unpacked(y, 0);
  }

  kernels::SourceRows rows(int y) override
  {
    y_ = y;
    return rows_from(y, size().height, [this](int row, int place) { return unpacked(row, place); });
  }

  Prefetch ahead(int channel) const override
  {
    return plan_prefetch(first_, y_, kernels::kSourceRows, channel, channels());
  }

private:
  const std::uint8_t *in_memory(int y) const
  {
    return first_.data + y * first_.row_stride;
  }

  const std::uint8_t *unpacked(int y, int place)
  {
    kernels::unpack_triples(in_memory(y), first_.pixel_stride, size().width,
                            places_[static_cast<std::size_t>(place)]);
    return buffer_.row(place);
  }

  Component first_; ///< first component in memory
  /// For each source row, one row per byte of a pixel.
  std::array<std::array<std::uint8_t *, 3>, kernels::kSourceRows> places_{};
  int y_ = 0; ///< first of the latest rows
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

/// 8-bit rows halved horizontally, and halved or quartered vertically.
class DecimatedByteRows : public ImageRows<Fixed>
{
public:
  /// `numbers` per output are processed together, in `times` passes.
  DecimatedByteRows(cv::Size source, int channels, int numbers, int times, bool quartered)
      : ImageRows({ level_size(source, 1).width, level_size(source, quartered ? 2 : 1).height },
                  channels),
        made_(kernels::kAtOnce, size().width, channels), source_rows_(source.height),
        quartered_(quartered), carried_(1, carried_length(numbers * size().width, quartered), times)
  {
  }

  void begin(const FrameView &) override
  {
    first_made_ = kNone;
  }

  const Fixed *row(int y) final
  {
    const int at_once = quartered_ ? 1 : kernels::kAtOnce;
    if (y < first_made_ || y >= first_made_ + at_once) {
      // Restarting: the carried state depends on the rows before, so make those first.
      const int before = y == first_made_ + at_once ? 0 : (quartered_ ? 3 : 1);
      for (int i = before; i >= 0; --i)
        make(y - i * at_once);
      first_made_ = y;
    }
    return made_.row(y - first_made_);
  }

protected:
  bool quartered() const
  {
    return quartered_;
  }
  kernels::Carried carried(int i)
  {
    return { .first = carried_.row(0) + i * carried_.pitch(), .more = more_ };
  }

  RowBuffer<Fixed> made_;

private:
  static constexpr int kNone = -2 * kernels::kAtOnce;

  static int carried_length(int numbers, bool quartered)
  {
    using kernels::Carried;
    constexpr int kBlock{ Carried::kBlock };
    const int blocks = numbers / kBlock + 2; // index 1 starts a block
    return blocks * kBlock * (quartered ? Carried::kQuartered : Carried::kHalved);
  }

  /// Makes rows from y on.
  void make(int y)
  {
    const int halved = quartered_ ? 2 * y + 1 : y;
    more_ = std::clamp(level_size({ 1, source_rows_ }, 1).height - halved, 0, kernels::kAtOnce);
    add_rows(2 * halved + 1);
  }

  /// Adds the source rows from y on.
  virtual void add_rows(int y) = 0;

  int first_made_ = kNone;
  int source_rows_;
  bool quartered_;
  RowBuffer<std::uint16_t> carried_;
  int more_ = 0; ///< how many of the half-height rows being made exist
};

class DecimatedBytes final : public DecimatedByteRows
{
public:
  DecimatedBytes(std::unique_ptr<ByteRows> source, bool quartered)
      : DecimatedByteRows(source->size(), source->channels(), 1, source->channels(), quartered),
        source_(std::move(source)),
        source_pitch_(RowBuffer<std::uint8_t>::pitch(source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    DecimatedByteRows::begin(frame);
    source_->begin(frame);
  }

private:
  void add_rows(int y) override
  {
    auto rows = source_->rows(y);
    const int width = source_->size().width;
    for (int c = 0; c < channels(); ++c) {
      Fixed *made = made_.row(0) + c * made_.pitch();
      if (quartered())
        kernels::quarter_bytes(rows, width, carried(c), made, source_->ahead(c));
      else
        kernels::halve_bytes(rows, width, carried(c), { made, made_.row(1) + c * made_.pitch() },
                             source_->ahead(c));
      for (auto &row : rows)
        row += source_pitch_;
    }
  }

  std::unique_ptr<ByteRows> source_;
  std::ptrdiff_t source_pitch_;
};

/// Pixels of two bytes, or of four of which three are used.
template <std::size_t count> class DecimatedPixels final : public DecimatedByteRows
{
public:
  DecimatedPixels(cv::Size source, bool quartered)
      : DecimatedByteRows(source, count, count == 2 ? 2 : 4, 1, quartered), source_(source)
  {
  }

  void begin(const FrameView &frame) override
  {
    DecimatedByteRows::begin(frame);
    first_ = first_byte<count>(frame);
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i] = in_memory_order<count>(frame, made_.row(static_cast<int>(i)), made_.pitch());
  }

private:
  void add_rows(int y) override
  {
    const auto rows = rows_from(
        y, source_.height, [this](int row, int) { return first_.data + row * first_.row_stride; });
    const Prefetch ahead = plan_prefetch(first_, y, kernels::kSourceRows);
    if (quartered())
      kernels::quarter_pixels(rows, source_.width, carried(0), places_[0], ahead);
    else
      kernels::halve_pixels(rows, source_.width, carried(0), places_, ahead);
  }

  cv::Size source_;
  Component first_;                                      ///< first component in memory
  kernels::AtOnce<std::array<Fixed *, count>> places_{}; ///< per row: one row per byte of a pixel
};

std::unique_ptr<ImageRows<Fixed>>
decimated(std::unique_ptr<ByteRows> rows, ByteDecimation decimation)
{
  if (decimation == ByteDecimation::none)
    return std::make_unique<WidenedRows>(std::move(rows));
  return std::make_unique<DecimatedBytes>(std::move(rows), decimation == ByteDecimation::quartered);
}

} // namespace

std::unique_ptr<ImageRows<Fixed>>
byte_samples(const Component &component, std::size_t index, ByteDecimation decimation)
{
  return decimated(std::make_unique<ByteSamples>(component, index), decimation);
}

std::unique_ptr<ImageRows<Fixed>>
byte_pairs(const FrameView &frame, ByteDecimation decimation)
{
  const Component &chroma = frame.components[1];
  return std::make_unique<DecimatedPixels<2>>(cv::Size(chroma.width, chroma.height),
                                              decimation == ByteDecimation::quartered);
}

std::unique_ptr<ImageRows<Fixed>>
byte_pixels(const FrameView &frame, ByteDecimation decimation)
{
  const cv::Size size(frame.width, frame.height);
  if (decimation != ByteDecimation::none && frame.components[0].pixel_stride == 4)
    return std::make_unique<DecimatedPixels<3>>(size, decimation == ByteDecimation::quartered);
  return decimated(std::make_unique<PixelRows>(size), decimation);
}

} // namespace saliency
