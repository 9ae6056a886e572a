// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/lab.h"

#include "frame/lab_image.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

// Everything up to HWY_ONCE is compiled once per target, without FMA: results are bit-identical.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/lab.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;

// Linear R, G, B → XYZ for BT.709's primaries and D65 (IEC 61966-2-1). Each row is divided by its
// sum, which is white's value: white has X/Xn = Y/Yn = Z/Zn = 1, and grays have a* = b* = 0 to
// float precision.
struct RelativeXyzRow
{
  float r;
  float g;
  float b;
};

/// Unit of linear light: white is 32767².
constexpr float kLightUnit = static_cast<float>(1.0 / (32767.0 * 32767.0));

constexpr RelativeXyzRow
relative_to_white(double r, double g, double b)
{
  const double white = (r + g + b) * 32767.0 * 32767.0;
  return { static_cast<float>(r / white), static_cast<float>(g / white),
           static_cast<float>(b / white) };
}

constexpr RelativeXyzRow kX = relative_to_white(0.4124564, 0.3575761, 0.1804375);
constexpr RelativeXyzRow kY = relative_to_white(0.2126729, 0.7151522, 0.0721750);
constexpr RelativeXyzRow kZ = relative_to_white(0.0193339, 0.1191920, 0.9503041);

HWY_INLINE V
set(float value)
{
  return hn::Set(Tag(), value);
}

/// constant + x · slope, the step of Estrin's scheme. Unlike Horner's, its steps are independent.
HWY_INLINE V
linear(V x, V constant, V slope)
{
  return hn::Add(constant, hn::Mul(x, slope));
}

HWY_INLINE V
linear(V x, float constant, float slope)
{
  return linear(x, set(constant), set(slope));
}

using Signal = hn::CappedTag<std::int16_t, 32>;
using Signals = hn::Vec<Signal>;

/// Pixels per block, from signals to linear light to L*a*b*.
constexpr int kPixels = 512;
using Row = std::array<std::int16_t, kPixels + 32>;
using FloatRow = std::array<float, kPixels + 32>;

HWY_INLINE Signals
signal(int value)
{
  return hn::Set(Signal(), static_cast<std::int16_t>(value));
}

/// The sRGB curve in units of 1/32767: a signal s is s/12.92 of linear light up to 0.04045 and u²
/// beyond. u = ((s + 0.055)/1.055)^1.2 is smooth enough for 16 bits. Results of at least kLeastRoot
/// are u, others s.
constexpr int kOne = 32767;
constexpr int kLinearSignal = 1325; // 0.04045
constexpr int kLeastRoot = 1580;    // between kLinearSignal and the smallest u, 1827

/// factor · s + constant, the step of Horner's scheme.
HWY_INLINE Signals
times_plus(Signals factor, Signals s, int constant)
{
  return hn::SaturatedAdd(hn::MulFixedPoint15(factor, s), signal(constant));
}

/// Signal in [0, 1] → u, or the signal itself up to kLinearSignal. The polynomial is 1 at 1 and has
/// the least error of its degree, weighted by the slope of lightness: 0.01 of L*.
HWY_INLINE Signals
root_of_light(Signals s)
{
  Signals u = times_plus(signal(-4979), s, 16420);
  u = times_plus(u, s, -22784);
  u = times_plus(u, s, 21501);
  u = times_plus(u, s, 21691);
  u = times_plus(u, s, 919);
  return hn::IfThenElse(hn::Gt(s, signal(kLinearSignal)), u, s);
}

/// The result of root_of_light() → linear light in units of 1/32767².
HWY_INLINE V
light(const std::int16_t *root)
{
  const hn::Rebind<std::int16_t, Tag> narrow;
  const hn::RebindToSigned<Tag> integers;
  const V u = hn::ConvertTo(Tag(), hn::PromoteTo(integers, hn::LoadU(narrow, root)));
  const V linear = set(static_cast<float>(kOne / 12.92));
  return hn::Mul(u, hn::IfThenElse(hn::Lt(u, set(kLeastRoot)), linear, u));
}

/// t^(-1/3) to within 3.6 %. Exponent and mantissa, read as one integer, approximate a logarithm; a
/// third of it is subtracted from a constant, for each 16-bit half.
HWY_INLINE V
estimated_inverse_cube_root(V t)
{
  constexpr std::uint32_t kFrom = 0x54a14000;
  constexpr std::uint16_t kThird = 0x5555;
#if HWY_TARGET == HWY_SCALAR
  const auto bits = std::bit_cast<std::uint32_t>(hn::GetLane(t));
  const std::uint32_t low = ((bits & 0xffffU) * kThird) >> 16U;
  return set(std::bit_cast<float>(kFrom - (((bits >> 16U) * kThird & 0xffff0000U) | low)));
#else
  const hn::RebindToUnsigned<Tag> d32;
  const hn::Repartition<std::uint16_t, Tag> d16;
  const auto third = hn::MulHigh(hn::BitCast(d16, t), hn::Set(d16, kThird));
  return hn::BitCast(Tag(), hn::Sub(hn::Set(d32, kFrom), hn::BitCast(d32, third)));
#endif
}

