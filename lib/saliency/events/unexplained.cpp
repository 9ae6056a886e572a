// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/unexplained.h"

#include "saliency/dilation.h"
#include "saliency/quantile.h"
#include "saliency/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/events/unexplained.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

#ifndef SALIENCY_UNEXPLAINED_ONCE
#define SALIENCY_UNEXPLAINED_ONCE
namespace saliency {
namespace {

constexpr float kTexture = 1.6F;    ///< gradient of a textured place, L* per sample
constexpr float kNoise = 0.31F;     ///< ΔE, of the best of pictures
constexpr float kMisfit = 0.1F;     ///< least error of the alignment, samples
constexpr float kMisfitGain = 1.2F; ///< of the error that the pictures show
constexpr float kBeyond = 2.5F;     ///< σ of the noise
constexpr float kChroma = 0.3F; ///< weight of Δa² + Δb²: films store it at half the resolution
constexpr std::size_t kFewest = 24; ///< samples that show noise
// An object alone on an even ground has all of the texture, and would explain its own motion.
constexpr int kParts = 4;        ///< of each side
constexpr int kFewestParts = 5;  ///< that have texture
constexpr int kFewestOfPart = 4; ///< samples
// The exposure is compared by means over blocks: interpolation takes contrast from texture.
constexpr int kBlockColumns = 20;
constexpr int kBlockRows = 11;
constexpr std::array kScales{ 12.0, 5.0, 2.4, 2.4 }; ///< of residuals, L*
constexpr double kVariance = 3;                      ///< pulls the gain to 1, L*²
constexpr double kSteady = 0.02;                     ///< a gain this near to 1 is none
constexpr double kSteadyOffset = 0.27;               ///< L*

/// The planes of two pictures; the chroma's are null where one has none.
struct Planes
{
  std::array<const float *, 3> now;
  std::array<const float *, 3> then;
};

/// Two selections of samples.
struct Sorted
{
  std::size_t even = 0;
  std::size_t textured = 0;
};

} // namespace
} // namespace saliency
#endif

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Adds a row to the sums of its columns, where `then` is known.
void
add_row(const float *now, const float *then, std::size_t n, double *sum_now, double *sum_then,
        double *count)
{
  each_once<double>(n, [&](auto d, std::size_t x) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto past = hn::PromoteTo(d, hn::LoadU(narrow, then + x));
    const auto seen = hn::Eq(past, past);
    const auto add = [&](double *sum, auto value) HWY_ATTR {
      hn::StoreU(hn::Add(hn::LoadU(d, sum + x), hn::IfThenElseZero(seen, value)), d, sum + x);
    };
    add(sum_now, hn::PromoteTo(d, hn::LoadU(narrow, now + x)));
    add(sum_then, past);
    add(count, hn::Set(d, 1.0));
  });
}

/// The larger gradient of two pictures, of a row's samples; `above` and `below` are distances.
void
gradients(const float *now, const float *then, std::ptrdiff_t above, std::ptrdiff_t below, int n,
          float *out)
{
  const auto make
      = [&](auto d, std::ptrdiff_t x, std::ptrdiff_t left, std::ptrdiff_t right) HWY_ATTR {
          const auto squared = [&](const float *row) HWY_ATTR {
            const auto dx = hn::Sub(hn::LoadU(d, row + right), hn::LoadU(d, row + left));
            const auto dy = hn::Sub(hn::LoadU(d, row + x + below), hn::LoadU(d, row + x - above));
            return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
          };
          const auto one = squared(now);
          const auto other = squared(then);
          const auto most = hn::IfThenElse(hn::Gt(other, one), other, one); // NaN is not greater
          hn::StoreU(hn::Mul(hn::Sqrt(most), hn::Set(d, 0.5F)), d, out + x);
        };
  make(OneLane<float>(), 0, 0, std::min(1, n - 1));
  make(OneLane<float>(), n - 1, std::max(0, n - 2), n - 1);
  cover<float>(n - 2, [&](auto d, std::ptrdiff_t x) HWY_ATTR { make(d, x + 1, x, x + 2); });
}

/// ΔE; NaN where `then` is.
void
differences(const Planes &planes, float gain, float offset, std::size_t n, float *out)
{
  const bool chroma = planes.now[1] && planes.then[1];
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto load = [&](const float *plane) HWY_ATTR {
      return hn::LoadU(d, plane + i);
    };
    const auto past = hn::Add(hn::Mul(hn::Set(d, gain), load(planes.then[0])), hn::Set(d, offset));
    auto difference = hn::Abs(hn::Sub(load(planes.now[0]), past));
    if (chroma) {
      const auto a = hn::Sub(load(planes.now[1]), load(planes.then[1]));
      const auto b = hn::Sub(load(planes.now[2]), load(planes.then[2]));
      const auto squared = hn::Add(hn::Mul(a, a), hn::Mul(b, b));
      difference = hn::Sqrt(
          hn::Add(hn::Mul(difference, difference), hn::Mul(hn::Set(d, kChroma), squared)));
    }
    hn::StoreU(difference, d, out + i);
  });
}

