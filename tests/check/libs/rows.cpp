// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/rows.h"

#include "saliency/dilation.h"
#include "saliency/quantile.h"

#include <hwy/targets.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <random>
#include <vector>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "support/tolerance.h"

#include "support/check_tests.h"

namespace rows = saliency::rows;

namespace {

/// Lengths from less than any vector to every remainder of the longest one.
constexpr std::size_t kLongest = 70;

/// Rows have their exact length, so a sanitizer sees overruns.
std::vector<float>
random_row(std::size_t n, unsigned seed, float low = -100, float high = 100)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(low, high);
  std::vector<float> row(n);
  for (float &v : row)
    v = value(generator);
  return row;
}

std::vector<double>
random_doubles(std::size_t n, unsigned seed)
{
  const auto row = random_row(n, seed);
  return { row.begin(), row.end() };
}

/// Runs `check` with each instruction set of this CPU for rows of each length. Its results must be
/// bit-identical for all sets.
void
with_all(const std::function<std::vector<float>(std::size_t)> &check)
{
  const auto targets = hwy::SupportedTargets();
  std::vector<std::vector<float>> first(kLongest + 1);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::GetChosenTarget().Update(target);
    for (std::size_t n = 1; n <= kLongest; ++n) {
      const auto found = check(n);
      if (first[n].empty())
        first[n] = found;
      fail_unless(found == first[n], "%s differs", hwy::TargetName(target));
    }
    hwy::GetChosenTarget().Update(targets);
  }
}

} // namespace

CHECK_TEST(test_enlarge)
{
  with_all([](std::size_t n) {
    std::vector<float> found;
    for (const int octaves : { 0, 1, 2, 7 }) {
      const double step = 1 << octaves;
      // Just as many samples as needed, fewer (the last one repeats), and more.
      const auto reach = static_cast<std::size_t>(std::ceil((n - 1) / step)) + 1;
      for (const std::size_t length : { std::size_t{ 1 }, reach, reach + 3 }) {
        const auto above = random_row(length, 3);
        const auto below = random_row(length, 4);
        for (const float weight : { 0.0F, 0.3F }) {
          const auto in = [&](std::size_t i) {
            return above[i] + static_cast<double>(weight) * (below[i] - above[i]);
          };
          std::vector<float> out(n);
          rows::enlarge({ above.data(), below.data(), weight, length }, octaves, n, out.data());
          for (std::size_t x = 0; x < n; ++x) {
            const double at = std::min(x / step, length - 1.0);
            const auto before = static_cast<std::size_t>(at);
            const double after = in(std::min(before + 1, length - 1));
            fail_unless_near(out[x], in(before) + (at - before) * (after - in(before)), 1e-4);
          }
          found.insert(found.end(), out.begin(), out.end());
        }
      }
    }
    return found;
  });
}

CHECK_TEST(test_contrasts)
{
  with_all([](std::size_t n) {
    std::vector<std::vector<float>> r;
    for (unsigned seed = 0; seed < 6; ++seed)
      r.push_back(random_row(n, seed));
    std::vector<float> out(n);
    rows::chroma_contrast({ r[0].data(), r[1].data() }, { r[2].data(), r[3].data() }, 4, n,
                          out.data());
    for (std::size_t i = 0; i < n; ++i) {
      const double squared = 4 * (std::pow(r[0][i] - r[2][i], 2) + std::pow(r[1][i] - r[3][i], 2));
      fail_unless_near(out[i], squared, 1e-6 * squared + 1e-6);
    }
    const auto chroma = out;
    rows::contrast(r[4].data(), r[5].data(), chroma.data(), n, out.data());
    for (std::size_t i = 0; i < n; ++i)
      fail_unless_near(
          out[i], std::sqrt(std::pow(static_cast<double>(r[4][i]) - r[5][i], 2) + chroma[i]), 1e-3);
    out.insert(out.end(), chroma.begin(), chroma.end());
    return out;
  });
}

CHECK_TEST(test_count_changed)
{
  with_all([](std::size_t n) {
    std::vector<std::vector<float>> r;
    for (unsigned seed = 0; seed < 6; ++seed)
      r.push_back(random_row(n, seed));
    std::size_t expected = 0;
    for (std::size_t i = 0; i < n; ++i)
      expected += std::hypot(r[0][i] - r[3][i], r[1][i] - r[4][i], r[2][i] - r[5][i]) > 120 ? 1 : 0;
    ck_assert_uint_eq(rows::count_changed({ r[0].data(), r[1].data(), r[2].data() },
                                          { r[3].data(), r[4].data(), r[5].data() }, 120 * 120, n),
                      expected);
    return std::vector<float>{ static_cast<float>(expected) };
  });
}

