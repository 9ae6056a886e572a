// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/lab.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <hwy/targets.h>

#include <cmath>
#include <cstring>
#include <random>

#include "support/check_tests.h"

using saliency::ColorModel;
using saliency::LabConverter;
using saliency::SampleCoding;

namespace {

constexpr double kBound = 0.06;   // ΔE, the documented bound
constexpr std::size_t kRoom = 32; // samples beyond a row that may be accessed

/// Converts pixels given by their code values. Rows have their exact size, so a sanitizer sees
/// overruns.
saliency::FixedLabImage
convert(const SampleCoding &coding, const std::vector<std::array<double, 3>> &codes)
{
  const std::size_t count = codes.size();
  std::array<std::vector<saliency::Fixed>, 3> components;
  std::array<std::vector<saliency::Fixed>, 3> lab;
  for (std::size_t c = 0; c < 3; ++c) {
    components[c].resize(count + kRoom);
    lab[c].resize(count + kRoom);
    for (std::size_t x = 0; x < count; ++x)
      components[c][x] = static_cast<saliency::Fixed>(std::ldexp(codes[x][c], 15 - coding.depth));
  }
  const bool gray = coding.model == ColorModel::gray;
  LabConverter(coding).convert({ components[0].data(), gray ? nullptr : components[1].data(),
                                 gray ? nullptr : components[2].data() },
                               static_cast<int>(count),
                               { lab[0].data(), lab[1].data(), lab[2].data() });
  saliency::FixedLabImage image;
  for (std::size_t c = 0; c < 3; ++c) {
    image.planes[c].create(1, static_cast<int>(count), CV_16UC1);
    std::copy_n(lab[c].data(), count, image.planes[c].ptr<saliency::Fixed>());
  }
  return image;
}

/// The largest ΔE from the oracle.
double
error(const SampleCoding &coding, const std::vector<std::array<double, 3>> &codes)
{
  const int width = static_cast<int>(codes.size());
  oracle::LabImage expected{ oracle::Image(width, 1), oracle::Image(width, 1),
                             oracle::Image(width, 1) };
  for (int x = 0; x < width; ++x) {
    const auto lab = oracle::samples_to_lab(codes[static_cast<std::size_t>(x)], coding.model,
                                            coding.depth, coding.full_range, coding.matrix);
    for (std::size_t c = 0; c < 3; ++c)
      expected[c](x, 0) = lab[c];
  }
  return oracle::difference(convert(coding, codes), expected);
}

std::vector<std::array<double, 3>>
random_codes(int depth, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_int_distribution<int> code(0, (1 << depth) - 1);
  std::vector<std::array<double, 3>> codes(20000);
  for (auto &pixel : codes)
    for (double &v : pixel)
      v = code(generator);
  return codes;
}

cv::Vec3f
lab_of(const SampleCoding &coding, std::array<double, 3> code)
{
  const auto lab = saliency::to_float(convert(coding, { code })).planes;
  return { lab[0].at<float>(0), lab[1].at<float>(0), lab[2].at<float>(0) };
}

void
expect_near(cv::Vec3f lab, std::array<double, 3> expected, double tolerance)
{
  for (int c = 0; c < 3; ++c)
    fail_unless_near(lab[c], expected[static_cast<std::size_t>(c)], tolerance);
}

bool
refuses(const SampleCoding &coding)
{
  return !fault_of(coding).empty();
}

} // namespace

CHECK_TEST(test_published_anchors)
{
  // Bruce Lindbloom's calculator, sRGB with D65 and no adaptation, to two decimals.
  const SampleCoding rgb{ .model = ColorModel::rgb };
  expect_near(lab_of(rgb, { 255, 255, 255 }), { 100, 0, 0 }, 0.001);
  expect_near(lab_of(rgb, { 0, 0, 0 }), { 0, 0, 0 }, 0.001);
  expect_near(lab_of(rgb, { 255, 0, 0 }), { 53.24, 80.09, 67.20 }, 0.015);
  expect_near(lab_of(rgb, { 0, 255, 0 }), { 87.73, -86.18, 83.18 }, 0.015);
  expect_near(lab_of(rgb, { 0, 0, 255 }), { 32.30, 79.19, -107.86 }, 0.015);

  // The same white and red as video codes: 235/128/128 and BT.601's 81/90/240 (ITU-R BT.801).
  const SampleCoding video{ .matrix = saliency::kBt601 };
  expect_near(lab_of(video, { 235, 128, 128 }), { 100, 0, 0 }, 0.001);
  expect_near(lab_of(video, { 16, 128, 128 }), { 0, 0, 0 }, 0.001);
  expect_near(lab_of(video, { 81, 90, 240 }), { 53.24, 80.09, 67.20 }, 1); // codes are integers
}

