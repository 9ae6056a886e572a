// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What happens inside the stream, on the network and on two threads at once.
#include "chaos.h"

using std::chrono::milliseconds;

void
Chaos::once(GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int), int value)
{
  GstPad *pad = stage_->upstream_pad();
  if (!pad) // the branch was removed
    return;
  forget_probe();
  once_.act = act;
  once_.value = value;
  once_.is_done = false;
  once_.id = gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad *pad, GstPadProbeInfo *info, gpointer data) {
        auto &once = *static_cast<Once *>(data);
        return once.is_done.exchange(true) ? GST_PAD_PROBE_OK : once.act(pad, info, once.value);
      },
      &once_, nullptr);
  once_.pad = pad;
}

void
Chaos::forget_probe()
{
  if (!once_.pad)
    return;
  once_.is_done = true;
  gst_pad_remove_probe(once_.pad, once_.id);
  gst_clear_object(&once_.pad);
}

void
Chaos::flow_error()
{
  // Elements post an error when they fail; the branch beside a picture relies on it.
  if (Stage::is_beside(kind_))
    return;
  is_excused_ = true;
  once([](GstPad *pad, GstPadProbeInfo *info, int) {
    GstElement *element = gst_pad_get_parent_element(pad);
    GST_ELEMENT_FLOW_ERROR(element, GST_FLOW_ERROR);
    gst_object_unref(element);
    gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
    GST_PAD_PROBE_INFO_DATA(info) = nullptr;
    GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_ERROR;
    return GST_PAD_PROBE_HANDLED;
  });
}

void
Chaos::gap()
{
  once([](GstPad *pad, GstPadProbeInfo *info, int) {
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    if (GST_BUFFER_PTS_IS_VALID(buffer))
      gst_pad_push_event(pad,
                         gst_event_new_gap(GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer)));
    return GST_PAD_PROBE_DROP;
  });
}

void
Chaos::starve()
{
  once(
      [](GstPad *, GstPadProbeInfo *, int ms) {
        std::this_thread::sleep_for(milliseconds(ms));
        return GST_PAD_PROBE_OK;
      },
      pick(std::array<int, 3>{ 50, 300, 1500 }));
}

void
Chaos::cut_branch()
{
  if (!stage_->branch || is_cut_ || is_broken_)
    return;
  GstPad *sink = gst_element_get_static_pad(stage_->branch, "sink");
  extractor_ = gst_pad_get_peer(sink);
  gst_pad_unlink(extractor_, sink);
  gst_object_unref(sink);
  // The sink first, which ends its waits.
  for (GstElement *each : { stage_->tactors, stage_->branch }) {
    gst_bin_remove(GST_BIN(stage_->pipeline), each);
    gst_element_set_state(each, GST_STATE_NULL);
  }
  is_cut_ = true;
  witness().expect_silence("when the branch was taken away");
}

void
Chaos::mend_branch()
{
  // While paused, a new sink waits for a map that does not come, because the shown branch blocks.
  // After EOS it gets no event.
  if (!is_cut_ || is_broken_ || state_ != GST_STATE_PLAYING || !boards_are_well()
      || stage_->is_at_end())
    return;
  join_branch(true);
  // A pipeline (1.22) that is paused while an added element prerolls believes that it is paused
  // already, and its elements play on.
  await([this] {
    return gst_element_get_state(stage_->pipeline, nullptr, nullptr, 0) != GST_STATE_CHANGE_ASYNC
           || has_ended_ || stage_->is_at_end();
  });
}

void
Chaos::restore_branch()
{
  if (is_cut_)
    join_branch(false);
}

void
Chaos::join_branch(bool sync)
{
  gst_bin_add_many(GST_BIN(stage_->pipeline), stage_->branch, stage_->tactors, nullptr);
  gst_element_link(stage_->branch, stage_->tactors);
  if (sync) {
    gst_element_sync_state_with_parent(stage_->tactors);
    gst_element_sync_state_with_parent(stage_->branch);
  }
  GstPad *sink = gst_element_get_static_pad(stage_->branch, "sink");
  gst_pad_link(extractor_, sink);
  gst_object_unref(sink);
  gst_clear_object(&extractor_);
  is_cut_ = false;
}

