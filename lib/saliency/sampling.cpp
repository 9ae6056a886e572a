// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/sampling.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/sampling.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

#ifndef SALIENCY_SAMPLING_ONCE
#define SALIENCY_SAMPLING_ONCE
namespace saliency {
/// Points come in blocks of this size, and each sum in as many partial sums. The order of additions
/// is then the same for every vector length that divides it.
constexpr std::size_t kBlock = 16;
constexpr std::size_t kSums = 27; ///< upper triangle and right-hand side
constexpr std::size_t kShiftSums = 5;
} // namespace saliency
#endif

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Bilinear interpolation between the samples that corner(offset) loads, by their offset from the
/// upper left one.
template <class V, class Corner>
HWY_INLINE V
blended(int cols, V right_share, V bottom_share, const Corner &corner)
{
  const V upper_left = corner(0);
  const V lower_left = corner(cols);
  const V upper_step = hn::Sub(corner(1), upper_left);
  const V lower_step = hn::Sub(corner(cols + 1), lower_left);
  const V above = hn::Add(upper_left, hn::Mul(right_share, upper_step));
  const V below = hn::Add(lower_left, hn::Mul(right_share, lower_step));
  return hn::Add(above, hn::Mul(bottom_share, hn::Sub(below, above)));
}

/// Interpolates each image at the same places, all of which have `cols` columns, and calls
/// use(i, values) for image i. Values are undefined where `inside` is false.
template <class D, std::size_t n, class V = hn::Vec<D>, class Use>
HWY_INLINE void
interpolate(D d, const std::array<const float *, n> &images, int cols, V x, V y, hn::Mask<D> inside,
            const Use &use)
{
  const hn::RebindToSigned<D> di;
  x = hn::IfThenElseZero(inside, x);
  y = hn::IfThenElseZero(inside, y);
  const auto left = hn::ConvertTo(di, x); // truncates
  const auto top = hn::ConvertTo(di, y);
  const V right_share = hn::Sub(x, hn::ConvertTo(d, left));
  const V bottom_share = hn::Sub(y, hn::ConvertTo(d, top));
  const auto index = hn::Add(hn::Mul(top, hn::Set(di, cols)), left);
  // A gather costs several times as much as a load. Along a row, the samples are mostly adjacent.
  const auto first = hn::GetLane(index);
  if (hn::AllTrue(di, hn::Eq(index, hn::Iota(di, first))))
    for (std::size_t i = 0; i < n; ++i)
      use(i, blended(cols, right_share, bottom_share, [&](int offset) HWY_ATTR {
            return hn::LoadU(d, images[i] + first + offset);
          }));
  else
    for (std::size_t i = 0; i < n; ++i)
      use(i, blended(cols, right_share, bottom_share, [&](int offset) HWY_ATTR {
            return hn::GatherIndex(d, images[i] + offset, index);
          }));
}

