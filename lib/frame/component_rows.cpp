// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/component_rows.h"

#include "frame/byte_rows.h"
#include "frame/decimation_kernels.h"
#include "frame/levels.h"
#include "frame/prefetch.h"
#include "frame/unpack_kernels.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

namespace saliency {

namespace {

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
                    mask_, component_.width, buffer_.row(0), plan_prefetch(component_, y, 1));
    return buffer_.row(0);
  }

private:
  std::size_t index_;
  Component component_;
  int left_ = 0;
  unsigned mask_ = 0;
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
  FiveRows<Fixed> rows_; ///< halved horizontally
  RowBuffer<Fixed> buffer_;
  std::ptrdiff_t source_pitch_;
};

std::unique_ptr<ImageRows<Fixed>>
decimated(std::unique_ptr<ImageRows<Fixed>> rows, int octaves)
{
  for (int i = 0; i < octaves; ++i)
    rows = std::make_unique<HalvedRows>(std::move(rows));
  return rows;
}

/// Halved horizontally only.
class HalvedColumns final : public ImageRows<Fixed>
{
public:
  explicit HalvedColumns(std::unique_ptr<ImageRows<Fixed>> source)
      : ImageRows({ level_size(source->size(), 1).width, source->size().height },
                  source->channels()),
        source_(std::move(source)), buffer_(1, size().width, channels()),
        source_pitch_(RowBuffer<Fixed>::pitch(source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const Fixed *row(int y) override
  {
    const Fixed *samples = source_->row(y);
    for (int c = 0; c < channels(); ++c)
      kernels::halve_columns(samples + c * source_pitch_, source_->size().width,
                             buffer_.row(0) + c * buffer_.pitch());
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Fixed>> source_;
  RowBuffer<Fixed> buffer_;
  std::ptrdiff_t source_pitch_;
};

/// Halved vertically only.
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

/// Twice as wide, interpolated on the pyramid's grid; the last sample is repeated.
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

/// Twice as high, in the same way.
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
  int next_ = 0; ///< first source row not held yet
  RowBuffer<Fixed> held_;
  RowBuffer<Fixed> buffer_;
};

/// Halves 8-bit rows by `octaves`: `make` reads and decimates rows of an image of that `height`.
template <typename Make>
std::unique_ptr<ImageRows<Fixed>>
decimated_bytes(const Make &make, int height, int octaves)
{
  if (octaves == 0)
    return make(ByteDecimation::none);
  const bool quartered = octaves > 1 && height >= kFewestToQuarter;
  std::unique_ptr<ImageRows<Fixed>> rows
      = quartered ? std::make_unique<HalvedColumns>(make(ByteDecimation::quartered))
                  : make(ByteDecimation::halved);
  return decimated(std::move(rows), octaves - (quartered ? 2 : 1));
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
  // Halvings still needed along each axis; negative where subsampling already went too far.
  const Component &samples = frame.components[component];
  const int columns = level - subsampling(frame.width, samples.width);
  const int rows = level - subsampling(frame.height, samples.height);
  const int both = std::max(0, std::min(columns, rows));

  const auto bytes = [&samples, component](ByteDecimation decimation) {
    return byte_samples(samples, component, decimation);
  };
  auto image = frame.depth == 8
                   ? decimated_bytes(bytes, samples.height, both)
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

namespace {

/// Whether the bytes of these components are adjacent, in any order.
bool
side_by_side(std::span<const Component> components)
{
  const Component &first = *std::ranges::min_element(components, std::less<>(), &Component::data);
  std::size_t places = 0; // one bit each
  for (const Component &component : components) {
    const auto place = static_cast<std::size_t>(component.data - first.data);
    if (place >= components.size() || component.pixel_stride != first.pixel_stride
        || component.row_stride != first.row_stride || component.width != first.width
        || component.height != first.height)
      return false;
    places |= std::size_t{ 1 } << place;
  }
  return places + 1 == std::size_t{ 1 } << components.size();
}

} // namespace

bool
has_byte_triples(const FrameView &frame)
{
  return frame.model != ColorModel::gray && frame.depth == 8
         && frame.components[0].pixel_stride >= 3 && side_by_side(frame.components);
}

bool
has_byte_pairs(const FrameView &frame)
{
  return frame.model != ColorModel::gray && frame.depth == 8
         && frame.components[1].pixel_stride == 2
         && side_by_side(std::span(frame.components).last<2>());
}

std::unique_ptr<ImageRows<Fixed>>
pair_rows(const FrameView &frame, int level)
{
  const Component &chroma = frame.components[1];
  const int columns = level - subsampling(frame.width, chroma.width);
  const int rows = level - subsampling(frame.height, chroma.height);
  if (columns != rows || columns < 1)
    return nullptr;
  const auto bytes = [&frame](ByteDecimation decimation) {
    return byte_pairs(frame, decimation);
  };
  return decimated_bytes(bytes, chroma.height, columns);
}

std::unique_ptr<ImageRows<Fixed>>
pixel_rows(const FrameView &frame, int level)
{
  const auto bytes = [&frame](ByteDecimation decimation) {
    return byte_pixels(frame, decimation);
  };
  return decimated_bytes(bytes, frame.height, level);
}

std::unique_ptr<ImageRows<Fixed>>
halved_rows(std::unique_ptr<ImageRows<Fixed>> source)
{
  return decimated(std::move(source), 1);
}

} // namespace saliency
