// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/lab.h"

#include <bit>
#include <cstdint>
#include <stdexcept>

// Everything up to HWY_ONCE is compiled for each target. No fused multiply-add, which not all have.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/lab.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;

// Light → XYZ for BT.709's primaries and D65 (IEC 61966-2-1), each row divided by its sum, which is
// white's own value: white then has X/Xn = Y/Yn = Z/Zn = 1 and greys have a* = b* = 0 to float's
// precision.
struct RelativeXyzRow
{
  float r;
  float g;
  float b;
};

constexpr RelativeXyzRow
relative_to_white(double r, double g, double b)
{
  const double white = r + g + b;
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

/// constant + x · slope: what Estrin's scheme makes polynomials of, whose parts need not wait for
/// each other as Horner's do.
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

/// sRGB signal, clipped to [0, 1] → light. The polynomial is the one of its degree whose error,
/// weighted by the slope of CIE's f, is smallest from 0.04045 to 1, 4.5e-5, and 0 at 1.
HWY_INLINE V
light(V signal)
{
  const V s = hn::Min(hn::Max(signal, set(0)), set(1));
  const V s2 = hn::Mul(s, s);
  const V low = linear(s2, linear(s, 0.0009249206403405541F, 0.03254056627463364F),
                       linear(s, 0.5209181854099569F, 0.6622923762303531F));
  const V high = linear(s, -0.3005769280026831F, 0.08390087944739885F);
  const V power = linear(hn::Mul(s2, s2), low, high);
  return hn::IfThenElse(hn::Le(s, set(0.04045F)), hn::Mul(s, set(static_cast<float>(1 / 12.92))),
                        power);
}

/// t^(-1/3) to within 3.6 %: exponent and mantissa, as one integer, are nearly a logarithm; a third of
/// each half of it is taken from a constant.
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
/// t^(1/3) = t r² (1 - c)^(-2/3) with c = 1 - t r³, |c| < 0.108; there the polynomial is off by 8e-6
/// of the value, and right at t = 1: white is 100.
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

HWY_INLINE V
lightness(V fy)
{
  return hn::Sub(hn::Mul(set(116), fy), set(16));
}

HWY_INLINE void
store_lab(V r, V g, V b, int x, const std::array<float *, 3> &lab)
{
  r = light(r);
  g = light(g);
  b = light(b);
  const V fx = cie_f(relative(kX, r, g, b));
  const V fy = cie_f(relative(kY, r, g, b));
  const V fz = cie_f(relative(kZ, r, g, b));
  hn::StoreU(lightness(fy), Tag(), lab[0] + x);
  hn::StoreU(hn::Mul(set(500), hn::Sub(fx, fy)), Tag(), lab[1] + x);
  hn::StoreU(hn::Mul(set(200), hn::Sub(fy, fz)), Tag(), lab[2] + x);
}

void
Convert(ColorModel model, const LabConverter::Coefficients &k,
        const std::array<const float *, 3> &components, int count,
        const std::array<float *, 3> &lab)
{
  const int step = static_cast<int>(hn::Lanes(Tag()));
  const auto load = [&](std::size_t c, int x, float zero, float scale) HWY_ATTR {
    return hn::Mul(hn::Sub(hn::LoadU(Tag(), components[c] + x), set(zero)), set(scale));
  };
  switch (model) {
  case ColorModel::grey:
    for (int x = 0; x < count; x += step) {
      const V y = load(0, x, k.luma_zero, k.luma_scale);
      hn::StoreU(lightness(cie_f(light(y))), Tag(), lab[0] + x);
      hn::StoreU(set(0), Tag(), lab[1] + x);
      hn::StoreU(set(0), Tag(), lab[2] + x);
    }
    break;
  case ColorModel::rgb:
    for (int x = 0; x < count; x += step)
      store_lab(load(0, x, 0, k.luma_scale), load(1, x, 0, k.luma_scale),
                load(2, x, 0, k.luma_scale), x, lab);
    break;
  case ColorModel::yuv:
    for (int x = 0; x < count; x += step) {
      const V y = load(0, x, k.luma_zero, k.luma_scale);
      const V cb = load(1, x, k.chroma_zero, k.chroma_scale);
      const V cr = load(2, x, k.chroma_zero, k.chroma_scale);
      store_lab(hn::Add(y, hn::Mul(set(k.r_cr), cr)),
                hn::Add(hn::Add(y, hn::Mul(set(k.g_cb), cb)), hn::Mul(set(k.g_cr), cr)),
                hn::Add(y, hn::Mul(set(k.b_cb), cb)), x, lab);
    }
    break;
  }
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(Convert);

namespace {

const SampleCoding &
checked(const SampleCoding &coding)
{
  if (coding.depth < 8 || coding.depth > 16)
    throw std::invalid_argument("a sample has 8 to 16 bits");
  const auto &matrix = coding.matrix;
  if (coding.model == ColorModel::yuv
      && !(matrix.kr > 0 && matrix.kb > 0 && matrix.kr + matrix.kb < 1))
    throw std::invalid_argument("luma coefficients are positive and their sum is 1");
  return coding;
}

LabConverter::Coefficients
coefficients(const SampleCoding &coding)
{
  const double unit = 1 << (coding.depth - 8);
  const double all = (1 << coding.depth) - 1;
  const bool all_codes = coding.full_range || coding.model == ColorModel::rgb;
  const double kr = coding.matrix.kr;
  const double kb = coding.matrix.kb;
  const double kg = 1 - kr - kb;
  return { .luma_zero = static_cast<float>(all_codes ? 0 : 16 * unit),
           .luma_scale = static_cast<float>(1 / (all_codes ? all : 219 * unit)),
           .chroma_zero = static_cast<float>(128 * unit),
           .chroma_scale = static_cast<float>(1 / (all_codes ? all : 224 * unit)),
           .r_cr = static_cast<float>(2 * (1 - kr)),
           .g_cb = static_cast<float>(-2 * (1 - kb) * kb / kg),
           .g_cr = static_cast<float>(-2 * (1 - kr) * kr / kg),
           .b_cb = static_cast<float>(2 * (1 - kb)) };
}

} // namespace

LabConverter::LabConverter(const SampleCoding &coding)
    : model_(checked(coding).model), coefficients_(coefficients(coding))
{
}

void
LabConverter::convert(const std::array<const float *, 3> &components, int count,
                      const std::array<float *, 3> &lab) const
{
  HWY_DYNAMIC_DISPATCH(Convert)(model_, coefficients_, components, count, lab);
}

} // namespace saliency
#endif