/// The same of one image.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V
interpolated(D d, const cv::Mat &image, V x, V y, hn::Mask<D> inside)
{
  V value = hn::Undefined(d);
  interpolate(d, std::array{ image.ptr<float>() }, image.cols, x, y, inside,
              [&value](std::size_t, V found) HWY_ATTR { value = found; });
  return value;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D>
between(D d, V x, V y, float low, float right, float bottom)
{
  const V least = hn::Set(d, low);
  return hn::And(hn::And(hn::Ge(x, least), hn::Ge(y, least)),
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

/// 1/(1 + r²/divisor)²
template <class D, class V = hn::Vec<D>>
HWY_INLINE V
closeness_squared(D d, V residual, V divisor)
{
  const V one = hn::Set(d, 1.0F);
  const V closeness = hn::Div(one, hn::Add(one, hn::Div(hn::Mul(residual, residual), divisor)));
  return hn::Mul(closeness, closeness);
}

/// sums[k × kBlock + i] += term k of the points i, i + kBlock, …
void
equations(const float *const *change, const float *residuals, std::size_t n, float scale,
          float *sums)
{
  const hn::CappedTag<float, kBlock> d;
  using V = hn::Vec<decltype(d)>;
  const V divisor = hn::Set(d, scale * scale);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    V residual = hn::LoadU(d, residuals + i);
    const auto seen = hn::Eq(residual, residual);
    residual = hn::IfThenElseZero(seen, residual);
    const V weight = hn::IfThenElseZero(seen, closeness_squared(d, residual, divisor));
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

/// Each sum is kBlock partial sums, as in equations(). Returns the number of points inside.
std::size_t
shift_equations(const cv::Mat &image, const Similarity &position, const TexturedPoints &points,
                float scale, std::array<std::array<float, kBlock>, kShiftSums> &sums)
{
  const hn::CappedTag<float, kBlock> d;
  using V = hn::Vec<decltype(d)>;
  const V a = hn::Set(d, static_cast<float>(position.a));
  const V b = hn::Set(d, static_cast<float>(position.b));
  const V tx = hn::Set(d, static_cast<float>(position.tx));
  const V ty = hn::Set(d, static_cast<float>(position.ty));
  const V divisor = hn::Set(d, scale * scale);
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.x.size(); i += hn::Lanes(d)) {
    const V px = hn::LoadU(d, points.x.data() + i);
    const V py = hn::LoadU(d, points.y.data() + i);
    const V at_x = hn::Add(hn::Sub(hn::Mul(a, px), hn::Mul(b, py)), tx);
    const V at_y = hn::Add(hn::Add(hn::Mul(b, px), hn::Mul(a, py)), ty);
    const auto inside = between(d, at_x, at_y, 0, static_cast<float>(image.cols - 1),
                                static_cast<float>(image.rows - 1));
    const auto seen = hn::And(inside, hn::Ge(px, hn::Zero(d)));
    count += hn::CountTrue(d, seen);
    const V residual = hn::Sub(interpolated(d, image, at_x, at_y, seen),
                               hn::LoadU(d, points.lightness.data() + i));
    const V weight = hn::IfThenElseZero(seen, closeness_squared(d, residual, divisor));
    const V dx = hn::LoadU(d, points.change[TexturedPoints::kShiftX].data() + i);
    const V dy = hn::LoadU(d, points.change[TexturedPoints::kShiftY].data() + i);
    const V weighted_x = hn::Mul(weight, dx);
    const V weighted_y = hn::Mul(weight, dy);
    const auto add = [&](std::size_t k, V term) HWY_ATTR {
      float *sum = sums[k].data() + i % kBlock;
      hn::StoreU(hn::Add(hn::LoadU(d, sum), term), d, sum);
    };
    add(0, hn::Mul(weighted_x, dx));
    add(1, hn::Mul(weighted_x, dy));
    add(2, hn::Mul(weighted_y, dy));
    add(3, hn::Mul(weighted_x, residual));
    add(4, hn::Mul(weighted_y, residual));
  }
  return count;
}

void
warp(const cv::Mat &image, const Similarity &position, cv::Mat &warped)
{
  const auto right = static_cast<float>(image.cols - 1);
  const auto bottom = static_cast<float>(image.rows - 1);
  const auto step_x = static_cast<float>(position.a);
  const auto step_y = static_cast<float>(position.b);
  const auto width = static_cast<std::size_t>(image.cols);
  for (int y = 0; y < image.rows; ++y) {
    const auto begin_x = static_cast<float>(position.x(0, y));
    const auto begin_y = static_cast<float>(position.y(0, y));
    auto *row = warped.ptr<float>(y);
    const auto make = [&](auto d, std::size_t i) HWY_ATTR {
      const auto x = hn::Iota(d, static_cast<float>(i));
      const auto at_x = hn::Add(hn::Set(d, begin_x), hn::Mul(hn::Set(d, step_x), x));
      const auto at_y = hn::Add(hn::Set(d, begin_y), hn::Mul(hn::Set(d, step_y), x));
      const auto inside = between(d, at_x, at_y, 0, right, bottom);
      const auto nothing = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
      const auto value = interpolated(d, image, at_x, at_y, inside);
      hn::StoreU(hn::IfThenElse(inside, value, nothing), d, row + i);
    };
    const hn::CappedTag<float, kBlock> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= width; i += hn::Lanes(d))
      make(d, i);
    for (; i < width; ++i)
      make(hn::CappedTag<float, 1>(), i);
  }
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(sample);
HWY_EXPORT(equations);
HWY_EXPORT(shift_equations);
HWY_EXPORT(warp);

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

ShiftEquations
shift_equations(const cv::Mat &image, const Similarity &position, const TexturedPoints &points,
                float scale)
{
  CV_Assert(image.type() == CV_32FC1 && image.isContinuous());
  std::array<std::array<float, kBlock>, kShiftSums> sums{};
  const std::size_t count
      = HWY_DYNAMIC_DISPATCH(shift_equations)(image, position, points, scale, sums);
  std::array<double, kShiftSums> totals{};
  for (std::size_t i = 0; i < kBlock; ++i)
    for (std::size_t k = 0; k < kShiftSums; ++k)
      totals[k] += static_cast<double>(sums[k][i]);
  return { totals[0], totals[1], totals[2], totals[3], totals[4], count };
}

void
warp(const cv::Mat &image, const Similarity &position, cv::Mat &warped)
{
  CV_Assert(image.type() == CV_32FC1 && image.isContinuous() && image.data != warped.data);
  warped.create(image.size(), CV_32FC1);
  HWY_DYNAMIC_DISPATCH(warp)(image, position, warped);
}

} // namespace saliency
#endif
