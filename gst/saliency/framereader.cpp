// SPDX-License-Identifier: LGPL-2.1-or-later
#include "framereader.h"

#include "elementshrinker.h"
#include "frameconverter.h"
#include "framemapping.h"
#include "glmodule.h"

#include <algorithm>
#include <cmath>

namespace {

/// FrameMapping reads it.
bool
is_known(const GstVideoInfo &info)
{
  static GstCaps *known = gst_caps_from_string(GST_VIDEO_CAPS_MAKE(FRAME_MAPPING_FORMATS));
  g_autoptr(GstCaps) format = gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING,
                                                  GST_VIDEO_INFO_NAME(&info), nullptr);
  return gst_caps_can_intersect(format, known);
}

/// The pixels of the frame that are to be seen, as samples of its small picture, which gets a
/// GstVideoCropMeta of them.
ReadFrame::Window
shrink_window(GstBuffer *frame, GstBuffer *small, const SmallPicture &picture)
{
  const auto &[scale_x, scale_y, x, y] = picture.placement;
  const GstVideoCropMeta *crop = gst_buffer_get_video_crop_meta(frame);
  if (crop == nullptr)
    return { x, y, scale_x * picture.frame_width, scale_y * picture.frame_height };
  const ReadFrame::Window window{ x + scale_x * crop->x, y + scale_y * crop->y,
                                  scale_x * crop->width, scale_y * crop->height };
  if (gst_buffer_get_video_crop_meta(small) == nullptr) {
    GstVideoCropMeta *own = gst_buffer_add_video_crop_meta(small);
    const auto whole = [](double samples) {
      return static_cast<guint>(std::max(std::lround(samples), 0L));
    };
    own->x = whole(window.x);
    own->y = whole(window.y);
    own->width = std::max(whole(window.width), 1U);
    own->height = std::max(whole(window.height), 1U);
  }
  return window;
}

} // namespace

const char *
name_of(FrameReader::Path path)
{
  switch (path) {
  case FrameReader::Path::mapped:
    return "mapped";
  case FrameReader::Path::converted:
    return "converted";
  case FrameReader::Path::gl:
    return "gl";
  case FrameReader::Path::element:
    return "element";
  default:
    return "none";
  }
}

FrameReader::~FrameReader()
{
  stop();
}

void
FrameReader::set_caps(GstCaps *caps, const GstVideoInfo *info)
{
  shrinker_.reset();
  halvings_ = -1;
  gst_caps_replace(&caps_, caps);
  parsed_ = info != nullptr;
  if (parsed_)
    info_ = *info;
  known_ = parsed_ && is_known(info_);
}

void
FrameReader::stop()
{
  shrinker_.reset();
  halvings_ = -1;
  path_ = shrinks_ = Path::none;
  bytes_ = 0;
  gst_clear_caps(&caps_);
}

std::unique_ptr<FrameShrinker>
FrameReader::make_shrinker(int halvings)
{
  const GstCapsFeatures *features = gst_caps_get_features(caps_, 0);
  std::unique_ptr<FrameShrinker> made;
  if (halvings > 0 && gst_caps_features_contains(features, "memory:GLMemory"))
    made = make_gl_shrinker(caps_, halvings);
  shrinks_ = Path::gl;
  if (!made && (halvings > 0 || !known_)) {
    made = make_element_shrinker(owner_, caps_, halvings);
    shrinks_ = Path::element;
  }
  if (!made && parsed_ && !known_) {
    made = make_frame_converter(info_, halvings);
    shrinks_ = Path::converted;
  }
  return made;
}

FrameShrinker *
FrameReader::shrinker(int halvings)
{
  if (halvings != halvings_) {
    shrinker_.reset(); // first: both may use one GPU's memory
    shrinker_ = make_shrinker(halvings);
    halvings_ = halvings;
  }
  return shrinker_.get();
}

std::optional<ReadFrame>
FrameReader::shrink(GstBuffer *frame, int halvings)
{
  FrameShrinker *shrinker = this->shrinker(halvings);
  if (shrinker == nullptr)
    return {};
  SmallPicture picture;
  GstBuffer *small = shrinker->shrink(frame, picture);
  if (small == nullptr) {
    GST_INFO_OBJECT(owner_, "frames are not shrunk any more: %s failed", name_of(shrinks_));
    shrinker_.reset();
    return {};
  }
  small = gst_buffer_make_writable(small);
  const ReadFrame::Window window = shrink_window(frame, small, picture);
  path_ = shrinks_;
  bytes_ += gst_buffer_get_size(small);
  return ReadFrame(picture, small, window);
}

std::optional<ReadFrame>
FrameReader::read(GstBuffer *frame, int halvings)
{
  if (auto small = shrink(frame, halvings))
    return small;
  path_ = known_ ? Path::mapped : Path::none;
  if (!known_)
    return {};
  return ReadFrame(SmallPicture{ .info = info_ }, gst_buffer_ref(frame));
}
