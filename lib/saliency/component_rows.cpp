// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/component_rows.h"

#include "saliency/front_end_kernels.h"
#include "saliency/pyramid.h"

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

/// The significant bits of 16-bit words.
class WordSamples final : public ImageRows<Fixed>
{
public:
  WordSamples(const Component &component, std::size_t index)
      : ImageRows({ component.width, component.height }), index_(index), buffer_(1, component.width)
  {
  }

  void begin(const FrameView &frame) override
  {
    component_ = frame.components[index_];
    left_ = 16 - frame.depth - frame.shift;
    mask_ = 0xffffU << (16 - frame.depth) & 0xffffU;
  }

  const Fixed *row(int y) override
  {
    kernels::unpack(component_.data + y * component_.row_stride, component_.pixel_stride, left_,
                    mask_, component_.width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::size_t index_;
  Component component_;
  int left_ = 0;
  unsigned mask_ = 0;
  RowBuffer<Fixed> buffer_;
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
      : HalvedByteRows(source, 3, 4, 1), width_(source.width), halved_(1, 4 * size().width),
        buffer_(1, size().width, 3)
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
    kernels::halve_pixels({ in_memory(first), in_memory(second) }, width_, sums(0), halved_.row(0),
                          { in_memory(first + 2), in_memory(second + 2) });
  }

  const Fixed *made() override
  {
    kernels::part_pixels(halved_.row(0), size().width, places_);
    return buffer_.row(0);
  }

  int width_;
  Component first_;                 ///< in memory
  std::array<Fixed *, 3> places_{}; ///< rows for the bytes of a pixel
  RowBuffer<Fixed> halved_;         ///< four numbers a pixel
  RowBuffer<Fixed> buffer_;
};

/// Halved along both axes.
class HalvedRows final : public ImageRows<Fixed>
{
public:
  explicit HalvedRows(std::unique_ptr<ImageRows<Fixed>> source)
      : ImageRows(level_size(source->size(), 1), source->channels()), source_(std::move(source)),
        rows_(source_->size().height, size().width, channels()),
        buffer_(1, size().width, channels()),
        source_pitch_(RowBuffer<Fixed>::pitch(source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    rows_.begin();
  }

  const Fixed *row(int y) override
  {
    rows_.advance(y, [this](int source_y, Fixed *row) {
      const Fixed *samples = source_->row(source_y);
      for (int c = 0; c < channels(); ++c)
        kernels::halve_columns(samples + c * source_pitch_, source_->size().width,
                               row + c * rows_.pitch());
    });
    for (int c = 0; c < channels(); ++c)
      kernels::halve_rows(rows_.channel(c), size().width, buffer_.row(0) + c * buffer_.pitch());
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  FiveRows<Fixed> rows_; ///< halved from side to side
  RowBuffer<Fixed> buffer_;
  std::ptrdiff_t source_pitch_;
};

/// Halved from side to side alone.
class HalvedColumns final : public ImageRows<Fixed>
{
public:
  explicit HalvedColumns(std::unique_ptr<ImageRows<Fixed>> source)
      : ImageRows({ level_size(source->size(), 1).width, source->size().height }),
        source_(std::move(source)), buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const Fixed *row(int y) override
  {
    kernels::halve_columns(source_->row(y), source_->size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  RowBuffer<Fixed> buffer_;
};

/// Halved from top to bottom alone.
class HalvedHeight final : public ImageRows<Fixed>
{
public:
  explicit HalvedHeight(std::unique_ptr<ImageRows<Fixed>> source)
      : ImageRows({ source->size().width, level_size(source->size(), 1).height }),
        source_(std::move(source)), rows_(source_->size().height, size().width, 1),
        buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    rows_.begin();
  }

  const Fixed *row(int y) override
  {
    rows_.advance(y, [this](int source_y, Fixed *row) {
      std::copy_n(source_->row(source_y), size().width, row);
    });
    kernels::halve_rows(rows_.channel(0), size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  FiveRows<Fixed> rows_;
  RowBuffer<Fixed> buffer_;
};

/// Twice as wide, interpolated on the pyramid's grid, the last sample repeated beyond it.
class DoubledColumns final : public ImageRows<Fixed>
{
public:
  DoubledColumns(std::unique_ptr<ImageRows<Fixed>> source, int width)
      : ImageRows({ width, source->size().height }), source_(std::move(source)), buffer_(1, width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const Fixed *row(int y) override
  {
    kernels::double_columns(source_->row(y), size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  RowBuffer<Fixed> buffer_;
};

/// Twice as high, likewise.
class DoubledHeight final : public ImageRows<Fixed>
{
public:
  DoubledHeight(std::unique_ptr<ImageRows<Fixed>> source, int height)
      : ImageRows({ source->size().width, height }), source_(std::move(source)),
        held_(2, size().width), buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    next_ = 0;
  }

  const Fixed *row(int y) override
  {
    const int before = y / 2;
    const int after = std::min(before + y % 2, source_->size().height - 1);
    for (next_ = std::max(next_, before); next_ <= after; ++next_)
      std::copy_n(source_->row(next_), size().width, held_.row(next_ % 2));
    if (after == before)
      return held_.row(before % 2);
    kernels::average(held_.row(before % 2), held_.row(after % 2), size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  int next_ = 0; ///< row of the source that is not held yet
  RowBuffer<Fixed> held_;
  RowBuffer<Fixed> buffer_;
};

std::unique_ptr<ImageRows<Fixed>>
decimated(std::unique_ptr<ImageRows<Fixed>> rows, int octaves)
{
  for (int i = 0; i < octaves; ++i)
    rows = halved_rows(std::move(rows));
  return rows;
}

std::unique_ptr<ImageRows<Fixed>>
decimated(std::unique_ptr<ByteRows> rows, int octaves)
{
  if (octaves == 0)
    return std::make_unique<WidenedRows>(std::move(rows));
  return decimated(std::make_unique<HalvedBytes>(std::move(rows)), octaves - 1);
}

} // namespace

int
subsampling(int frame, int component)
{
  const auto samples = [frame](int k) {
    return (static_cast<long long>(frame) + (1LL << k) - 1) >> k;
  };
  int k = 0;
  while (samples(k) > component && samples(k) > 1)
    ++k;
  return samples(k) == component ? k : -1;
}

std::unique_ptr<ImageRows<Fixed>>
component_rows(const FrameView &frame, std::size_t component, int level)
{
  // What there is to do along each axis; subsampling has done some of it already, or too much.
  const Component &samples = frame.components[component];
  const int columns = level - subsampling(frame.width, samples.width);
  const int rows = level - subsampling(frame.height, samples.height);
  const int both = std::max(0, std::min(columns, rows));

  auto image = frame.depth == 8
                   ? decimated(std::make_unique<ByteSamples>(samples, component), both)
                   : decimated(std::make_unique<WordSamples>(samples, component), both);
  for (int i = both; i < columns; ++i)
    image = std::make_unique<HalvedColumns>(std::move(image));
  for (int i = both; i < rows; ++i)
    image = std::make_unique<HalvedHeight>(std::move(image));
  const auto size = [&frame, level](int coarser) {
    return level_size({ frame.width, frame.height }, level + coarser);
  };
  for (int i = -rows; i > 0; --i)
    image = std::make_unique<DoubledHeight>(std::move(image), size(i - 1).height);
  for (int i = -columns; i > 0; --i)
    image = std::make_unique<DoubledColumns>(std::move(image), size(i - 1).width);
  return image;
}

bool
has_byte_triples(const FrameView &frame)
{
  const Component &a = frame.components[0];
  const Component &b = frame.components[1];
  const Component &c = frame.components[2];
  const auto first = std::min({ a.data, b.data, c.data }, std::less<>());
  const auto last = std::max({ a.data, b.data, c.data }, std::less<>());
  const auto alike = [&a](const Component &other) {
    return other.pixel_stride == a.pixel_stride && other.row_stride == a.row_stride
           && other.width == a.width && other.height == a.height;
  };
  return frame.model != ColorModel::grey && frame.depth == 8 && a.pixel_stride >= 3 && alike(b)
         && alike(c) && last - first == 2 && a.data != b.data && b.data != c.data
         && a.data != c.data;
}

std::unique_ptr<ImageRows<Fixed>>
pixel_rows(const FrameView &frame, int level)
{
  const cv::Size size(frame.width, frame.height);
  if (level > 0 && frame.components[0].pixel_stride == 4)
    return decimated(std::make_unique<HalvedPixels>(size), level - 1);
  return decimated(std::make_unique<PixelRows>(size), level);
}

std::unique_ptr<ImageRows<Fixed>>
halved_rows(std::unique_ptr<ImageRows<Fixed>> source)
{
  return std::make_unique<HalvedRows>(std::move(source));
}

} // namespace saliency
