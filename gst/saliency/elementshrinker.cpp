// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elementshrinker.h"

#include "gst/video/writable_frame.h"

#include <string>
#include <utility>

namespace {

/// The element that takes memory of a caps feature, and the memory between two halvings.
struct Scaler
{
  const char *feature;
  const char *element;
  const char *between;
};
constexpr Scaler kScalers[] = {
  { "memory:VAMemory", "vapostproc", "memory:VAMemory" },
  { "memory:DMABuf", "vapostproc", "memory:VAMemory" },
  { "memory:VASurface", "vaapipostproc", "memory:VASurface" },
};

/// The format that is read: two planes in 4:2:0.
constexpr const char *kRead = "NV12";

struct Size
{
  gint width = 0;
  gint height = 0;
};

class ElementShrinker : public FrameShrinker
{
public:
  ElementShrinker(GstElement *owner, GstCaps *caps, const Size &frame, GstElement *scalers)
      : owner_(owner), caps_(gst_caps_ref(caps)), frame_(frame), scalers_(scalers),
        entrance_(gst_pad_new("entrance", GST_PAD_SRC)), exit_(gst_pad_new("exit", GST_PAD_SINK))
  {
    gst_object_ref_sink(scalers_);
    gst_object_ref_sink(entrance_);
    gst_object_ref_sink(exit_);
    gst_pad_set_element_private(entrance_, owner_);
    gst_pad_set_query_function(entrance_, ask_neighbors);
    gst_pad_set_element_private(exit_, this);
    gst_pad_set_chain_function(exit_, take);
    // The pipeline answers which display to use; the frames report an error.
    g_autoptr(GstBus) bus = gst_bus_new();
    gst_bus_set_sync_handler(bus, hand_on, owner_, nullptr);
    gst_element_set_bus(scalers_, bus);
  }
  ~ElementShrinker() override
  {
    gst_element_set_state(scalers_, GST_STATE_NULL);
    gst_element_set_bus(scalers_, nullptr);
    gst_pad_set_active(entrance_, FALSE);
    gst_pad_set_active(exit_, FALSE);
    drop();
    gst_object_unref(scalers_);
    gst_object_unref(entrance_);
    gst_object_unref(exit_);
    gst_caps_unref(caps_);
  }
  ElementShrinker(const ElementShrinker &) = delete;
  ElementShrinker &operator=(const ElementShrinker &) = delete;

