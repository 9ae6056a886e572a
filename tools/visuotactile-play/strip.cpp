// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strip.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

namespace {

constexpr int kFrameWidth = 240;
constexpr int kMargin = 6;
constexpr GstClockTime kDefaultStep = 10 * GST_SECOND;
constexpr GstClockTime kEarlyStep = GST_SECOND / 2;

using Color = std::array<guint8, 3>;
constexpr Color kPaper{ 255, 255, 255 };
constexpr Color kIdle{ 38, 40, 48 };
constexpr Color kFull{ 255, 140, 20 };

/// An RGB picture in memory, with GStreamer's row stride.
struct Picture
{
  int width;
  int height;
  int stride;
  std::vector<guint8> pixels;

  Picture(int width_, int height_)
      : width(width_), height(height_), stride(GST_ROUND_UP_4(width_ * 3)),
        pixels(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_), kPaper[0])
  {
  }

  guint8 *at(int x, int y)
  {
    return pixels.data() + static_cast<std::ptrdiff_t>(y) * stride
           + static_cast<std::ptrdiff_t>(x) * 3;
  }

  void fill(int x, int y, int w, int h, const Color &color)
  {
    for (int row = std::max(y, 0); row < std::min(y + h, height); row++)
      for (int column = std::max(x, 0); column < std::min(x + w, width); column++)
        std::ranges::copy(color, at(column, row));
  }
};

Color
level_color(float level)
{
  Color color;
  for (std::size_t i = 0; i < color.size(); i++)
    color[i] = static_cast<guint8>(static_cast<float>(kIdle[i])
                                   + level * static_cast<float>(kFull[i] - kIdle[i]));
  return color;
}

void
draw_map(Picture &picture, const GstTactileMeta *meta, int x, int y, int side)
{
  const int rows = static_cast<int>(meta->rows);
  const int columns = static_cast<int>(meta->columns);
  for (int r = 0; r < rows; r++)
    for (int c = 0; c < columns; c++) {
      const int left = x + c * side / columns;
      const int top = y + r * side / rows;
      const int gap = side / std::max(rows, columns) > 4 ? 1 : 0;
      picture.fill(left, top, x + (c + 1) * side / columns - left - gap,
                   y + (r + 1) * side / rows - top - gap,
                   level_color(gst_tactile_meta_get_level(meta, static_cast<guint>(r),
                                                          static_cast<guint>(c))));
    }
}

void
draw_frame(Picture &picture, GstSample *sample, int x, int y)
{
  GstVideoInfo info;
  GstVideoFrame frame;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample))
      || !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return;
  const int width = std::min(GST_VIDEO_FRAME_WIDTH(&frame), picture.width - x);
  for (int row = 0; row < std::min(GST_VIDEO_FRAME_HEIGHT(&frame), picture.height - y); row++)
    std::memcpy(picture.at(x, y + row),
                static_cast<const guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0))
                    + static_cast<std::ptrdiff_t>(row) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0),
                static_cast<std::size_t>(width) * 3);
  gst_video_frame_unmap(&frame);
}

GstCaps *
rgb_caps(int width, int height)
{
  return gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, "RGB", "width", G_TYPE_INT,
                             width, "height", G_TYPE_INT, height, "pixel-aspect-ratio",
                             GST_TYPE_FRACTION, 1, 1, nullptr);
}

} // namespace

Strip::Strip(GstClockTime film_duration, int count)
    : step_(GST_CLOCK_TIME_IS_VALID(film_duration)
                ? std::max<GstClockTime>(film_duration / static_cast<guint>(count), 1)
                : kDefaultStep),
      next_(step_ / 2), count_(count)
{
}

Strip::~Strip()
{
  for (GstSample *sample : samples_)
    gst_sample_unref(sample);
}

void
Strip::offer(GstBuffer *buffer, GstCaps *caps, GstClockTime stream_time)
{
  const std::lock_guard lock(mutex_);
  if (!GST_CLOCK_TIME_IS_VALID(stream_time))
    return;
  const bool its_turn = stream_time >= next_;
  const bool has_enough = its_turn ? static_cast<int>(samples_.size()) - early_ >= count_
                                   : !samples_.empty() && (!early_ || stream_time < next_early_);
  if (has_enough)
    return;
  if (early_) {
    gst_sample_unref(samples_.back());
    samples_.pop_back();
  }
  early_ = !its_turn;
  if (its_turn)
    next_ += ((stream_time - next_) / step_ + 1) * step_; // after a seek, several turns later
  else
    next_early_ = stream_time + kEarlyStep;
  // A deep copy: decoders' pools are small.
  GstBuffer *copy = gst_buffer_copy_deep(buffer);
  samples_.push_back(gst_sample_new(copy, caps, nullptr, nullptr));
  gst_buffer_unref(copy);
}

bool
Strip::write(const std::filesystem::path &path)
{
  const std::lock_guard lock(mutex_);
  if (samples_.empty())
    return false;
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(samples_.front())))
    return false;
  const int frame_height = std::clamp(
      static_cast<int>(gst_util_uint64_scale_int(kFrameWidth * static_cast<guint64>(info.height)
                                                     * static_cast<guint>(info.par_d),
                                                 1, std::max(info.width * info.par_n, 1))),
      1, 4 * kFrameWidth);
  constexpr int kMapSide = kFrameWidth / 2;

  Picture picture(kMargin + static_cast<int>(samples_.size()) * (kFrameWidth + kMargin),
                  3 * kMargin + frame_height + kMapSide);
  int x = kMargin;
  GstCaps *thumbnail_caps = rgb_caps(kFrameWidth, frame_height);
  for (GstSample *sample : samples_) {
    if (GstSample *thumbnail
        = gst_video_convert_sample(sample, thumbnail_caps, 5 * GST_SECOND, nullptr)) {
      draw_frame(picture, thumbnail, x, kMargin);
      gst_sample_unref(thumbnail);
    }
    if (const GstTactileMeta *meta = gst_buffer_get_tactile_meta(gst_sample_get_buffer(sample)))
      draw_map(picture, meta, x + (kFrameWidth - kMapSide) / 2, 2 * kMargin + frame_height,
               kMapSide);
    x += kFrameWidth + kMargin;
  }
  gst_caps_unref(thumbnail_caps);

  GstCaps *caps = rgb_caps(picture.width, picture.height);
  gst_caps_set_simple(caps, "framerate", GST_TYPE_FRACTION, 0, 1, nullptr);
  GstBuffer *buffer = gst_buffer_new_memdup(picture.pixels.data(), picture.pixels.size());
  GstSample *sample = gst_sample_new(buffer, caps, nullptr, nullptr);
  GstCaps *png_caps = gst_caps_new_empty_simple("image/png");
  GstSample *png = gst_video_convert_sample(sample, png_caps, 10 * GST_SECOND, nullptr);
  bool written = false;
  GstMapInfo map;
  if (png && gst_buffer_map(gst_sample_get_buffer(png), &map, GST_MAP_READ)) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(map.data), static_cast<std::streamsize>(map.size));
    written = file.good();
    gst_buffer_unmap(gst_sample_get_buffer(png), &map);
  }
  if (png)
    gst_sample_unref(png);
  gst_caps_unref(png_caps);
  gst_sample_unref(sample);
  gst_buffer_unref(buffer);
  gst_caps_unref(caps);
  return written;
}