/// CIE 15: f(t) = t^(1/3), continued by its tangent below (6/29)³; 0 ≤ t ≤ 1. From r ≈ t^(-1/3),
/// t^(1/3) = t r² (1 - c)^(-2/3) with c = 1 - t r³, |c| < 0.108. The polynomial in c has a relative
/// error of 8e-6 and is exact at t = 1, so white is 100.
HWY_INLINE V
cie_f(V t)
{
  const V r = estimated_inverse_cube_root(t);
  const V estimate = hn::Mul(t, hn::Mul(r, r));
  const V c = hn::Sub(set(1), hn::Mul(estimate, r));
  const V correction = linear(hn::Mul(c, c), linear(c, 0.9999923352638335F, 0.666649583177835F),
                              linear(c, 0.5608159067137419F, 0.49977817612724107F));
  const V cube_root = hn::Mul(estimate, correction);
  constexpr double delta = 6.0 / 29.0;
  const V tangent
      = linear(t, static_cast<float>(4.0 / 29.0), static_cast<float>(1 / (3 * delta * delta)));
  return hn::IfThenElse(hn::Le(t, set(static_cast<float>(delta * delta * delta))), tangent,
                        cube_root);
}

HWY_INLINE V
relative(const RelativeXyzRow &row, V r, V g, V b)
{
  return hn::Add(hn::Add(hn::Mul(set(row.r), r), hn::Mul(set(row.g), g)), hn::Mul(set(row.b), b));
}

/// Stores L*, a* or b* in units of FixedLabImage. Adding 2²³ leaves the integer in a float's lower
/// bits.
HWY_INLINE void
store(V value, Fixed *out)
{
  const hn::Rebind<Fixed, Tag> narrow;
  const hn::RebindToUnsigned<Tag> integers;
  constexpr float kTop = 8388608;
  const V moved = hn::Add(value, set(kTop + FixedLabImage::kOffset * FixedLabImage::kUnits));
  hn::StoreU(hn::TruncateTo(narrow, hn::BitCast(integers, moved)), narrow, out);
}

constexpr float
units(float value)
{
  return value * FixedLabImage::kUnits;
}

HWY_INLINE V
lightness(V fy)
{
  return hn::Sub(hn::Mul(set(units(116)), fy), set(units(16)));
}

/// Doubles a signal of 14 fractional bits and clips it to [0, 1].
HWY_INLINE Signals
clipped(Signals half)
{
  return hn::Max(hn::SaturatedAdd(half, half), hn::Zero(Signal()));
}

HWY_INLINE Signals
samples(const Fixed *row)
{
  return hn::LoadU(Signal(), reinterpret_cast<const std::int16_t *>(row));
}

/// root_of_light() of R', G', B' or, in the first row, of gray.
void
find_roots(ColorModel model, const LabConverter::Coefficients &k,
           const std::array<const Fixed *, 3> &components, int count, std::array<Row, 3> &roots)
{
  const int step = static_cast<int>(hn::Lanes(Signal()));
  const auto store_root = [&roots](Signals s, std::size_t c, int x) HWY_ATTR {
    hn::StoreU(root_of_light(s), Signal(), &roots[c][static_cast<std::size_t>(x)]);
  };
  for (int x = 0; x < count; x += step) {
    const Signals first = samples(components[0] + x);
    if (model == ColorModel::rgb) {
      const auto rgb = [&k](Signals v) HWY_ATTR {
        return hn::SaturatedAdd(v, hn::MulFixedPoint15(v, signal(k.luma_scale)));
      };
      store_root(rgb(first), 0, x);
      store_root(rgb(samples(components[1] + x)), 1, x);
      store_root(rgb(samples(components[2] + x)), 2, x);
      continue;
    }
    const Signals y
        = hn::MulFixedPoint15(hn::Sub(first, signal(k.luma_zero)), signal(k.luma_scale));
    if (model == ColorModel::gray) {
      store_root(clipped(y), 0, x);
      continue;
    }
    const auto chroma = [x](const Fixed *row) HWY_ATTR {
      const Signals v = hn::Sub(samples(row + x), signal(LabConverter::kNoChroma));
      return hn::Add(v, v);
    };
    const auto add = [](Signals sum, Signals v, std::int16_t weight) HWY_ATTR {
      return hn::SaturatedAdd(sum, hn::MulFixedPoint15(v, signal(weight)));
    };
    const Signals cb = chroma(components[1]);
    const Signals cr = chroma(components[2]);
    store_root(clipped(add(y, cr, k.r_cr)), 0, x);
    store_root(clipped(add(add(y, cb, k.g_cb), cr, k.g_cr)), 1, x);
    store_root(clipped(add(y, cb, k.b_cb)), 2, x);
  }
}

