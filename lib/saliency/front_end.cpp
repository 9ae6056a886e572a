// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/front_end.h"

#include "saliency/pyramid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace saliency {

namespace {

std::size_t
component_count(const FrameView &frame)
{
  return frame.model == ColorModel::grey ? 1 : 3;
}

/// k of a component of ⌈frame / 2ᵏ⌉ samples, or -1.
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

void
check(const FrameView &frame)
{
  if (frame.width < 1 || frame.height < 1)
    throw std::invalid_argument("a frame is at least 1×1");
  if (frame.depth < 8 || frame.depth > 16)
    throw std::invalid_argument("a sample has 8 to 16 bits");
  const int bits = frame.depth == 8 ? 8 : 16;
  if (frame.shift < 0 || frame.depth + frame.shift > bits)
    throw std::invalid_argument("a sample does not fit its word");
  for (const auto &component : std::span(frame.components).first(component_count(frame))) {
    if (component.data == nullptr)
      throw std::invalid_argument("a component has no data");
    if (component.pixel_stride < bits / 8)
      throw std::invalid_argument("samples of a component overlap");
    if (subsampling(frame.width, component.width) < 0
        || subsampling(frame.height, component.height) < 0)
      throw std::invalid_argument("a component's size is not the frame's over a power of two");
  }
  if (frame.components[0].width != frame.width || frame.components[0].height != frame.height)
    throw std::invalid_argument("the first component has the frame's size");
}

const std::uint8_t *
row(const Component &component, int y)
{
  return component.data + y * component.row_stride;
}

/// The samples as an image that OpenCV can read: the frame's own memory where it lies suitably,
/// else `buffer`.
cv::Mat
samples_of(const FrameView &frame, const Component &component, cv::Mat &buffer)
{
  const bool bytes = frame.depth == 8;
  if (bytes && component.pixel_stride == 1 && component.row_stride >= component.width)
    return { component.height, component.width, CV_8UC1, const_cast<std::uint8_t *>(component.data),
             static_cast<std::size_t>(component.row_stride) };

  buffer.create(component.height, component.width, bytes ? CV_8UC1 : CV_16UC1);
  const auto mask = (1U << frame.depth) - 1;
  for (int y = 0; y < component.height; ++y) {
    const auto *in = row(component, y);
    if (bytes) {
      auto *out = buffer.ptr<std::uint8_t>(y);
      for (int x = 0; x < component.width; ++x, in += component.pixel_stride)
        out[x] = *in;
    } else {
      auto *out = buffer.ptr<std::uint16_t>(y);
      for (int x = 0; x < component.width; ++x, in += component.pixel_stride)
        out[x] = static_cast<std::uint16_t>(((in[0] | in[1] << 8U) >> frame.shift) & mask);
    }
  }
  return buffer;
}

} // namespace

FrontEnd::FrontEnd(bool exact) : exact_(exact)
{
}

cv::Mat
FrontEnd::at_level(const FrameView &frame, const Component &component, int level, Plane &plane)
{
  // What there is to do along each axis; subsampling has done some of it already, or too much.
  const int columns = level - subsampling(frame.width, component.width);
  const int rows = level - subsampling(frame.height, component.height);
  const int both = std::max(0, std::min(columns, rows));

  cv::Mat samples = samples_of(frame, component, plane.samples);
  plane.reduced.resize(static_cast<std::size_t>(both));
  for (auto &reduced : plane.reduced) {
    reduce(samples, reduced);
    samples = reduced;
  }
  samples.convertTo(plane.values, CV_32F);

  cv::Mat values = plane.values;
  for (int i = both; i < std::max(columns, rows); ++i) {
    auto &reduced = plane.single_axis[static_cast<std::size_t>(i) % 2];
    columns > rows ? reduce_columns(values, reduced) : reduce_rows(values, reduced);
    values = reduced;
  }
  if (columns < 0 || rows < 0) {
    upsample(values, std::max(0, -columns), std::max(0, -rows),
             level_size({ frame.width, frame.height }, level), plane.upsampled);
    values = plane.upsampled;
  }
  return values;
}

const cv::Mat &
FrontEnd::lab(const FrameView &frame, int level)
{
  check(frame);
  std::array<cv::Mat, 3> components;
  const auto count = component_count(frame);
  for (std::size_t i = 0; i < count; ++i)
    components[i] = at_level(frame, frame.components[i], exact_ ? 0 : level, planes_[i]);

  lab_.resize(exact_ ? static_cast<std::size_t>(level) + 1 : 1);
  converter_.convert({ frame.model, frame.depth, frame.full_range, frame.matrix },
                     std::span(components).first(count), lab_[0]);
  for (std::size_t i = 1; i < lab_.size(); ++i)
    reduce(lab_[i - 1], lab_[i]);
  return lab_.back();
}

} // namespace saliency
