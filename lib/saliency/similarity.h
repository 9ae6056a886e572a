// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace saliency {

/// A similarity transform of the plane: (x, y) ↦ (a x − b y + tx, b x + a y + ty).
struct Similarity
{
  double a = 1;
  double b = 0;
  double tx = 0;
  double ty = 0;

  double x(double px, double py) const
  {
    return a * px - b * py + tx;
  }
  double y(double px, double py) const
  {
    return b * px + a * py + ty;
  }

  /// Composition: applies `inner` first.
  Similarity operator*(const Similarity &inner) const
  {
    return { a * inner.a - b * inner.b, a * inner.b + b * inner.a, x(inner.tx, inner.ty),
             y(inner.tx, inner.ty) };
  }

  /// Requires a or b to be nonzero.
  Similarity inverse() const
  {
    const double norm = a * a + b * b;
    const Similarity turned{ a / norm, -b / norm, 0, 0 };
    return { turned.a, turned.b, -turned.x(tx, ty), -turned.y(tx, ty) };
  }

  /// The same transform in a length unit `unit` times as long, between grids of the same origin.
  Similarity in_units_of(double unit) const
  {
    return { a, b, tx / unit, ty / unit };
  }

  bool operator==(const Similarity &) const = default;
};

} // namespace saliency