/// f of X, Y, Z relative to white, from roots. Each pass has few dependent steps, so that the CPU
/// can overlap many pixels.
void
find_f(const std::array<Row, 3> &roots, int count, std::array<FloatRow, 3> &f)
{
  const int step = static_cast<int>(hn::Lanes(Tag()));
  for (int x = 0; x < count; x += step) {
    const auto i = static_cast<std::size_t>(x);
    const V r = light(&roots[0][i]);
    const V g = light(&roots[1][i]);
    const V b = light(&roots[2][i]);
    hn::StoreU(relative(kX, r, g, b), Tag(), &f[0][i]);
    hn::StoreU(relative(kY, r, g, b), Tag(), &f[1][i]);
    hn::StoreU(relative(kZ, r, g, b), Tag(), &f[2][i]);
  }
  for (FloatRow &row : f)
    for (int x = 0; x < count; x += step) {
      float *t = &row[static_cast<std::size_t>(x)];
      hn::StoreU(cie_f(hn::LoadU(Tag(), t)), Tag(), t);
    }
}

void
store_lab(const std::array<FloatRow, 3> &f, int count, const std::array<Fixed *, 3> &lab)
{
  const int step = static_cast<int>(hn::Lanes(Tag()));
  for (int x = 0; x < count; x += step) {
    const auto i = static_cast<std::size_t>(x);
    const V fx = hn::LoadU(Tag(), &f[0][i]);
    const V fy = hn::LoadU(Tag(), &f[1][i]);
    const V fz = hn::LoadU(Tag(), &f[2][i]);
    store(lightness(fy), lab[0] + x);
    store(hn::Mul(set(units(500)), hn::Sub(fx, fy)), lab[1] + x);
    store(hn::Mul(set(units(200)), hn::Sub(fy, fz)), lab[2] + x);
  }
}

void
store_gray(const Row &roots, int count, const std::array<Fixed *, 3> &lab)
{
  const int step = static_cast<int>(hn::Lanes(Tag()));
  for (int x = 0; x < count; x += step) {
    const V y = hn::Mul(light(&roots[static_cast<std::size_t>(x)]), set(kLightUnit));
    store(lightness(cie_f(y)), lab[0] + x);
    store(set(0), lab[1] + x);
    store(set(0), lab[2] + x);
  }
}

void
Convert(ColorModel model, const LabConverter::Coefficients &k,
        const std::array<const Fixed *, 3> &components, int count,
        const std::array<Fixed *, 3> &lab)
{
  std::array<Row, 3> roots;
  std::array<FloatRow, 3> f;
  for (int x = 0; x < count; x += kPixels) {
    const auto at = [x](auto *row) {
      return row == nullptr ? row : row + x;
    };
    const int pixels = std::min(kPixels, count - x);
    const std::array<Fixed *, 3> out{ at(lab[0]), at(lab[1]), at(lab[2]) };
    find_roots(model, k, { at(components[0]), at(components[1]), at(components[2]) }, pixels,
               roots);
    if (model == ColorModel::gray) {
      store_gray(roots[0], pixels, out);
    } else {
      find_f(roots, pixels, f);
      store_lab(f, pixels, out);
    }
  }
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(Convert);

namespace {

LabConverter::Coefficients
coefficients(const SampleCoding &coding)
{
  constexpr double kOne = 32767;
  const auto fraction = [](double value) {
    return static_cast<std::int16_t>(std::lround(value * 32768));
  };
  const double all = std::ldexp((1 << coding.depth) - 1, 15 - coding.depth);
  if (coding.model == ColorModel::rgb)
    return { .luma_scale = fraction(kOne / all - 1) };

  constexpr double kHalf = 16384; // a signal of 1 before clipping
  constexpr double code = 128;    // one 8-bit code
  const double kr = coding.matrix.kr;
  const double kb = coding.matrix.kb;
  const double kg = 1 - kr - kb;
  const double chroma = kHalf / (coding.full_range ? all : 224 * code) / 2;
  return { .luma_zero = static_cast<std::int16_t>(coding.full_range ? 0 : 16 * code),
           .luma_scale = fraction(kHalf / (coding.full_range ? all : 219 * code)),
           .r_cr = fraction(chroma * 2 * (1 - kr)),
           .g_cb = fraction(chroma * -2 * (1 - kb) * kb / kg),
           .g_cr = fraction(chroma * -2 * (1 - kr) * kr / kg),
           .b_cb = fraction(chroma * 2 * (1 - kb)) };
}

} // namespace

std::string_view
fault_of(const SampleCoding &coding)
{
  if (coding.depth < 8 || coding.depth > 16)
    return "a sample has 8 to 16 bits";
  const auto &matrix = coding.matrix;
  if (coding.model == ColorModel::yuv
      && !(matrix.kr > 0 && matrix.kb > 0 && matrix.kr + matrix.kb < 1))
    return "luma coefficients are positive and their sum is 1";
  return {};
}

LabConverter::LabConverter(const SampleCoding &coding)
    : model_(coding.model), coefficients_(coefficients(coding))
{
  assert(fault_of(coding).empty());
}

void
LabConverter::convert(const std::array<const Fixed *, 3> &components, int count,
                      const std::array<Fixed *, 3> &lab) const
{
  HWY_DYNAMIC_DISPATCH(Convert)(model_, coefficients_, components, count, lab);
}

} // namespace saliency
#endif
