// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/component_rows.h"

#include "saliency/front_end_kernels.h"
#include "saliency/pyramid.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

namespace saliency {

namespace {

/// The samples of a component, from the frame's memory.
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
    shift_ = frame.shift;
    mask_ = (1U << frame.depth) - 1;
  }

  Sample *row(int y) override
  {
    const std::uint8_t *in = component_.data + y * component_.row_stride;
    if constexpr (sizeof(Sample) == 1)
      kernels::unpack(in, component_.pixel_stride, component_.width, buffer_.row(0));
    else
      kernels::unpack(in, component_.pixel_stride, shift_, mask_, component_.width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::size_t index_;
  Component component_;
  int shift_ = 0;
  unsigned mask_ = 0;
  RowBuffer<Sample> buffer_;
};

/// The five rows about row y of an image of half the height, mirrored: kept in a ring that is filled
/// as y rises.
template <typename T> class FiveRows
{
public:
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
      const int at = cv::borderInterpolate(2 * y - 2 + i, rows_, cv::BORDER_REFLECT_101);
      about_[static_cast<std::size_t>(i)] = ring_.row(at % kRing);
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

/// Halved along both axes; `Sum` holds 16 times a sample.
template <typename Sample, typename Sum> class HalvedRows final : public ImageRows<Sample>
{
public:
  explicit HalvedRows(std::unique_ptr<ImageRows<Sample>> source)
      : ImageRows<Sample>(level_size(source->size(), 1), source->channels()),
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

  Sample *row(int y) override
  {
    sums_.advance(y, [this](int source_y, Sum *sums) {
      Sample *samples = source_->row(source_y);
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
  RowBuffer<Sample> buffer_;
  std::ptrdiff_t source_pitch_;
};

/// Integer samples as real numbers.
template <typename Sample> class FloatRows final : public ImageRows<float>
{
public:
  explicit FloatRows(std::unique_ptr<ImageRows<Sample>> source)
      : ImageRows(source->size()), source_(std::move(source)), buffer_(1, size().width)
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  float *row(int y) override
  {
    kernels::to_float(source_->row(y), size().width, buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<Sample>> source_;
  RowBuffer<float> buffer_;
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

  float *row(int y) override
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

  float *row(int y) override
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
        buffer_(1, std::max(width, 2 * source_->size().width))
  {
  }

  void begin(const FrameView &frame) override
  {
    source_->begin(frame);
  }

  float *row(int y) override
  {
    float *in = source_->row(y);
    float *out = buffer_.row(0);
    const int width = source_->size().width;
    if (octaves_ == 1) {
      kernels::double_columns(in, width, out);
      return out;
    }
    in[width] = in[width - 1];
    const int step = 1 << octaves_;
    for (int x = 0; x < size().width; ++x) {
      const float *at = in + (x >> octaves_);
      const auto weight = static_cast<float>(x % step) / static_cast<float>(step);
      out[x] = at[0] + weight * (at[1] - at[0]);
    }
    return out;
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

  float *row(int y) override
  {
    const int before = y >> octaves_;
    const int after = std::min(before + 1, source_->size().height - 1);
    for (next_ = std::max(next_, before); next_ <= after; ++next_)
      std::copy_n(source_->row(next_), size().width, held_.row(next_ % 2));
    const int step = 1 << octaves_;
    const auto weight = static_cast<float>(y % step) / static_cast<float>(step);
    kernels::interpolate(held_.row(before % 2), held_.row(after % 2), weight, size().width,
                         buffer_.row(0));
    return buffer_.row(0);
  }

private:
  std::unique_ptr<ImageRows<float>> source_;
  int octaves_;
  int next_ = 0; ///< row of the source that is not held yet
  RowBuffer<float> held_;
  RowBuffer<float> buffer_;
};

/// The samples halved so often, as real numbers.
template <typename Sample, typename Sum>
std::unique_ptr<ImageRows<float>>
integer_rows(const Component &component, std::size_t index, int octaves)
{
  std::unique_ptr<ImageRows<Sample>> rows = std::make_unique<SampleRows<Sample>>(component, index);
  for (int i = 0; i < octaves; ++i)
    rows = std::make_unique<HalvedRows<Sample, Sum>>(std::move(rows));
  return std::make_unique<FloatRows<Sample>>(std::move(rows));
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

  auto image = frame.depth == 8
                   ? integer_rows<std::uint8_t, std::uint16_t>(samples, component, both)
                   : integer_rows<std::uint16_t, std::uint32_t>(samples, component, both);
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

std::unique_ptr<ImageRows<float>>
halved_rows(std::unique_ptr<ImageRows<float>> source)
{
  return std::make_unique<HalvedRows<float, float>>(std::move(source));
}

} // namespace saliency
