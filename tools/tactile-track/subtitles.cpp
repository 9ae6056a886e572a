// SPDX-License-Identifier: LGPL-2.1-or-later
#include "subtitles.h"
#include "playback.h"

#include <gst/app/gstappsrc.h>

#include <chrono>
#include <cstring>
#include <deque>
#include <utility>

namespace {

struct Reading
{
  GstElement *pipeline;
  std::deque<Subtitles> found{}; ///< probes refer to them
};

/// Plain text for Matroska and MP4, which have no type for marked-up text: entities that a demuxer
/// made are undone, except where the text is styled.
GstBuffer *
plain_text(GstBuffer *buffer)
{
  GstMapInfo bytes;
  if (!gst_buffer_map(buffer, &bytes, GST_MAP_READ))
    return gst_buffer_ref(buffer);
  std::string text(reinterpret_cast<const char *>(bytes.data), bytes.size);
  gst_buffer_unmap(buffer, &bytes);
  const bool is_styled = text.find('<') != std::string::npos;
  for (const auto &[entity, character] :
       { std::pair{ "&lt;", "<" }, std::pair{ "&gt;", ">" }, std::pair{ "&apos;", "'" },
         std::pair{ "&#39;", "'" }, std::pair{ "&quot;", "\"" }, std::pair{ "&amp;", "&" } })
    for (std::size_t at = 0; !is_styled && (at = text.find(entity, at)) != std::string::npos; at++)
      text.replace(at, std::strlen(entity), character);
  GstBuffer *plain = gst_buffer_new_memdup(text.data(), text.size());
  gst_buffer_copy_into(plain, buffer, GST_BUFFER_COPY_TIMESTAMPS, 0, static_cast<gsize>(-1));
  return plain;
}

void
keep_cue(GstPad *pad, GstBuffer *buffer, Subtitles &subtitles)
{
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  const GstSegment *segment = nullptr;
  if (!event)
    return;
  gst_event_parse_segment(event, &segment);
  const GstClockTime time
      = gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  if (!GST_CLOCK_TIME_IS_VALID(time))
    return;
  const GstStructure *structure = gst_caps_get_structure(subtitles.caps.get(), 0);
  GstBuffer *cue = gst_structure_has_name(structure, "text/x-raw") ? plain_text(buffer)
                                                                   : gst_buffer_copy(buffer);
  GST_BUFFER_PTS(cue) = time;
  subtitles.cues.emplace_back(cue);
}

gboolean
keep_tags(GstPad *, GstEvent **event, gpointer data)
{
  auto &subtitles = *static_cast<Subtitles *>(data);
  GstTagList *tags = nullptr;
  if (GST_EVENT_TYPE(*event) == GST_EVENT_TAG)
    gst_event_parse_tag(*event, &tags);
  if (tags && gst_tag_list_get_scope(tags) == GST_TAG_SCOPE_STREAM)
    subtitles.tags.reset(gst_tag_list_merge(subtitles.tags.get(), tags, GST_TAG_MERGE_REPLACE));
  return TRUE;
}

GstPadProbeReturn
on_data(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  auto &subtitles = *static_cast<Subtitles *>(data);
  if (info->type & GST_PAD_PROBE_TYPE_BUFFER) {
    keep_cue(pad, GST_PAD_PROBE_INFO_BUFFER(info), subtitles);
  } else if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS) {
    // Sticky: they may have passed before the probe was there.
    gst_pad_sticky_events_foreach(pad, keep_tags, &subtitles);
  }
  return GST_PAD_PROBE_OK;
}

void
on_stream(GstElement *, GstPad *pad, gpointer data)
{
  auto *reading = static_cast<Reading *>(data);
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  if (!caps)
    caps = gst_pad_query_caps(pad, nullptr);
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  if (is_subtitles(structure)) {
    GstCaps *kept = gst_caps_copy(caps);
    if (gst_structure_has_name(structure, "text/x-raw"))
      gst_caps_set_simple(kept, "format", G_TYPE_STRING, "utf8", nullptr);
    Subtitles &subtitles = reading->found.emplace_back();
    subtitles.caps.reset(kept);
    subtitles.tags.reset(gst_tag_list_new_empty());
    gst_pad_add_probe(pad,
                      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER
                                                   | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
                      on_data, &subtitles, nullptr);
  }
  GstElement *nothing = gst_element_factory_make("fakesink", nullptr);
  g_object_set(nothing, "async", FALSE, "sync", FALSE, nullptr);
  gst_bin_add(GST_BIN(reading->pipeline), nothing);
  const Owned<GstPad> sink(gst_element_get_static_pad(nothing, "sink"));
  gst_pad_link(pad, sink.get());
  gst_element_sync_state_with_parent(nothing);
}