CHECK_TEST(test_grays)
{
  for (const bool full_range : { false, true })
    for (const ColorModel model : { ColorModel::gray, ColorModel::yuv, ColorModel::rgb }) {
      std::vector<std::array<double, 3>> codes;
      for (int code = 0; code < 256; ++code)
        codes.push_back(model == ColorModel::yuv
                            ? std::array<double, 3>{ 1.0 * code, 128, 128 }
                            : std::array<double, 3>{ 1.0 * code, 1.0 * code, 1.0 * code });
      const SampleCoding coding{ .model = model, .full_range = full_range };
      fail_unless_at_most(error(coding, codes), kBound);
      for (int code = 0; code < 256; ++code) {
        const double gray = code;
        const auto lab = lab_of(coding, { gray, model == ColorModel::yuv ? 128 : gray,
                                          model == ColorModel::yuv ? 128 : gray });
        fail_unless(std::abs(lab[1]) < 0.001F && std::abs(lab[2]) < 0.001F, "gray %d is colored",
                    code);
      }
    }
}

CHECK_TEST(test_rgb)
{
  for (const int depth : { 8, 10, 12, 16 })
    fail_unless_at_most(error({ .model = ColorModel::rgb, .depth = depth }, random_codes(depth, 1)),
                        kBound);
}

CHECK_TEST(test_rgb_ignores_range)
{
  const auto codes = random_codes(8, 2);
  fail_unless_at_most(error({ .model = ColorModel::rgb, .full_range = true }, codes), kBound);
  fail_unless_at_most(error({ .model = ColorModel::rgb, .full_range = false }, codes), kBound);
}

CHECK_TEST(test_gamut)
{
  // All colors on a grid of 5 codes, and every code of grays and primaries, for the two curves.
  std::vector<std::array<double, 3>> codes;
  for (int r = 0; r <= 255; r += 5)
    for (int g = 0; g <= 255; g += 5)
      for (int b = 0; b <= 255; b += 5)
        codes.push_back({ 1.0 * r, 1.0 * g, 1.0 * b });
  for (int i = 0; i < 65536; ++i) {
    const double v = i / 257.0;
    codes.insert(codes.end(), { { v, v, v }, { v, 0, 0 }, { 0, v, 0 }, { 0, 0, v } });
  }
  fail_unless_at_most(error({ .model = ColorModel::rgb }, codes), kBound);
}

CHECK_TEST(test_targets)
{
  // Results are bit-identical with all instruction sets of this CPU.
  const auto codes = random_codes(8, 9);
  const auto targets = hwy::SupportedTargets();
  for (const auto model : { ColorModel::gray, ColorModel::yuv, ColorModel::rgb }) {
    const auto expected = convert({ .model = model }, codes);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::GetChosenTarget().Update(target);
      const auto lab = convert({ .model = model }, codes);
      hwy::GetChosenTarget().Update(targets);
      for (std::size_t c = 0; c < 3; ++c)
        fail_unless(std::memcmp(lab.planes[c].data, expected.planes[c].data,
                                codes.size() * sizeof(saliency::Fixed))
                        == 0,
                    "%s differs", hwy::TargetName(target));
    }
  }
}

CHECK_TEST(test_dark_rgb)
{
  // Where the curves bend most: all colors of the 32 darkest codes, which include the linear parts
  // of CIE's and sRGB's curves.
  std::vector<std::array<double, 3>> codes;
  for (int r = 0; r < 32; ++r)
    for (int g = 0; g < 32; ++g)
      for (int b = 0; b < 32; ++b)
        codes.push_back({ 1.0 * r, 1.0 * g, 1.0 * b });
  fail_unless_at_most(error({ .model = ColorModel::rgb }, codes), kBound);
}

CHECK_TEST(test_yuv)
{
  // Random codes. Most lie outside the R'G'B' cube and the nominal range, so clipping is tested,
  // too.
  unsigned seed = 3;
  for (const auto matrix : { saliency::kBt601, saliency::kBt709, saliency::kBt2020 })
    for (const bool full_range : { false, true })
      for (const int depth : { 8, 9, 10, 12, 16 }) {
        const double e = error({ .depth = depth, .full_range = full_range, .matrix = matrix },
                               random_codes(depth, ++seed));
        fail_unless(e <= kBound, "kr %g, %d bits, full range %d: ΔE %g", matrix.kr, depth,
                    full_range, e);
      }
}

CHECK_TEST(test_fractional_codes)
{
  auto codes = random_codes(8, 100);
  for (std::size_t i = 0; i < codes.size(); ++i)
    for (double &v : codes[i])
      v += static_cast<double>(i % 64) / 64;
  fail_unless_at_most(error({}, codes), kBound);
}

CHECK_TEST(test_invalid_codings)
{
  fail_if(refuses({}));
  fail_unless(refuses({ .depth = 7 }));
  fail_unless(refuses({ .depth = 17 }));
  fail_unless(refuses({ .matrix = { 0.5, 0.5 } }));
  fail_unless(refuses({ .matrix = { 0, 0.1 } }));
  fail_unless(refuses({ .matrix = { NAN, 0.1 } }));
  fail_if(refuses({ .model = ColorModel::rgb, .matrix = { 0, 0 } })); // not used by RGB
}

CHECK_MAIN(lab)