void
Chaos::disturb_network()
{
  if (!stage_->source)
    return;
  switch (dice(4)) {
  case 0:
    gst_element_set_state(stage_->source, GST_STATE_PAUSED);
    std::this_thread::sleep_for(milliseconds(dice(200)));
    gst_element_set_state(stage_->source, GST_STATE_PLAYING);
    break;
  case 1:
    gst_element_set_state(stage_->source, GST_STATE_NULL);
    gst_element_set_state(stage_->source, GST_STATE_PLAYING);
    break;
  default: {
    // Garbage, lost and duplicate packets.
    GstElement *out = gst_bin_get_by_name(GST_BIN(stage_->source), "out");
    GstPad *pad = gst_element_get_static_pad(out, "sink");
    const int mode = dice(3);
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad *pad, GstPadProbeInfo *info, gpointer data) {
          gst_pad_remove_probe(pad, GST_PAD_PROBE_INFO_ID(info));
          if (GPOINTER_TO_INT(data) == 0)
            return GST_PAD_PROBE_DROP;
          GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
          if (GPOINTER_TO_INT(data) == 1) {
            buffer = gst_buffer_make_writable(buffer);
            GstMapInfo map;
            if (gst_buffer_map(buffer, &map, GST_MAP_WRITE)) {
              for (gsize i = 12; i < map.size; i++)
                map.data[i] = static_cast<guint8>(map.data[i] * 31 + i);
              gst_buffer_unmap(buffer, &map);
            }
            GST_PAD_PROBE_INFO_DATA(info) = buffer;
            return GST_PAD_PROBE_OK;
          }
          gst_pad_push(pad, gst_buffer_ref(buffer));
          return GST_PAD_PROBE_OK;
        },
        GINT_TO_POINTER(mode == 2 ? 0 : mode), nullptr);
    gst_object_unref(pad);
    gst_object_unref(out);
    is_excused_ = is_excused_ || mode == 1;
    break;
  }
  }
}

/* ---- two threads ---- */

void
Chaos::two_at_once()
{
  using Act = void (Chaos::*)();
  static constexpr std::array<Act, 6> kOthers{ &Chaos::query_often,   &Chaos::pull_and_plug,
                                               &Chaos::latency_often, &Chaos::mute_often,
                                               &Chaos::eos_inside,    &Chaos::seek_inside };
  const Act other = pick(kOthers);
  std::thread thread([&] { (this->*other)(); });
  switch (dice(stage_->is_seekable() ? 4 : 3)) {
  case 0:
    pause();
    break;
  case 1:
    if (!is_broken_)
      set_state(GST_STATE_PLAYING);
    break;
  case 2:
    set_state(GST_STATE_READY);
    break;
  default:
    seek();
    break;
  }
  thread.join();
  if (is_muted_)
    witness().expect_silence("when muted meanwhile");
  if (state_ < GST_STATE_PLAYING)
    witness().expect_silence("when not playing any more");
}

void
Chaos::query_often()
{
  for (int i = 0; i < 20; i++)
    query();
}

void
Chaos::pull_and_plug()
{
  is_excused_ = true;
  if (witness().mega.is_plugged) {
    witness().sockets.unplug(witness().mega);
    witness().sockets.plug(witness().mega);
  }
}

void
Chaos::latency_often()
{
  for (int i = 0; i < 5; i++)
    gst_bin_recalculate_latency(GST_BIN(stage_->pipeline));
}

void
Chaos::mute_often()
{
  for (int i = 0; i < 6; i++)
    g_object_set(stage_->tactors, "mute", static_cast<gboolean>(i % 2 == 0), nullptr);
  g_object_set(stage_->tactors, "mute", static_cast<gboolean>(is_muted_), nullptr);
}

void
Chaos::eos_inside()
{
  if (can_end())
    gst_element_send_event(stage_->pipeline, gst_event_new_eos());
}

void
Chaos::seek_inside()
{
  if (has_prerolled_ && stage_->is_seekable())
    gst_element_seek_simple(stage_->pipeline, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                            kFilmLength / 3);
}