  /// False if the elements cannot be used.
  bool start()
  {
    g_autoptr(GstPad) first = gst_element_get_static_pad(scalers_, "sink");
    g_autoptr(GstPad) last = gst_element_get_static_pad(scalers_, "src");
    // The pads have no parent in common.
    if (!first || !last
        || gst_pad_link_full(entrance_, first, GST_PAD_LINK_CHECK_NOTHING) != GST_PAD_LINK_OK
        || gst_pad_link_full(last, exit_, GST_PAD_LINK_CHECK_NOTHING) != GST_PAD_LINK_OK)
      return false;
    gst_pad_set_active(exit_, TRUE);
    if (gst_element_set_state(scalers_, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE)
      return false;
    gst_pad_set_active(entrance_, TRUE);
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    return gst_pad_push_event(entrance_, gst_event_new_stream_start("shrinker"))
           && gst_pad_push_event(entrance_, gst_event_new_caps(caps_))
           && gst_pad_push_event(entrance_, gst_event_new_segment(&segment));
  }

  GstBuffer *shrink(GstBuffer *frame, SmallPicture &picture) override
  {
    drop();
    if (gst_pad_push(entrance_, without_crop(frame)) != GST_FLOW_OK || taken_ == nullptr)
      return nullptr;
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(exit_);
    if (caps == nullptr || !gst_video_info_from_caps(&picture.info, caps))
      return nullptr;
    picture.placement = { static_cast<double>(picture.info.width) / frame_.width,
                          static_cast<double>(picture.info.height) / frame_.height };
    picture.frame_width = frame_.width;
    picture.frame_height = frame_.height;
    return std::exchange(taken_, nullptr);
  }

private:
  /// The whole frame: scalers would scale its GstVideoCropMeta's window alone. Transfer full.
  static GstBuffer *without_crop(GstBuffer *frame)
  {
    gst_buffer_ref(frame);
    if (gst_buffer_get_video_crop_meta(frame) == nullptr)
      return frame;
    frame = writable_frame(frame);
    gst_buffer_remove_meta(frame, &gst_buffer_get_video_crop_meta(frame)->meta);
    return frame;
  }
  void drop()
  {
    if (GstBuffer *dropped = std::exchange(taken_, nullptr))
      gst_buffer_unref(dropped);
  }
  static GstFlowReturn take(GstPad *pad, GstObject *, GstBuffer *small)
  {
    auto *self = static_cast<ElementShrinker *>(gst_pad_get_element_private(pad));
    self->drop();
    self->taken_ = small;
    return GST_FLOW_OK;
  }
  static gboolean ask_neighbors(GstPad *pad, GstObject *parent, GstQuery *query)
  {
    if (GST_QUERY_TYPE(query) != GST_QUERY_CONTEXT)
      return gst_pad_query_default(pad, parent, query);
    auto *owner = static_cast<GstElement *>(gst_pad_get_element_private(pad));
    g_autoptr(GstPad) sink = gst_element_get_static_pad(owner, "sink");
    return sink && gst_pad_peer_query(sink, query);
  }
  static GstBusSyncReply hand_on(GstBus *, GstMessage *message, gpointer owner)
  {
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_NEED_CONTEXT
        || GST_MESSAGE_TYPE(message) == GST_MESSAGE_HAVE_CONTEXT)
      gst_element_post_message(GST_ELEMENT(owner), message);
    else
      gst_message_unref(message);
    return GST_BUS_DROP;
  }

  GstElement *owner_;
  GstCaps *caps_;
  const Size frame_;
  GstElement *scalers_;
  GstPad *entrance_;
  GstPad *exit_;
  GstBuffer *taken_ = nullptr; ///< the last picture, until shrink() returns it
};

std::string
size_caps(const Size &size)
{
  return ",width=" + std::to_string(size.width) + ",height=" + std::to_string(size.height);
}

/// A scaler for each halving: from one to the next they only average neighbors. The last one writes
/// to memory.
GstElement *
make_scalers(const Scaler &scaler, Size size, int halvings)
{
  std::string line = scaler.element;
  for (int n = 1; n < halvings; n++) {
    size = { (size.width + 1) / 2, (size.height + 1) / 2 };
    line += " ! video/x-raw(" + std::string(scaler.between) + ")" + size_caps(size) + " ! "
            + scaler.element;
  }
  if (halvings > 0)
    size = { (size.width + 1) / 2, (size.height + 1) / 2 };
  line += std::string(" ! capsfilter caps=video/x-raw,format=") + kRead + size_caps(size);
  return gst_parse_bin_from_description_full(line.c_str(), TRUE, nullptr,
                                             GST_PARSE_FLAG_FATAL_ERRORS, nullptr);
}

} // namespace

std::unique_ptr<FrameShrinker>
make_element_shrinker(GstElement *owner, GstCaps *caps, int halvings)
{
  const GstStructure *format = gst_caps_get_structure(caps, 0);
  Size size;
  if (!gst_structure_get_int(format, "width", &size.width)
      || !gst_structure_get_int(format, "height", &size.height))
    return nullptr;
  const GstCapsFeatures *features = gst_caps_get_features(caps, 0);
  for (const Scaler &scaler : kScalers) {
    if (!gst_caps_features_contains(features, scaler.feature))
      continue;
    GstElement *scalers = make_scalers(scaler, size, halvings);
    if (scalers == nullptr)
      continue;
    auto shrinker = std::make_unique<ElementShrinker>(owner, caps, size, scalers);
    if (shrinker->start())
      return shrinker;
  }
  return nullptr;
}