CHECK_TEST(test_keep_between)
{
  with_all([](std::size_t n) {
    for (const float low : { 0.0F, 10.0F, 90.0F }) {
      auto values = random_row(n, static_cast<unsigned>(n), 0, 50);
      values[n / 2] = low; // the lower bound is included
      std::vector<float> expected;
      std::ranges::copy_if(values, std::back_inserter(expected),
                           [low](float v) { return v >= low && v < low + 20; });
      const std::size_t kept = rows::keep_between(low, low + 20, n, values.data());
      ck_assert_uint_eq(kept, expected.size());
      fail_unless(std::equal(expected.begin(), expected.end(), values.begin()));
    }
    return std::vector<float>{ 0 };
  });
}

CHECK_TEST(test_greatest)
{
  with_all([](std::size_t n) {
    std::vector<float> found;
    for (const int count : { 1, 2, 7 })
      for (const int step : { 1, 80 }) {
        const auto row = random_row(n + static_cast<std::size_t>((count - 1) * step), 14);
        std::vector<float> out(n);
        rows::greatest(row.data(), step, count, n, out.data());
        for (std::size_t i = 0; i < n; ++i) {
          float most = row[i];
          for (int k = 1; k < count; ++k)
            most = std::max(most, row[i + static_cast<std::size_t>(k * step)]);
          fail_unless(out[i] == most, "%d by %d, sample %zu of %zu", count, step, i, n);
        }
        found.insert(found.end(), out.begin(), out.end());
      }
    return found;
  });
}

CHECK_TEST(test_dilation)
{
  std::mt19937 generator(15);
  for (int width = 1; width <= static_cast<int>(kLongest); ++width)
    for (const int radius : { 0, 1, 3, 12 }) {
      cv::Mat map(1 + width % 30, width, CV_32FC1);
      for (std::size_t i = 0; i < map.total(); ++i)
        map.ptr<float>()[i] = static_cast<float>(generator() % 1000);
      cv::Mat along_rows;
      cv::Mat dilated;
      saliency::dilate(map, radius, along_rows, dilated);
      for (int y = 0; y < map.rows; ++y)
        for (int x = 0; x < width; ++x) {
          const cv::Rect around(x - radius, y - radius, 2 * radius + 1, 2 * radius + 1);
          double most = 0;
          cv::minMaxLoc(map(around & cv::Rect({}, map.size())), nullptr, &most);
          fail_unless_near(dilated.at<float>(y, x), most, 0);
        }
    }
}

CHECK_TEST(test_integrals)
{
  with_all([](std::size_t n) {
    const auto map = random_row(n, 9);
    const auto base = random_doubles(n, 10);
    auto sum = base;
    rows::integrate(sum.data(), map.data(), n, sum.data()); // in place
    for (std::size_t i = 0; i < n; ++i)
      fail_unless_near(sum[i], base[i] + static_cast<double>(map[i]), 1e-12);

    const auto from = random_doubles(n, 11);
    std::vector<float> found(sum.begin(), sum.end());
    std::vector<float> out(n);
    rows::difference(from.data(), sum.data(), 3, n, out.data());
    for (std::size_t i = 0; i < n; ++i)
      fail_unless_near(out[i], 3 * (sum[i] - from[i]), 1e-4);
    found.insert(found.end(), out.begin(), out.end());
    return found;
  });
}

/// Against sorting: many equal values, zeros, and values across all powers of two.
static void
check_quantiles()
{
  std::mt19937 generator(13);
  for (std::size_t n = 1; n < 300; n += 7)
    for (const int kind : { 0, 1, 2 }) {
      std::vector<float> values = random_row(n, static_cast<unsigned>(n), 0, 50);
      for (float &v : values)
        v = kind == 0   ? v
            : kind == 1 ? std::floor(v / 20)
                        : std::ldexp(v, static_cast<int>(generator() % 200) - 100);
      auto sorted = values;
      std::ranges::sort(sorted);
      for (const double q : { 0.0, 0.1, 0.5, 0.75, 1.0 }) {
        auto scratch = values;
        const auto place = static_cast<std::size_t>(q * static_cast<double>(n - 1));
        fail_unless(saliency::quantile(scratch, q) == sorted[place], "%zu numbers, %g", n, q);
      }
    }
}

CHECK_TEST(test_quantile)
{
  check_quantiles();
#ifdef __SSE2__
  // With subnormal numbers flushed to zero, as a library that GStreamer loads may set it.
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040); // flush to zero, denormals are zero
  check_quantiles();
  _mm_setcsr(before);
#endif
}

CHECK_MAIN(rows)
