// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

/// A schematic face that a face detector recognizes: gray ellipses in units of half the head's
/// width, relative to its center.
struct FacePart
{
  double x;
  double y;
  double radius_x;
  double radius_y;
  int gray;
};

inline constexpr std::array<FacePart, 11> kSchematicFace{ {
    { 0, 0, 1, 1.3, 190 },            // head
    { -0.4, -0.38, 0.3, 0.08, 90 },   // brows
    { 0.4, -0.38, 0.3, 0.08, 90 },    //
    { -0.4, -0.15, 0.26, 0.13, 110 }, // eye sockets
    { 0.4, -0.15, 0.26, 0.13, 110 },  //
    { -0.4, -0.15, 0.1, 0.1, 40 },    // pupils
    { 0.4, -0.15, 0.1, 0.1, 40 },     //
    { 0, 0.1, 0.1, 0.35, 215 },       // bridge of the nose
    { 0, 0.42, 0.2, 0.07, 140 },      // its shadow
    { 0, 0.78, 0.38, 0.1, 100 },      // mouth
    { 0, 1.02, 0.2, 0.05, 170 },      // chin
} };

/// The face's gray at a point in these units, or -1 outside.
inline int
schematic_face_at(double x, double y)
{
  int gray = -1;
  for (const FacePart &part : kSchematicFace) {
    const double dx = (x - part.x) / part.radius_x;
    const double dy = (y - part.y) / part.radius_y;
    if (dx * dx + dy * dy <= 1)
      gray = part.gray;
  }
  return gray;
}
