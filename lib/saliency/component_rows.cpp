// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/component_rows.h"

#include "saliency/front_end_kernels.h"
#include "saliency/pyramid.h"
#include "saliency/rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace saliency {

namespace {

/// The samples of a component: of 16-bit words their significant bits, at the top.
template <typename Sample> class SampleRows final : public ImageRows<Sample>
{
public:
  SampleRows(const Component &component, std::size_t index)
      : ImageRows<Sample>({ component.width, component.height }), index_(index),
        buffer_(1, component.width)
  {
  }

  void begin(const FrameView &frame) override
  {
    component_ = frame.components[index_];
    left_ = 16 - frame.depth - frame.shift;
    mask_ = 0xffffU << (16 - frame.depth) & 0xffffU;
  }

  const Sample *row(int y) override
  {
    const std::uint8_t *in = component_.data + y * component_.row_stride;
    if constexpr (sizeof(Sample) == 1) {
      if (component_.pixel_stride == 1)
        return in;
      kernels::unpack(in, component_.pixel_stride, component_.width, buffer_.row(0));
    } else
      kernels::unpack(in, component_.pixel_stride, left_, mask_, component_.width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::size_t index_;
  Component component_;
  int left_ = 0;
  unsigned mask_ = 0;
  RowBuffer<Sample> buffer_;
};

/// The samples of pixels whose three bytes lie side by side.
class PixelRows final : public ImageRows<std::uint8_t>
{
public:
  explicit PixelRows(cv::Size size) : ImageRows(size, 3), buffer_(1, size.width, 3)
  {
  }

  void begin(const FrameView &frame) override
  {
    const auto by_address = [](const Component &a, const Component &b) {
      return std::less<>()(a.data, b.data);
    };
    first_ = *std::ranges::min_element(frame.components, by_address);
    for (std::size_t c = 0; c < 3; ++c)
      places_[static_cast<std::size_t>(frame.components[c].data - first_.data)]
          = buffer_.row(0) + static_cast<std::ptrdiff_t>(c) * buffer_.pitch();
  }

  const std::uint8_t *row(int y) override
  {
    kernels::unpack_triples(first_.data + y * first_.row_stride, first_.pixel_stride, size().width,
                            places_);
    return buffer_.row(0);
  }

private:
  Component first_;                        ///< in memory
  std::array<std::uint8_t *, 3> places_{}; ///< rows for the bytes of a pixel
  RowBuffer<std::uint8_t> buffer_;
};

/// Halved along both axes; `Sum` holds 16 times a sample, `Half` what halve_rows makes of five of them.
template <typename Sample, typename Sum, typename Half>
class HalvedRows final : public ImageRows<Half>
{
public:
  explicit HalvedRows(std::unique_ptr<ImageRows<Sample>> source)
      : ImageRows<Half>(level_size(source->size(), 1), source->channels()),
        source_(std::move(source)),
        sums_(source_->size().height, this->size().width, this->channels()),
        buffer_(1, this->size().width, this->channels()),
        source_pitch_(RowBuffer<Sample>::pitch(source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    sums_.begin();
  }

  const Half *row(int y) override
  {
    sums_.advance(y, [this](int source_y, Sum *sums) {
      const Sample *samples = source_->row(source_y);
      for (int c = 0; c < this->channels(); ++c)
        kernels::halve_columns(samples + c * source_pitch_, source_->size().width,
                               sums + c * sums_.pitch());
    });
    for (int c = 0; c < this->channels(); ++c)
      kernels::halve_rows(sums_.channel(c), this->size().width,
                          buffer_.row(0) + c * buffer_.pitch());
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Sample>> source_;
  FiveRows<Sum> sums_;
  RowBuffer<Half> buffer_;
  std::ptrdiff_t source_pitch_;
};

/// Integer samples as code values. Bytes that were halved are 16-bit, with eight bits after the point.
template <typename Sample> class FloatRows final : public ImageRows<float>
{
public:
  explicit FloatRows(std::unique_ptr<ImageRows<Sample>> source)
      : ImageRows(source->size(), source->channels()), source_(std::move(source)),
        buffer_(1, size().width, channels())
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    constexpr int bits = 8 * sizeof(Sample);
    scale_ = std::ldexp(1.0F, frame.depth - bits);
  }

  const float *row(int y) override
  {
    const Sample *samples = source_->row(y);
    for (int c = 0; c < channels(); ++c)
      kernels::to_float(samples + c * RowBuffer<Sample>::pitch(size().width), size().width, scale_,
                        buffer_.row(0) + c * buffer_.pitch());
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Sample>> source_;
  RowBuffer<float> buffer_;
  float scale_ = 1;
};

/// Halved from side to side alone.
class HalvedColumns final : public ImageRows<float>
{
public:
  explicit HalvedColumns(std::unique_ptr<ImageRows<float>> source)
      : ImageRows({ level_size(source->size(), 1).width, source->size().height }),
        source_(std::move(source)), buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const float *row(int y) override
  {
    kernels::halve_columns(source_->row(y), source_->size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<float>> source_;
  RowBuffer<float> buffer_;
};

/// Halved from top to bottom alone.
class HalvedHeight final : public ImageRows<float>
{
public:
  explicit HalvedHeight(std::unique_ptr<ImageRows<float>> source)
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

  const float *row(int y) override
  {
    rows_.advance(y, [this](int source_y, float *row) {
      std::copy_n(source_->row(source_y), size().width, row);
    });
    kernels::halve_rows(rows_.channel(0), size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<float>> source_;
  FiveRows<float> rows_;
  RowBuffer<float> buffer_;
};

/// Interpolated on the pyramid's grid, the last sample repeated beyond it.
class UpsampledColumns final : public ImageRows<float>
{
public:
  UpsampledColumns(std::unique_ptr<ImageRows<float>> source, int octaves, int width)
      : ImageRows({ width, source->size().height }), source_(std::move(source)), octaves_(octaves),
        buffer_(1, width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  const float *row(int y) override
  {
    rows::enlarge(source_->row(y), static_cast<std::size_t>(source_->size().width), octaves_,
                  static_cast<std::size_t>(size().width), buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<float>> source_;
  int octaves_;
  RowBuffer<float> buffer_;
};

class UpsampledHeight final : public ImageRows<float>
{
public:
  UpsampledHeight(std::unique_ptr<ImageRows<float>> source, int octaves, int height)
      : ImageRows({ source->size().width, height }), source_(std::move(source)), octaves_(octaves),
        held_(2, size().width), buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
    next_ = 0;
  }

  const float *row(int y) override
  {
    const RowPosition at = locate_row(y, octaves_, source_->size().height);
    for (next_ = std::max(next_, at.before); next_ <= at.after; ++next_)
      std::copy_n(source_->row(next_), size().width, held_.row(next_ % 2));
    if (at.weight == 0)
      return held_.row(at.before % 2);
    rows::interpolate(held_.row(at.before % 2), held_.row(at.after % 2), at.weight,
                      static_cast<std::size_t>(size().width), buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<float>> source_;
  int octaves_;
  int next_ = 0; ///< row of the source that is not held yet
  RowBuffer<float> held_;
  RowBuffer<float> buffer_;
};

/// Halved so often, as code values.
std::unique_ptr<ImageRows<float>>
decimated(std::unique_ptr<ImageRows<std::uint16_t>> rows, int octaves)
{
  for (int i = 0; i < octaves; ++i)
    rows = std::make_unique<HalvedRows<std::uint16_t, std::uint32_t, std::uint16_t>>(
        std::move(rows));
  return std::make_unique<FloatRows<std::uint16_t>>(std::move(rows));
}

std::unique_ptr<ImageRows<float>>
decimated(std::unique_ptr<ImageRows<std::uint8_t>> rows, int octaves)
{
  if (octaves == 0)
    return std::make_unique<FloatRows<std::uint8_t>>(std::move(rows));
  return decimated(
      std::make_unique<HalvedRows<std::uint8_t, std::uint16_t, std::uint16_t>>(std::move(rows)),
      octaves - 1);
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

std::unique_ptr<ImageRows<float>>
component_rows(const FrameView &frame, std::size_t component, int level)
{
  // What there is to do along each axis; subsampling has done some of it already, or too much.
  const Component &samples = frame.components[component];
  const int columns = level - subsampling(frame.width, samples.width);
  const int rows = level - subsampling(frame.height, samples.height);
  const int both = std::max(0, std::min(columns, rows));

  auto image
      = frame.depth == 8
            ? decimated(std::make_unique<SampleRows<std::uint8_t>>(samples, component), both)
            : decimated(std::make_unique<SampleRows<std::uint16_t>>(samples, component), both);
  for (int i = both; i < columns; ++i)
    image = std::make_unique<HalvedColumns>(std::move(image));
  for (int i = both; i < rows; ++i)
    image = std::make_unique<HalvedHeight>(std::move(image));
  const cv::Size size = level_size({ frame.width, frame.height }, level);
  if (rows < 0)
    image = std::make_unique<UpsampledHeight>(std::move(image), -rows, size.height);
  if (columns < 0)
    image = std::make_unique<UpsampledColumns>(std::move(image), -columns, size.width);
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

std::unique_ptr<ImageRows<float>>
pixel_rows(const FrameView &frame, int level)
{
  return decimated(std::make_unique<PixelRows>(cv::Size(frame.width, frame.height)), level);
}

std::unique_ptr<ImageRows<float>>
halved_rows(std::unique_ptr<ImageRows<float>> source)
{
  return std::make_unique<HalvedRows<float, float, float>>(std::move(source));
}

} // namespace saliency