/// Differences of even places, and those of textured ones in samples of displacement.
Sorted
sort(const float *difference, const float *gradient, std::size_t n, float *even, float *textured)
{
  Sorted sorted;
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto value = hn::LoadU(d, difference + i);
    const auto slope = hn::LoadU(d, gradient + i);
    const auto known = hn::Eq(value, value);
    const auto steep = hn::Gt(slope, hn::Set(d, kTexture));
    sorted.even += compress(d, value, hn::AndNot(steep, known), even + sorted.even);
    sorted.textured
        += compress(d, hn::Div(value, slope), hn::And(steep, known), textured + sorted.textured);
  });
  return sorted;
}

/// Counts the textured samples of each column.
void
count_textured(const float *difference, const float *gradient, std::size_t n, float *counts)
{
  each_once<float>(n, [&](auto d, std::size_t x) HWY_ATTR {
    const auto value = hn::LoadU(d, difference + x);
    const auto steep = hn::Gt(hn::LoadU(d, gradient + x), hn::Set(d, kTexture));
    const auto one = hn::IfThenElseZero(hn::And(steep, hn::Eq(value, value)), hn::Set(d, 1.0F));
    hn::StoreU(hn::Add(hn::LoadU(d, counts + x), one), d, counts + x);
  });
}

/// The difference above what noise and texture explain; 0 also where it is NaN.
void
beyond(const float *difference, const float *gradient, float noise, float slope, std::size_t n,
       float *out)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto texture = hn::Mul(hn::Set(d, slope), hn::LoadU(d, gradient + i));
    const auto most
        = hn::Mul(hn::Set(d, kBeyond),
                  hn::Sqrt(hn::Add(hn::Set(d, noise * noise), hn::Mul(texture, texture))));
    const auto value = hn::Sub(hn::LoadU(d, difference + i), most);
    hn::StoreU(hn::IfThenElseZero(hn::Gt(value, hn::Zero(d)), value), d, out + i);
  });
}

void
split(const float *beyond, const float *difference, const float *now, const float *then, float gain,
      float offset, std::size_t n, float *brighter, float *darker)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto value = hn::LoadU(d, beyond + i);
    const auto past
        = hn::Add(hn::Mul(hn::Set(d, gain), hn::LoadU(d, then + i)), hn::Set(d, offset));
    const auto rise = hn::Sub(hn::LoadU(d, now + i), past);
    const auto share
        = hn::IfThenElseZero(hn::Gt(value, hn::Zero(d)),
                             hn::Div(hn::Mul(value, hn::Abs(rise)), hn::LoadU(d, difference + i)));
    const auto rises = hn::Gt(rise, hn::Zero(d));
    hn::StoreU(hn::IfThenElseZero(rises, share), d, brighter + i);
    hn::StoreU(hn::IfThenZeroElse(rises, share), d, darker + i);
  });
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(add_row);
HWY_EXPORT(gradients);
HWY_EXPORT(differences);
HWY_EXPORT(sort);
HWY_EXPORT(count_textured);
HWY_EXPORT(beyond);
HWY_EXPORT(split);

void
Unexplained::align(const LabImage &then, const Similarity &before)
{
  for (std::size_t c = 0; c < 3; ++c)
    if (then.planes[c].empty())
      then_[c].release();
    else if (before == Similarity{} || then.size().width < 2 || then.size().height < 2)
      then_[c] = then.planes[c];
    else {
      warp(then.planes[c], before, warped_[c]);
      then_[c] = warped_[c];
    }
}

