// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/similarity.h"

#include "support/tolerance.h"

#include <numbers>
#include <utility>

#include "support/check_tests.h"

using saliency::Similarity;

namespace {

/// Scale, rotation about the origin, then a shift.
Similarity
similarity(double scale, double angle, double tx, double ty)
{
  return { scale * std::cos(angle), scale * std::sin(angle), tx, ty };
}

const Similarity kSome[] = { {},
                             similarity(1, 0, 3, -4),
                             similarity(1.7, 0.3, -2, 5),
                             similarity(0.2, -2.5, 100, 0.5),
                             similarity(3, std::numbers::pi, 0, 0) };

} // namespace

CHECK_TEST(test_points)
{
  // Scale 2, a quarter turn from x to y, then 10 to the right and 20 down.
  const Similarity s = similarity(2, std::numbers::pi / 2, 10, 20);
  fail_unless_near(s.x(3, 4), -2 * 4 + 10, 1e-12);
  fail_unless_near(s.y(3, 4), 2 * 3 + 20, 1e-12);
  const Similarity identity;
  fail_unless(identity.x(3, 4) == 3 && identity.y(3, 4) == 4);
}

CHECK_TEST(test_composition)
{
  for (const auto &outer : kSome)
    for (const auto &inner : kSome) {
      const Similarity both = outer * inner;
      for (const auto &[x, y] : { std::pair{ 0.0, 0.0 }, { 1.0, 0.0 }, { -7.0, 31.0 } }) {
        const double px = inner.x(x, y);
        const double py = inner.y(x, y);
        fail_unless_near(both.x(x, y), outer.x(px, py), 1e-9);
        fail_unless_near(both.y(x, y), outer.y(px, py), 1e-9);
      }
    }
}

CHECK_TEST(test_inverse)
{
  for (const auto &s : kSome)
    for (const auto &[x, y] : { std::pair{ 0.0, 0.0 }, { 1.0, 0.0 }, { -7.0, 31.0 } }) {
      fail_unless_near(s.inverse().x(s.x(x, y), s.y(x, y)), x, 1e-9);
      fail_unless_near(s.inverse().y(s.x(x, y), s.y(x, y)), y, 1e-9);
      fail_unless_near(s.x(s.inverse().x(x, y), s.inverse().y(x, y)), x, 1e-9);
    }
}

CHECK_TEST(test_units)
{
  // In units four times as long a point's coordinates are a quarter.
  for (const auto &s : kSome)
    for (const double unit : { 4.0, 0.25, 1.0 }) {
      const Similarity coarse = s.in_units_of(unit);
      fail_unless_near(coarse.x(5 / unit, 8 / unit), s.x(5, 8) / unit, 1e-9);
      fail_unless_near(coarse.y(5 / unit, 8 / unit), s.y(5, 8) / unit, 1e-9);
    }
}

CHECK_MAIN(similarity)
