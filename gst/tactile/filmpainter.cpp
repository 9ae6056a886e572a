// SPDX-License-Identifier: LGPL-2.1-or-later
#include "filmpainter.h"

#include "colorcodes.h"

#include <algorithm>
#include <cmath>

namespace {

tactile::SamplePlane
component(GstVideoFrame *frame, unsigned c)
{
  const GstVideoFormatInfo *format = frame->info.finfo;
  return { .data = static_cast<std::uint8_t *>(GST_VIDEO_FRAME_COMP_DATA(frame, c)),
           .row_stride = GST_VIDEO_FRAME_COMP_STRIDE(frame, c),
           .pixel_stride = GST_VIDEO_FRAME_COMP_PSTRIDE(frame, c),
           .width = GST_VIDEO_FRAME_COMP_WIDTH(frame, c),
           .height = GST_VIDEO_FRAME_COMP_HEIGHT(frame, c),
           .block_width = 1 << GST_VIDEO_FORMAT_INFO_W_SUB(format, c),
           .block_height = 1 << GST_VIDEO_FORMAT_INFO_H_SUB(format, c) };
}

std::array<std::uint16_t, 3>
codes_of(const GstVideoInfo &info, const tactile::Color &color)
{
  return color_codes(info, { color.red / 255.0, color.green / 255.0, color.blue / 255.0 });
}

} // namespace

std::optional<FilmPainter>
FilmPainter::make(const GstVideoInfo &info)
{
  FilmPainter painter;
  painter.info_ = info;
  painter.background_.reset(gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr));
  GstBuffer *background = painter.background_.get();
  GstVideoFrame frame;
  if (!background)
    return std::nullopt;
  // Padding and alpha are opaque.
  gst_buffer_memset(background, 0, 0xff, GST_VIDEO_INFO_SIZE(&info));
  if (!gst_video_frame_map(&frame, &info, background, GST_MAP_WRITE))
    return std::nullopt;
  const auto codes = codes_of(info, tactile::SyntheticFilm::kBackground);
  for (unsigned c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&frame); c++) {
    const tactile::SamplePlane plane = component(&frame, c);
    for (int y = 0; y < plane.height; y++)
      for (int x = 0; x < plane.width; x++)
        plane.data[y * plane.row_stride + static_cast<std::ptrdiff_t>(x) * plane.pixel_stride]
            = static_cast<std::uint8_t>(codes[c]);
  }
  gst_video_frame_unmap(&frame);
  return painter;
}

bool
FilmPainter::paint(GstVideoFrame *frame, const std::vector<tactile::Ball> &balls,
                   const tactile::SensorNoise *noise, tactile::Time time) const
{
  GstVideoFrame background;
  if (!gst_video_frame_map(&background, &info_, background_.get(), GST_MAP_READ))
    return false;
  gst_video_frame_copy(frame, &background);
  gst_video_frame_unmap(&background);

  for (const tactile::Ball &ball : balls) {
    const auto codes = codes_of(info_, ball.color);
    for (unsigned c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(frame); c++)
      tactile::draw_ball(component(frame, c), ball, static_cast<std::uint8_t>(codes[c]));
  }
  if (noise != nullptr)
    for (unsigned c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(frame); c++)
      noise->add(component(frame, c), static_cast<int>(c), time);
  return true;
}

void
add_target(GstBuffer *buffer, const GstVideoInfo &info, const tactile::Ball &ball)
{
  const auto limit = [](double position, int size) {
    return static_cast<guint>(std::clamp(static_cast<int>(position), 0, size));
  };
  const guint left = limit(std::floor(ball.x - ball.radius), GST_VIDEO_INFO_WIDTH(&info));
  const guint right = limit(std::ceil(ball.x + ball.radius), GST_VIDEO_INFO_WIDTH(&info));
  const guint top = limit(std::floor(ball.y - ball.radius), GST_VIDEO_INFO_HEIGHT(&info));
  const guint bottom = limit(std::ceil(ball.y + ball.radius), GST_VIDEO_INFO_HEIGHT(&info));

  GstVideoRegionOfInterestMeta *region = gst_buffer_add_video_region_of_interest_meta(
      buffer, "tactile-target", left, top, right - left, bottom - top);
  region->id = ball.index;
  gst_video_region_of_interest_meta_add_param(
      region, gst_structure_new("tactile-target", "ball", G_TYPE_INT, ball.index, "onset",
                                G_TYPE_UINT64, static_cast<guint64>(ball.onset.count()), "moving",
                                G_TYPE_BOOLEAN, ball.moving ? TRUE : FALSE, nullptr));
}
