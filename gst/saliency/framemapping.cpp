// SPDX-License-Identifier: LGPL-2.1-or-later
#include "framemapping.h"

#include <algorithm>

namespace {

saliency::YuvMatrix
yuv_matrix(const GstVideoColorimetry &colorimetry)
{
  switch (colorimetry.matrix) {
  case GST_VIDEO_COLOR_MATRIX_BT601:
    return saliency::kBt601;
  case GST_VIDEO_COLOR_MATRIX_BT2020:
    return saliency::kBt2020;
  default: {
    gdouble kr;
    gdouble kb;
    // Other matrices with two coefficients (FCC, SMPTE 240M). Unknown ones: BT.709.
    if (gst_video_color_matrix_get_Kr_Kb(colorimetry.matrix, &kr, &kb))
      return { kr, kb };
    return saliency::kBt709;
  }
  }
}

saliency::ColorModel
color_model(const GstVideoFormatInfo *format)
{
  if (GST_VIDEO_FORMAT_INFO_IS_GRAY(format))
    return saliency::ColorModel::gray;
  return GST_VIDEO_FORMAT_INFO_IS_RGB(format) ? saliency::ColorModel::rgb
                                              : saliency::ColorModel::yuv;
}

} // namespace

FrameMapping::FrameMapping(const GstVideoInfo &info, GstBuffer *buffer)
    : mapped_(gst_video_frame_map(
        &frame_, &info, buffer,
        static_cast<GstMapFlags>(static_cast<int>(GST_MAP_READ)
                                 | static_cast<int>(GST_VIDEO_FRAME_MAP_FLAG_NO_REF))))
{
  if (!mapped_)
    return;
  const GstVideoFormatInfo *format = frame_.info.finfo;

  view_.width = GST_VIDEO_FRAME_WIDTH(&frame_);
  view_.height = GST_VIDEO_INFO_FIELD_HEIGHT(&frame_.info); // alternate fields come one a buffer
  if (const GstVideoCropMeta *crop = gst_buffer_get_video_crop_meta(buffer)) {
    // Chroma has whole samples: the window begins at an even pixel.
    const int align_x = 1 << std::max(GST_VIDEO_FORMAT_INFO_W_SUB(format, 1), 0u);
    const int align_y = 1 << std::max(GST_VIDEO_FORMAT_INFO_H_SUB(format, 1), 0u);
    left_ = static_cast<int>(std::min<guint>(crop->x, static_cast<guint>(view_.width - 1)))
            / align_x * align_x;
    top_ = static_cast<int>(std::min<guint>(crop->y, static_cast<guint>(view_.height - 1)))
           / align_y * align_y;
    view_.width = std::clamp(static_cast<int>(std::min<guint>(crop->width, G_MAXINT)), 1,
                             view_.width - left_);
    view_.height = std::clamp(static_cast<int>(std::min<guint>(crop->height, G_MAXINT)), 1,
                              view_.height - top_);
  }

  view_.model = color_model(format);
  view_.depth = static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(format, 0));
  view_.shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_SHIFT(format, 0));
  view_.full_range = frame_.info.colorimetry.range == GST_VIDEO_COLOR_RANGE_0_255;
  view_.matrix = yuv_matrix(frame_.info.colorimetry);

  const guint components = std::min<guint>(view_.model == saliency::ColorModel::gray ? 1 : 3,
                                           GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format));
  for (guint i = 0; i < components; i++) {
    saliency::Component &component = view_.components[i];
    const int w_sub = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(format, i));
    const int h_sub = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(format, i));
    component.row_stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame_, i);
    component.pixel_stride = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame_, i);
    // GStreamer 1.22 has an offset of one byte, not of one sample, for P010's second chroma
    // component.
    const int misplaced
        = view_.depth > 8 ? static_cast<int>(GST_VIDEO_FORMAT_INFO_POFFSET(format, i) & 1) : 0;
    component.data = static_cast<const std::uint8_t *>(GST_VIDEO_FRAME_COMP_DATA(&frame_, i))
                     + misplaced + (top_ >> h_sub) * component.row_stride
                     + static_cast<std::ptrdiff_t>(left_ >> w_sub) * component.pixel_stride;
    component.width = GST_VIDEO_SUB_SCALE(w_sub, view_.width);
    component.height = GST_VIDEO_SUB_SCALE(h_sub, view_.height);
  }
}

FrameMapping::~FrameMapping()
{
  if (mapped_)
    gst_video_frame_unmap(&frame_);
}
