// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frametap.h"

FrameTap::FrameTap(GstPad *watched, GstPad *branch, PlayGate &gate, std::function<void()> changed)
    : gate_(gate), changed_(std::move(changed)), watched_(GST_PAD(gst_object_ref(watched))),
      pad_(gst_pad_new("tap", GST_PAD_SRC))
{
  gst_object_ref_sink(pad_);
  gst_pad_set_element_private(pad_, watched_);
  gst_pad_set_query_function(pad_, query);
  gst_pad_set_event_function(pad_, [](GstPad *, GstObject *, GstEvent *event) -> gboolean {
    gst_event_unref(event); // the picture's sinks send the same
    return TRUE;
  });
  // The pads have no parent in common.
  gst_pad_link_full(pad_, branch, GST_PAD_LINK_CHECK_NOTHING);
  probe_ = gst_pad_add_probe(watched_,
                             static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_DATA_DOWNSTREAM
                                                          | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                             probe, this, nullptr);
}

FrameTap::~FrameTap()
{
  gst_pad_remove_probe(watched_, probe_);
  if (GstPad *branch = gst_pad_get_peer(pad_)) {
    gst_pad_unlink(pad_, branch);
    gst_object_unref(branch);
  }
  gst_object_unref(pad_);
  gst_object_unref(watched_);
}

void
FrameTap::begin()
{
  ended_ = false;
  pixels_ = 0;
}

void
FrameTap::start()
{
  gst_pad_set_active(pad_, TRUE);
  shift_.flush();
  told_ = false;
  open_ = true;
}

void
FrameTap::stop()
{
  open_ = false;
  gst_pad_set_active(pad_, FALSE); // forgets the stream's events
}

void
FrameTap::hear(GstEvent *event)
{
  if (GST_EVENT_TYPE(event) == GST_EVENT_QOS)
    shift_.hear(event);
}

bool
FrameTap::ended() const
{
  return ended_;
}

gint64
FrameTap::pixels() const
{
  return pixels_;
}

/// The branch may query whether the stream is live, and nothing else.
gboolean
FrameTap::query(GstPad *pad, GstObject *, GstQuery *query)
{
  return GST_QUERY_TYPE(query) == GST_QUERY_LATENCY
         && gst_pad_peer_query(static_cast<GstPad *>(gst_pad_get_element_private(pad)), query);
}

/// Follows events, also while no frame passes.
void
FrameTap::follow(GstEvent *event)
{
  const GstEventType type = GST_EVENT_TYPE(event);
  if (type == GST_EVENT_EOS || type == GST_EVENT_STREAM_START || type == GST_EVENT_FLUSH_STOP) {
    ended_ = type == GST_EVENT_EOS;
    changed_();
  } else if (type == GST_EVENT_CAPS) {
    GstCaps *caps = nullptr;
    gint width = 0;
    gint height = 0;
    gst_event_parse_caps(event, &caps);
    gst_structure_get(gst_caps_get_structure(caps, 0), "width", G_TYPE_INT, &width, "height",
                      G_TYPE_INT, &height, nullptr);
    pixels_ = gint64{ width } * height;
    changed_();
  }
}

void
FrameTap::pass(GstEvent *event)
{
  const GstEventType type = GST_EVENT_TYPE(event);
  if ((gst_event_type_get_flags(type) & GST_EVENT_TYPE_SERIALIZED) && type != GST_EVENT_STREAM_START
      && type != GST_EVENT_FLUSH_STOP)
    catch_up();
  const GstSegment *segment = nullptr;
  switch (type) {
  case GST_EVENT_STREAM_START:
    told_ = true;
    shift_.start_stream(event);
    break;
  case GST_EVENT_FLUSH_STOP: {
    gate_.flush();
    gboolean resets_time = FALSE;
    gst_event_parse_flush_stop(event, &resets_time);
    if (resets_time)
      shift_.flush();
    break;
  }
  case GST_EVENT_SEGMENT: {
    gst_event_parse_segment(event, &segment);
    const GstSegment shifted = shift_.open(*segment);
    GstEvent *sent = gst_event_new_segment(&shifted);
    seqnum_ = gst_event_get_seqnum(event);
    gst_event_set_seqnum(sent, seqnum_);
    gst_pad_push_event(pad_, sent);
    return;
  }
  default:
    break;
  }
  gst_pad_push_event(pad_, gst_event_ref(event));
}

/// Sends the sticky events of a stream that began before start() to the branch.
void
FrameTap::catch_up()
{
  if (told_.exchange(true))
    return;
  gst_pad_sticky_events_foreach(
      watched_,
      [](GstPad *, GstEvent **event, gpointer tap) -> gboolean {
        static_cast<FrameTap *>(tap)->pass(*event);
        return TRUE;
      },
      this);
}

void
FrameTap::pass(GstBuffer *frame)
{
  catch_up();
  gate_.pass();
  if (shift_.pass(frame)) {
    const GstSegment segment = shift_.segment();
    GstEvent *sent = gst_event_new_segment(&segment);
    gst_event_set_seqnum(sent, seqnum_);
    gst_pad_push_event(pad_, sent);
  }
  gst_pad_push(pad_, gst_buffer_ref(frame));
}

GstPadProbeReturn
FrameTap::probe(GstPad *, GstPadProbeInfo *info, gpointer user_data)
{
  auto *self = static_cast<FrameTap *>(user_data);
  if (info->type & (GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM | GST_PAD_PROBE_TYPE_EVENT_FLUSH))
    self->follow(GST_PAD_PROBE_INFO_EVENT(info));
  if (!self->open_)
    return GST_PAD_PROBE_OK;
  if (info->type & GST_PAD_PROBE_TYPE_BUFFER)
    self->pass(GST_PAD_PROBE_INFO_BUFFER(info));
  else if (info->type & GST_PAD_PROBE_TYPE_BUFFER_LIST)
    gst_buffer_list_foreach(
        GST_PAD_PROBE_INFO_BUFFER_LIST(info),
        [](GstBuffer **frame, guint, gpointer tap) -> gboolean {
          static_cast<FrameTap *>(tap)->pass(*frame);
          return TRUE;
        },
        self);
  else
    self->pass(GST_PAD_PROBE_INFO_EVENT(info));
  return GST_PAD_PROBE_OK;
}