void
on_all_streams(GstElement *, gpointer data)
{
  auto *reading = static_cast<Reading *>(data);
  if (reading->found.empty())
    gst_element_post_message(reading->pipeline, gst_message_new_eos(GST_OBJECT(reading->pipeline)));
}

} // namespace

bool
is_subtitles(const GstStructure *structure)
{
  const std::string name = gst_structure_get_name(structure);
  return name == "text/x-raw" || name == "application/x-ass" || name == "application/x-ssa";
}

bool
read_subtitles(const std::string &path, GstClockTime duration, bool quiet,
               std::vector<Subtitles> &subtitles)
{
  const Pipeline pipeline
      = make_pipeline("filesrc location=" + launch_value(path) + " ! parsebin name=film");
  Reading reading{ .pipeline = pipeline.get() };
  const Owned<GstElement> film = element(pipeline, "film");
  // Without a parser: that would strip SSA's styles.
  g_signal_connect(film.get(), "autoplug-continue",
                   G_CALLBACK(+[](GstElement *, GstPad *, GstCaps *caps, gpointer) -> gboolean {
                     return !is_subtitles(gst_caps_get_structure(caps, 0));
                   }),
                   nullptr);
  g_signal_connect(film.get(), "pad-added", G_CALLBACK(on_stream), &reading);
  g_signal_connect(film.get(), "no-more-pads", G_CALLBACK(on_all_streams), &reading);
  const bool done = run_to_end(pipeline, duration, quiet);
  for (Subtitles &one : reading.found)
    subtitles.push_back(std::move(one));
  return done;
}

Preface::Preface(GstPad *pad, const GstTagList *tags)
{
  struct Sent
  {
    std::promise<void> past;
    std::unique_ptr<GstTagList, Subtitles::MiniUnref> tags;
  };
  auto *sent = new Sent;
  if (tags)
    sent->tags.reset(gst_tag_list_copy(tags));
  past_ = sent->past.get_future();
  gst_pad_add_probe(
      pad,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
      +[](GstPad *of, GstPadProbeInfo *info, gpointer data) {
        auto *before = static_cast<Sent *>(data);
        if (info->type & GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM
            && GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) != GST_EVENT_EOS)
          return GST_PAD_PROBE_OK;
        if (before->tags)
          gst_pad_push_event(of, gst_event_new_tag(before->tags.release()));
        before->past.set_value();
        return GST_PAD_PROBE_REMOVE;
      },
      sent, +[](gpointer data) { delete static_cast<Sent *>(data); });
}

void
Preface::wait()
{
  past_.wait_for(std::chrono::seconds(10));
}

bool
add_subtitles(GstElement *pipeline, GstElement *muxer, const Subtitles &subtitles)
{
  // An appsrc links to anything.
  GstPadTemplate *held = gst_element_get_pad_template(muxer, "subtitle_%u");
  if (!held || !gst_caps_can_intersect(GST_PAD_TEMPLATE_CAPS(held), subtitles.caps.get()))
    return false;
  GstElement *source = gst_element_factory_make("appsrc", nullptr);
  g_object_set(source, "caps", subtitles.caps.get(), "format", GST_FORMAT_TIME, "max-bytes",
               guint64{ 0 }, nullptr);
  gst_bin_add(GST_BIN(pipeline), source);
  if (!gst_element_link_pads(source, "src", muxer, "subtitle_%u")) {
    gst_bin_remove(GST_BIN(pipeline), source);
    return false;
  }
  const Owned<GstPad> pad(gst_element_get_static_pad(source, "src"));
  Preface preface(pad.get(), subtitles.tags.get());
  for (const auto &cue : subtitles.cues)
    gst_app_src_push_buffer(GST_APP_SRC(source), gst_buffer_ref(cue.get()));
  gst_app_src_end_of_stream(GST_APP_SRC(source));
  gst_element_sync_state_with_parent(source);
  preface.wait();
  return true;
}
