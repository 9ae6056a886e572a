// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/video/video.h>

#include <array>
#include <cstdint>

/// R'G'B', 0…1.
struct Rgb
{
  double red;
  double green;
  double blue;
};

/// Code values of a color in a format's components (Y, Cb, Cr or R, G, B or gray), by its matrix
/// and range: ITU-R BT.601, BT.709 and BT.2020.
std::array<std::uint16_t, 3> color_codes(const GstVideoInfo &info, const Rgb &color);
