// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frameconverter.h"

namespace {

GstVideoInfo
small_info(const GstVideoInfo &info, int halvings)
{
  const auto halved = [halvings](gint side) {
    return static_cast<guint>(((side - 1) >> halvings) + 1);
  };
  const bool is_gray = GST_VIDEO_FORMAT_INFO_IS_GRAY(info.finfo);
  const bool is_rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(info.finfo);
  GstVideoInfo small;
  gst_video_info_set_interlaced_format(&small,
                                       is_gray  ? GST_VIDEO_FORMAT_GRAY8
                                       : is_rgb ? GST_VIDEO_FORMAT_RGBx
                                                : GST_VIDEO_FORMAT_Y444,
                                       GST_VIDEO_INFO_INTERLACE_MODE(&info),
                                       halved(GST_VIDEO_INFO_WIDTH(&info)),
                                       halved(GST_VIDEO_INFO_HEIGHT(&info)));
  small.colorimetry = info.colorimetry;
  small.fps_n = info.fps_n; // the converter insists
  small.fps_d = info.fps_d;
  return small;
}

class FrameConverter : public FrameShrinker
{
public:
  FrameConverter(const GstVideoInfo &info, const GstVideoInfo &small)
      : info_(info), small_(small),
        converter_(gst_video_converter_new(
            &info_, &small_,
            gst_structure_new("options", GST_VIDEO_CONVERTER_OPT_DITHER_METHOD,
                              GST_TYPE_VIDEO_DITHER_METHOD, GST_VIDEO_DITHER_NONE, nullptr)))
  {
  }
  ~FrameConverter() override
  {
    if (converter_)
      gst_video_converter_free(converter_);
  }
  FrameConverter(const FrameConverter &) = delete;
  FrameConverter &operator=(const FrameConverter &) = delete;

  explicit operator bool() const
  {
    return converter_ != nullptr;
  }

  GstBuffer *shrink(GstBuffer *frame, SmallPicture &picture) override
  {
    GstVideoFrame from;
    if (!gst_video_frame_map(&from, &info_, frame, GST_MAP_READ))
      return nullptr;
    g_autoptr(GstBuffer) small
        = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&small_), nullptr);
    GstVideoFrame to;
    const bool mapped = gst_video_frame_map(&to, &small_, small, GST_MAP_WRITE);
    if (mapped) {
      gst_video_converter_frame(converter_, &from, &to);
      gst_video_frame_unmap(&to);
    }
    gst_video_frame_unmap(&from);
    picture = { small_,
                { static_cast<double>(small_.width) / info_.width,
                  static_cast<double>(small_.height) / info_.height },
                info_.width,
                GST_VIDEO_INFO_FIELD_HEIGHT(&info_) };
    return mapped ? g_steal_pointer(&small) : nullptr;
  }

private:
  GstVideoInfo info_;
  GstVideoInfo small_;
  GstVideoConverter *converter_;
};

} // namespace

std::unique_ptr<FrameShrinker>
make_frame_converter(const GstVideoInfo &info, int halvings)
{
  if (GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_ENCODED
      || GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_UNKNOWN)
    return nullptr;
  auto converter = std::make_unique<FrameConverter>(info, small_info(info, halvings));
  if (!*converter)
    return nullptr;
  return converter;
}
