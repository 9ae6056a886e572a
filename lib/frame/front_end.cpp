// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/front_end.h"

#include "frame/component_rows.h"
#include "frame/lab.h"
#include "frame/levels.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>

namespace saliency {

namespace {

std::size_t
component_count(const FrameView &frame)
{
  return frame.model == ColorModel::gray ? 1 : 3;
}

/// L*a*b* rows of a frame at one level: three channels, as LabConverter makes them.
class LabRows final : public ImageRows<Fixed>
{
public:
  LabRows(const FrameView &frame, int level)
      : ImageRows(level_size({ frame.width, frame.height }, level), 3), buffer_(1, size().width, 3)
  {
    if (has_byte_triples(frame)) {
      components_.push_back(pixel_rows(frame, level));
      return;
    }
    components_.push_back(component_rows(frame, 0, level));
    if (auto pairs = has_byte_pairs(frame) ? pair_rows(frame, level) : nullptr)
      components_.push_back(std::move(pairs));
    else
      for (std::size_t i = 1; i < component_count(frame); ++i)
        components_.push_back(component_rows(frame, i, level));
  }

  void begin(const FrameView &frame) override
  {
    converter_ = LabConverter({ frame.model, frame.depth, frame.full_range, frame.matrix });
    for (const auto &component : components_)
      component->begin(frame);
  }

  const Fixed *row(int y) override
  {
    std::array<const Fixed *, 3> rows{};
    std::size_t next = 0;
    for (const auto &component : components_) {
      const Fixed *row = component->row(y);
      for (int c = 0; c < component->channels(); ++c)
        rows[next++] = row + c * buffer_.pitch();
    }
    Fixed *lab = buffer_.row(0);
    converter_.convert(rows, size().width,
                       { lab, lab + buffer_.pitch(), lab + 2 * buffer_.pitch() });
    return lab;
  }

private:
  std::vector<std::unique_ptr<ImageRows<Fixed>>> components_;
  LabConverter converter_;
  RowBuffer<Fixed> buffer_;
};

/// Rows [begin, end) of the image.
void
make_rows(ImageRows<Fixed> &band, int begin, int end, FixedLabImage &image)
{
  const int width = image.size().width;
  for (int y = begin; y < end; ++y) {
    const Fixed *lab = band.row(y);
    for (auto &plane : image.planes) {
      std::copy_n(lab, width, plane.ptr<Fixed>(y));
      lab += RowBuffer<Fixed>::pitch(width);
    }
  }
}

/// How many samples level `n` has.
long long
samples(cv::Size frame, int n)
{
  const cv::Size size = level_size(frame, n);
  return static_cast<long long>(size.width) * size.height;
}

} // namespace

int
decimation_level(cv::Size frame, int level)
{
  constexpr int kSamples = 150'000;
  int decimated = 0;
  while (decimated < level && samples(frame, decimated) > kSamples)
    ++decimated;
  return decimated;
}

std::string_view
fault_of(const FrameView &frame)
{
  if (frame.width < 1 || frame.height < 1)
    return "a frame is at least 1×1";
  const std::string_view fault = fault_of(SampleCoding{ .model = frame.model,
                                                        .depth = frame.depth,
                                                        .full_range = frame.full_range,
                                                        .matrix = frame.matrix });
  if (!fault.empty())
    return fault;
  const int bits = frame.depth == 8 ? 8 : 16;
  if (frame.shift < 0 || frame.depth + frame.shift > bits)
    return "a sample does not fit its word";
  for (const auto &component : std::span(frame.components).first(component_count(frame))) {
    if (component.data == nullptr)
      return "a component has no data";
    if (component.pixel_stride < bits / 8)
      return "samples of a component overlap";
    if (subsampling(frame.width, component.width) < 0
        || subsampling(frame.height, component.height) < 0)
      return "a component's size is not the frame's over a power of two";
  }
  if (frame.components[0].width != frame.width || frame.components[0].height != frame.height)
    return "the first component has the frame's size";
  return {};
}

void
FrontEnd::set_threads(int threads)
{
  threads = std::max(threads, 1);
  if (std::exchange(threads_, threads) != threads)
    geometry_ = {};
}

void
FrontEnd::make_bands(const FrameView &frame, const Geometry &geometry)
{
  geometry_ = {};
  bands_.clear();
  for (auto &plane : lab_.planes)
    plane.create(level_size({ frame.width, frame.height }, geometry.level), CV_16UC1);
  for (int i = 0; i < std::min(threads_, lab_.size().height); ++i) {
    std::unique_ptr<ImageRows<Fixed>> band = std::make_unique<LabRows>(frame, geometry.converted);
    for (int n = geometry.converted; n < geometry.level; ++n)
      band = halved_rows(std::move(band));
    bands_.push_back(std::move(band));
  }
  geometry_ = geometry;
}

const FixedLabImage &
FrontEnd::lab(const FrameView &frame, int level, int converted)
{
  assert(fault_of(frame).empty());
  assert(converted >= 0 && converted <= level);
  Geometry geometry{ .model = frame.model,
                     .bytes = frame.depth == 8,
                     .triple_stride
                     = has_byte_triples(frame) ? frame.components[0].pixel_stride : 0,
                     .byte_pairs = has_byte_pairs(frame),
                     .level = level,
                     .converted = converted };
  for (std::size_t i = 0; i < component_count(frame); ++i)
    geometry.components[i] = { frame.components[i].width, frame.components[i].height };
  if (geometry != geometry_)
    make_bands(frame, geometry);

  shares_.reset(lab_.size().height, static_cast<int>(bands_.size()));
  pool_.run(static_cast<int>(bands_.size()), [this, &frame](int thread) {
    ImageRows<Fixed> &band = *bands_[static_cast<std::size_t>(thread)];
    band.begin(frame);
    int next = 0; // the row at which the band can continue
    for (auto rows = shares_.take(thread); rows.begin < rows.end; rows = shares_.take(thread)) {
      if (rows.begin < next)
        band.begin(frame);
      make_rows(band, rows.begin, rows.end, lab_);
      next = rows.end;
    }
  });
  return lab_;
}

} // namespace saliency
