// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/sampling.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/sampling.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SALIENCY_SAMPLING_ONCE
#define SALIENCY_SAMPLING_ONCE
namespace saliency {
/// Points come in blocks of this size, and each sum in as many partial sums. The order of additions
/// is then the same for every vector length that divides it.
constexpr std::size_t kBlock = 16;
constexpr std::size_t kSums = 27; ///< upper triangle and right-hand side
} // namespace saliency
#endif

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Bilinear interpolation; undefined where `inside` is false.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V
interpolated(D d, const cv::Mat &image, V x, V y, hn::Mask<D> inside)
{
  const hn::RebindToSigned<D> di;
  x = hn::IfThenElseZero(inside, x);
  y = hn::IfThenElseZero(inside, y);
  const auto left = hn::ConvertTo(di, x); // truncates
  const auto top = hn::ConvertTo(di, y);
  const V right_share = hn::Sub(x, hn::ConvertTo(d, left));
  const V bottom_share = hn::Sub(y, hn::ConvertTo(d, top));
  const auto index = hn::Add(hn::Mul(top, hn::Set(di, image.cols)), left);
  const float *upper = image.ptr<float>();
  const float *lower = upper + image.cols;
  const V upper_left = hn::GatherIndex(d, upper, index);
  const V lower_left = hn::GatherIndex(d, lower, index);
  const V upper_step = hn::Sub(hn::GatherIndex(d, upper + 1, index), upper_left);
  const V lower_step = hn::Sub(hn::GatherIndex(d, lower + 1, index), lower_left);
  const V above = hn::Add(upper_left, hn::Mul(right_share, upper_step));
  const V below = hn::Add(lower_left, hn::Mul(right_share, lower_step));
  return hn::Add(above, hn::Mul(bottom_share, hn::Sub(below, above)));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D>
between(D d, V x, V y, float low, float right, float bottom)
{
  const V zero = hn::Set(d, low);
  return hn::And(hn::And(hn::Ge(x, zero), hn::Ge(y, zero)),
                 hn::And(hn::Lt(x, hn::Set(d, right)), hn::Lt(y, hn::Set(d, bottom))));
}

void
sample(const cv::Mat &image, const Similarity &position, const float *x, const float *y,
       std::size_t n, float *values)
{
  const hn::CappedTag<float, kBlock> d;
  using V = hn::Vec<decltype(d)>;
  const V a = hn::Set(d, static_cast<float>(position.a));
  const V b = hn::Set(d, static_cast<float>(position.b));
  const V tx = hn::Set(d, static_cast<float>(position.tx));
  const V ty = hn::Set(d, static_cast<float>(position.ty));
  const V nothing = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const V px = hn::LoadU(d, x + i);
    const V py = hn::LoadU(d, y + i);
    const V at_x = hn::Add(hn::Sub(hn::Mul(a, px), hn::Mul(b, py)), tx);
    const V at_y = hn::Add(hn::Add(hn::Mul(b, px), hn::Mul(a, py)), ty);
    const auto inside = between(d, at_x, at_y, 0, static_cast<float>(image.cols - 1),
                                static_cast<float>(image.rows - 1));
    const auto seen = hn::And(inside, hn::Ge(px, hn::Zero(d)));
    hn::StoreU(hn::IfThenElse(seen, interpolated(d, image, at_x, at_y, seen), nothing), d,
               values + i);
  }
}

/// sums[k × kBlock + i] += term k of the points i, i + kBlock, …
void
equations(const float *const *change, const float *residuals, std::size_t n, float scale,
          float *sums)
{
  const hn::CappedTag<float, kBlock> d;
  using V = hn::Vec<decltype(d)>;
  const V one = hn::Set(d, 1.0F);
  const V divisor = hn::Set(d, scale * scale);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    V residual = hn::LoadU(d, residuals + i);
    const auto seen = hn::Eq(residual, residual);
    residual = hn::IfThenElseZero(seen, residual);
    const V closeness = hn::Div(one, hn::Add(one, hn::Div(hn::Mul(residual, residual), divisor)));
    const V weight = hn::IfThenElseZero(seen, hn::Mul(closeness, closeness));
    float *sum = sums + i % kBlock;
    const auto add = [&](V product) HWY_ATTR {
      hn::StoreU(hn::Add(hn::LoadU(d, sum), product), d, sum);
      sum += kBlock;
    };
    for (std::size_t m = 0; m < TexturedPoints::kParameters; ++m) {
      const V weighted = hn::Mul(weight, hn::LoadU(d, change[m] + i));
      for (std::size_t k = m; k < TexturedPoints::kParameters; ++k)
        add(hn::Mul(weighted, hn::LoadU(d, change[k] + i)));
      add(hn::Mul(weighted, residual));
    }
  }
}

