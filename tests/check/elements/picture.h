// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Frames of every format as colors in double precision. GStreamer packs and unpacks them, the
// formulas of BT.601 convert them.

#include <gst/check/gstcheck.h>
#include <gst/video/video.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

struct Color
{
  double red, green, blue; ///< 0…255
};

inline Color
mix(const Color &picture, const Color &color, double weight)
{
  return { picture.red + weight * (color.red - picture.red),
           picture.green + weight * (color.green - picture.green),
           picture.blue + weight * (color.blue - picture.blue) };
}

inline GstVideoInfo
info_of(const std::string &format, int width, int height)
{
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format.c_str()),
                            static_cast<guint>(width), static_cast<guint>(height));
  return info;
}

/// Code values of A, then Y, Cb, Cr or R, G, B in the format to which GStreamer unpacks `info`, not
/// rounded. Y'CbCr is BT.601 in video range, gray in full range: GStreamer's defaults for such
/// small pictures.
inline std::array<double, 4>
to_codes(const GstVideoInfo &info, const Color &color)
{
  const double deep
      = GST_VIDEO_FORMAT_INFO_BITS(gst_video_format_get_info(info.finfo->unpack_format)) == 16 ? 256
                                                                                               : 1;
  const double opaque = deep * 256 - 1;
  if (GST_VIDEO_INFO_IS_RGB(&info))
    return { opaque, color.red, color.green, color.blue };
  const double luma = 0.299 * color.red + 0.587 * color.green + 0.114 * color.blue;
  if (GST_VIDEO_INFO_IS_GRAY(&info))
    return { opaque, luma, 128, 128 };
  return { opaque, deep * (16 + 219 * luma / 255),
           deep * (128 + 224 * (color.blue - luma) / 1.772 / 255),
           deep * (128 + 224 * (color.red - luma) / 1.402 / 255) };
}

inline Color
from_codes(const GstVideoInfo &info, const std::array<double, 4> &codes)
{
  if (GST_VIDEO_INFO_IS_RGB(&info))
    return { codes[1], codes[2], codes[3] };
  if (GST_VIDEO_INFO_IS_GRAY(&info))
    return { codes[1], codes[1], codes[1] };
  const double deep
      = GST_VIDEO_FORMAT_INFO_BITS(gst_video_format_get_info(info.finfo->unpack_format)) == 16 ? 256
                                                                                               : 1;
  const double luma = (codes[1] / deep - 16) * 255 / 219;
  const double blue = luma + 1.772 * (codes[2] / deep - 128) * 255 / 224;
  const double red = luma + 1.402 * (codes[3] / deep - 128) * 255 / 224;
  return { red, (luma - 0.299 * red - 0.114 * blue) / 0.587, blue };
}

/// One line as GStreamer packs and unpacks it, with 8 or 16 bits.
class Line
{
public:
  Line(const GstVideoInfo &info, int width)
      : deep_(GST_VIDEO_FORMAT_INFO_BITS(gst_video_format_get_info(info.finfo->unpack_format))
              == 16),
        words_(static_cast<std::size_t>(width + 8) * 4)
  {
  }

  gpointer data()
  {
    return words_.data();
  }

  double get(std::size_t i) const
  {
    return deep_ ? words_[i] : reinterpret_cast<const guint8 *>(words_.data())[i];
  }

  void set(std::size_t i, double value)
  {
    if (deep_)
      words_[i] = static_cast<guint16>(std::lround(value));
    else
      reinterpret_cast<guint8 *>(words_.data())[i] = static_cast<guint8>(std::lround(value));
  }

private:
  bool deep_;
  std::vector<guint16> words_;
};

/// A frame of one color, packed by GStreamer.
inline GstBuffer *
make_frame(const std::string &format, int width, int height, const Color &color)
{
  const GstVideoInfo info = info_of(format, width, height);
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
  gst_buffer_memset(buffer, 0, 0, -1);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE));
  Line line(info, width);
  const std::array<double, 4> codes = to_codes(info, color);
  for (std::size_t i = 0; i < static_cast<std::size_t>(width + 8) * 4; i++)
    line.set(i, codes[i % 4]);
  for (int y = 0; y < height; y++)
    info.finfo->pack_func(info.finfo, GST_VIDEO_PACK_FLAG_NONE, line.data(), 0, frame.data,
                          frame.info.stride, GST_VIDEO_CHROMA_SITE_UNKNOWN, y, width);
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(buffer) = 0;
  return buffer;
}

/// A frame's colors, unpacked by GStreamer.
struct Picture
{
  std::string format;
  int width;
  std::vector<Color> pixels;

  Picture(GstBuffer *buffer, const std::string &format_, int width_, int height)
      : format(format_), width(width_)
  {
    const GstVideoInfo info = info_of(format, width, height);
    GstVideoFrame frame;
    fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
    Line line(info, width);
    for (int y = 0; y < height; y++) {
      info.finfo->unpack_func(info.finfo, GST_VIDEO_PACK_FLAG_NONE, line.data(), frame.data,
                              frame.info.stride, 0, y, width);
      for (std::size_t x = 0; x < static_cast<std::size_t>(width); x++)
        pixels.push_back(from_codes(info, { line.get(4 * x), line.get(4 * x + 1),
                                            line.get(4 * x + 2), line.get(4 * x + 3) }));
    }
    gst_video_frame_unmap(&frame);
  }

  const Color &at(int x, int y) const
  {
    return pixels[static_cast<std::size_t>(y * width + x)];
  }
};
