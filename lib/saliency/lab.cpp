// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/lab.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace saliency {

namespace {

// f(t) bends most just above CIE's threshold; with this many intervals a chord is off by 4.4e-6
// there, 0.0025 in ΔE.
constexpr int kLightIntervals = 1024;
constexpr int kLightnessIntervals = 4096;

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

double
srgb_to_light(double signal)
{
  return signal <= 0.04045 ? signal / 12.92 : std::pow((signal + 0.055) / 1.055, 2.4);
}

// CIE 15: t^(1/3), continued by its tangent below (6/29)³.
double
cie_f(double t)
{
  constexpr double delta = 6.0 / 29.0;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
}

template <typename Curve>
std::vector<float>
tabulate(Curve curve, int intervals)
{
  // One entry more than there are nodes: 1 itself may then be read as the start of an interval.
  std::vector<float> table(static_cast<std::size_t>(intervals) + 2);
  for (int i = 0; i <= intervals; ++i)
    table[static_cast<std::size_t>(i)]
        = static_cast<float>(curve(static_cast<double>(i) / intervals));
  table.back() = table[static_cast<std::size_t>(intervals)];
  return table;
}

inline float
interpolate(const float *table, int intervals, float x)
{
  const float position = std::min(std::max(x, 0.0F), 1.0F) * static_cast<float>(intervals);
  const int node = static_cast<int>(position);
  return table[node] + (position - static_cast<float>(node)) * (table[node + 1] - table[node]);
}

/// Code values → signal: (code - zero) · scale, 0…1 for R', G', B', Y' and -½…½ for Cb, Cr.
struct Quantization
{
  float zero;
  float scale;
};

Quantization
luma_quantization(const SampleCoding &coding)
{
  if (coding.full_range || coding.model == ColorModel::rgb)
    return { 0, static_cast<float>(1.0 / ((1 << coding.depth) - 1)) };
  const double unit = 1 << (coding.depth - 8);
  return { static_cast<float>(16 * unit), static_cast<float>(1 / (219 * unit)) };
}

Quantization
chroma_quantization(const SampleCoding &coding)
{
  const double unit = 1 << (coding.depth - 8);
  const double scale = coding.full_range ? 1.0 / ((1 << coding.depth) - 1) : 1 / (224 * unit);
  return { static_cast<float>(128 * unit), static_cast<float>(scale) };
}

void
check(const SampleCoding &coding, std::span<const cv::Mat> components)
{
  if (coding.depth < 8 || coding.depth > 16)
    throw std::invalid_argument("a sample has 8 to 16 bits");
  const auto &matrix = coding.matrix;
  if (coding.model == ColorModel::yuv
      && !(matrix.kr > 0 && matrix.kb > 0 && matrix.kr + matrix.kb < 1))
    throw std::invalid_argument("luma coefficients are positive and their sum is 1");
  if (components.size() != (coding.model == ColorModel::grey ? 1U : 3U))
    throw std::invalid_argument("one component for grey, three for colour");
}

} // namespace

LabConverter::LabConverter()
    : light_(tabulate(srgb_to_light, kLightIntervals)),
      lightness_(tabulate(cie_f, kLightnessIntervals))
{
}

float
LabConverter::light(float signal) const
{
  return interpolate(light_.data(), kLightIntervals, signal);
}

float
LabConverter::lightness(float light) const
{
  return interpolate(lightness_.data(), kLightnessIntervals, light);
}

void
LabConverter::convert(const SampleCoding &coding, std::span<const cv::Mat> components,
                      cv::Mat &lab) const
{
  check(coding, components);
  lab.create(components[0].size(), CV_32FC3);

  const auto to_lab = [this](float r, float g, float b) {
    const float fx = lightness(kX.r * r + kX.g * g + kX.b * b);
    const float fy = lightness(kY.r * r + kY.g * g + kY.b * b);
    const float fz = lightness(kZ.r * r + kZ.g * g + kZ.b * b);
    return cv::Vec3f(116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz));
  };

  const auto luma = luma_quantization(coding);
  const auto chroma = chroma_quantization(coding);
  const double kr = coding.matrix.kr;
  const double kb = coding.matrix.kb;
  const double kg = 1 - kr - kb;
  const auto r_cr = static_cast<float>(2 * (1 - kr));
  const auto b_cb = static_cast<float>(2 * (1 - kb));
  const auto g_cr = static_cast<float>(-2 * (1 - kr) * kr / kg);
  const auto g_cb = static_cast<float>(-2 * (1 - kb) * kb / kg);

  for (int y = 0; y < lab.rows; ++y) {
    auto *out = lab.ptr<cv::Vec3f>(y);
    const auto *first = components[0].ptr<float>(y);
    const auto *second = components.size() > 1 ? components[1].ptr<float>(y) : nullptr;
    const auto *third = components.size() > 2 ? components[2].ptr<float>(y) : nullptr;
    switch (coding.model) {
    case ColorModel::grey:
      for (int x = 0; x < lab.cols; ++x)
        out[x] = cv::Vec3f(116 * lightness(light((first[x] - luma.zero) * luma.scale)) - 16, 0, 0);
      break;
    case ColorModel::rgb:
      for (int x = 0; x < lab.cols; ++x)
        out[x] = to_lab(light(first[x] * luma.scale), light(second[x] * luma.scale),
                        light(third[x] * luma.scale));
      break;
    case ColorModel::yuv:
      for (int x = 0; x < lab.cols; ++x) {
        const float luminance = (first[x] - luma.zero) * luma.scale;
        const float cb = (second[x] - chroma.zero) * chroma.scale;
        const float cr = (third[x] - chroma.zero) * chroma.scale;
        out[x] = to_lab(light(luminance + r_cr * cr), light(luminance + g_cb * cb + g_cr * cr),
                        light(luminance + b_cb * cb));
      }
      break;
    }
  }
}

} // namespace saliency