void
add_sampled(const cv::Mat &image, const Similarity &position, float border, const cv::Mat &now,
            float length, cv::Mat &sum)
{
  const float right = static_cast<float>(image.cols - 1) - border;
  const float bottom = static_cast<float>(image.rows - 1) - border;
  const auto step_x = static_cast<float>(position.a);
  const auto step_y = static_cast<float>(position.b);
  const auto width = static_cast<std::size_t>(sum.cols);
  for (int y = 0; y < sum.rows; ++y) {
    const auto begin_x = static_cast<float>(position.x(0, y));
    const auto begin_y = static_cast<float>(position.y(0, y));
    const auto *current = now.ptr<float>(y);
    auto *row = sum.ptr<float>(y);
    const auto add = [&](auto d, std::size_t i) HWY_ATTR {
      const auto x = hn::Iota(d, static_cast<float>(i));
      const auto at_x = hn::Add(hn::Set(d, begin_x), hn::Mul(hn::Set(d, step_x), x));
      const auto at_y = hn::Add(hn::Set(d, begin_y), hn::Mul(hn::Set(d, step_y), x));
      const auto inside = between(d, at_x, at_y, border, right, bottom);
      const auto value = interpolated(d, image, at_x, at_y, inside);
      const auto so_far = hn::LoadU(d, row + i);
      const auto change = hn::Sub(value, hn::Mul(hn::Set(d, length), hn::LoadU(d, current + i)));
      hn::StoreU(hn::IfThenElse(inside, hn::Add(so_far, change), so_far), d, row + i);
    };
    const hn::CappedTag<float, kBlock> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= width; i += hn::Lanes(d))
      add(d, i);
    for (; i < width; ++i)
      add(hn::CappedTag<float, 1>(), i);
  }
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(sample);
HWY_EXPORT(equations);
HWY_EXPORT(add_sampled);

void
TexturedPoints::clear()
{
  x.clear();
  y.clear();
  lightness.clear();
  for (auto &values : change)
    values.clear();
  size_ = 0;
}

void
TexturedPoints::add(float px, float py, float value, const std::array<float, kParameters> &by)
{
  x.push_back(px);
  y.push_back(py);
  lightness.push_back(value);
  for (std::size_t m = 0; m < kParameters; ++m)
    change[m].push_back(by[m]);
}

void
TexturedPoints::finish()
{
  size_ = x.size();
  while (x.size() % kBlock != 0)
    add(-1, -1, 0, {});
}

void
sample(const cv::Mat &image, const Similarity &position, const TexturedPoints &points,
       std::vector<float> &values)
{
  CV_Assert(image.type() == CV_32FC1 && image.isContinuous());
  values.resize(points.x.size());
  HWY_DYNAMIC_DISPATCH(sample)
  (image, position, points.x.data(), points.y.data(), values.size(), values.data());
}

Equations
equations(const TexturedPoints &points, const std::vector<float> &residuals, double scale)
{
  std::array<const float *, TexturedPoints::kParameters> change;
  for (std::size_t m = 0; m < change.size(); ++m)
    change[m] = points.change[m].data();
  std::array<float, kSums * kBlock> sums{};
  HWY_DYNAMIC_DISPATCH(equations)
  (change.data(), residuals.data(), residuals.size(), static_cast<float>(scale), sums.data());
  Equations result{};
  const float *next = sums.data();
  const auto total = [&next] {
    double sum = 0;
    for (std::size_t i = 0; i < kBlock; ++i)
      sum += static_cast<double>(*next++);
    return sum;
  };
  for (std::size_t m = 0; m < change.size(); ++m) {
    for (std::size_t k = m; k < change.size(); ++k)
      result.normal[m][k] = total();
    result.right[m] = total();
  }
  return result;
}

void
add_sampled(const cv::Mat &image, const Similarity &position, float border, const cv::Mat &now,
            float length, cv::Mat &sum)
{
  CV_Assert(image.type() == CV_32FC1 && image.isContinuous());
  HWY_DYNAMIC_DISPATCH(add_sampled)(image, position, border, now, length, sum);
}

} // namespace saliency
#endif
