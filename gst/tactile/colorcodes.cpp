// SPDX-License-Identifier: LGPL-2.1-or-later
#include "colorcodes.h"

#include <algorithm>
#include <cmath>

std::array<std::uint16_t, 3>
color_codes(const GstVideoInfo &info, const Rgb &color)
{
  std::array<double, 3> parts{ color.red, color.green, color.blue };
  if (!GST_VIDEO_INFO_IS_RGB(&info)) {
    gdouble kr = 0;
    gdouble kb = 0;
    if (!gst_video_color_matrix_get_Kr_Kb(info.colorimetry.matrix, &kr, &kb))
      gst_video_color_matrix_get_Kr_Kb(GST_VIDEO_COLOR_MATRIX_BT601, &kr, &kb);
    const double luma = kr * color.red + (1 - kr - kb) * color.green + kb * color.blue;
    parts = { luma, (color.blue - luma) / (2 * (1 - kb)), (color.red - luma) / (2 * (1 - kr)) };
  }

  gint offset[GST_VIDEO_MAX_COMPONENTS] = {};
  gint scale[GST_VIDEO_MAX_COMPONENTS] = {};
  gst_video_color_range_offsets(info.colorimetry.range, info.finfo, offset, scale);
  std::array<std::uint16_t, 3> codes{};
  for (unsigned c = 0; c < std::min(3U, GST_VIDEO_INFO_N_COMPONENTS(&info)); c++) {
    const double most = (1U << GST_VIDEO_INFO_COMP_DEPTH(&info, c)) - 1;
    codes[c] = static_cast<std::uint16_t>(
        std::lround(std::clamp(offset[c] + parts[c] * scale[c], 0.0, most)));
  }
  return codes;
}