/// Gain and offset of `now`'s lightness, robustly.
void
Unexplained::find_exposure(const cv::Mat &now)
{
  struct Block
  {
    double now = 0;
    double then = 0;
    double count = 0;
  };
  std::array<Block, static_cast<std::size_t>(kBlockColumns * kBlockRows)> blocks;
  const auto width = static_cast<std::size_t>(now.cols);
  for (int y = 0; y < now.rows;) {
    const int block_row = y * kBlockRows / now.rows;
    columns_.assign(3 * width, 0);
    for (; y < now.rows && y * kBlockRows / now.rows == block_row; ++y)
      HWY_DYNAMIC_DISPATCH(add_row)
    (now.ptr<float>(y), then_[0].ptr<float>(y), width, &columns_[0], &columns_[width],
     &columns_[2 * width]);
    for (std::size_t x = 0; x < width; ++x) {
      Block &block
          = blocks[static_cast<std::size_t>(block_row * kBlockColumns) + x * kBlockColumns / width];
      block.now += columns_[x];
      block.then += columns_[width + x];
      block.count += columns_[2 * width + x];
    }
  }
  double gain = 1;
  double offset = 0;
  double mean_then = 0;
  for (const double scale : kScales) {
    double sum = 0;
    double u = 0;
    double v = 0;
    double uu = 0;
    double vv = 0;
    for (const Block &block : blocks) {
      if (block.count == 0)
        continue;
      const double past = block.then / block.count;
      const double present = block.now / block.count;
      const double residual = (present - gain * past - offset) / scale;
      const double weight = 1 / ((1 + residual * residual) * (1 + residual * residual));
      sum += weight;
      u += weight * past;
      v += weight * present;
      uu += weight * past * past;
      vv += weight * present * present;
    }
    if (sum <= 0)
      break;
    mean_then = u / sum;
    const double mean_now = v / sum;
    gain = std::sqrt((std::max(0.0, vv / sum - mean_now * mean_now) + kVariance)
                     / (std::max(0.0, uu / sum - mean_then * mean_then) + kVariance));
    offset = mean_now - gain * mean_then;
  }
  if (std::abs(gain - 1) < kSteady && std::abs(offset + (gain - 1) * mean_then) < kSteadyOffset) {
    gain = 1;
    offset = 0;
  }
  gain_ = static_cast<float>(gain);
  offset_ = static_cast<float>(offset);
}

void
Unexplained::find_gradients(const cv::Mat &now)
{
  gradients_.create(now.size(), CV_32FC1);
  for (int y = 0; y < now.rows; ++y)
    HWY_DYNAMIC_DISPATCH(gradients)
  (now.ptr<float>(y), then_[0].ptr<float>(y), y > 0 ? now.cols : 0, y + 1 < now.rows ? now.cols : 0,
   now.cols, gradients_.ptr<float>(y));
  dilate(gradients_, 1, along_rows_, around_);
}

/// Whether enough of the picture's parts have texture.
bool
Unexplained::has_texture()
{
  const cv::Size size = difference_.size();
  const auto width = static_cast<std::size_t>(size.width);
  int parts = 0;
  for (int y = 0; y < size.height;) {
    const int part_row = y * kParts / size.height;
    counts_.assign(width, 0);
    for (; y < size.height && y * kParts / size.height == part_row; ++y)
      HWY_DYNAMIC_DISPATCH(count_textured)
    (difference_.ptr<float>(y), around_.ptr<float>(y), width, counts_.data());
    std::array<float, static_cast<std::size_t>(kParts)> textured{};
    for (std::size_t x = 0; x < width; ++x)
      textured[x * kParts / width] += counts_[x];
    parts += static_cast<int>(
        std::ranges::count_if(textured, [](float count) { return count >= kFewestOfPart; }));
  }
  return parts >= kFewestParts;
}

const cv::Mat &
Unexplained::operator()(const LabImage &now, const LabImage &then, const Similarity &before)
{
  const cv::Mat &lightness = now.lightness();
  align(then, before);
  find_exposure(lightness);
  find_gradients(lightness);
  difference_.create(lightness.size(), CV_32FC1);
  beyond_.create(lightness.size(), CV_32FC1);
  const std::size_t total = difference_.total();
  auto *difference = difference_.ptr<float>();
  const auto *gradient = around_.ptr<float>();
  Planes planes{};
  for (std::size_t c = 0; c < 3; ++c)
    if (!then_[c].empty() && !now.planes[c].empty()) {
      planes.now[c] = now.planes[c].ptr<float>();
      planes.then[c] = then_[c].ptr<float>();
    }
  HWY_DYNAMIC_DISPATCH(differences)(planes, gain_, offset_, total, difference);
  even_.resize(total);
  textured_.resize(total);
  const Sorted sorted
      = HWY_DYNAMIC_DISPATCH(sort)(difference, gradient, total, even_.data(), textured_.data());
  const auto even = std::span(even_).first(sorted.even);
  const auto textured = std::span(textured_).first(sorted.textured);
  misfit_ = textured.size() >= kFewest && has_texture() ? quantile(textured, 0.5) : 0;
  const float noise = kNoise + (even.size() < kFewest ? 0 : 1.48F * quantile(even, 0.5));
  const float slope = kMisfit + kMisfitGain * misfit_;
  HWY_DYNAMIC_DISPATCH(beyond)
  (difference, gradient, noise, slope, total, beyond_.ptr<float>());
  return beyond_;
}

void
Unexplained::split(const LabImage &now, cv::Mat &brighter, cv::Mat &darker) const
{
  for (cv::Mat *map : { &brighter, &darker })
    map->create(beyond_.size(), CV_32FC1);
  HWY_DYNAMIC_DISPATCH(split)
  (beyond_.ptr<float>(), difference_.ptr<float>(), now.lightness().ptr<float>(),
   then_[0].ptr<float>(), gain_, offset_, beyond_.total(), brighter.ptr<float>(),
   darker.ptr<float>());
}

} // namespace saliency
#endif
