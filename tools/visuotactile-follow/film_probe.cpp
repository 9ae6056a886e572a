// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_probe.h"

#include "gst/cues/cue_stream.h"
#include "translation.h"

#include <stdexcept>
#include <string_view>

using visuotactile::Time;

namespace {

constexpr GstClockTime kPatience = 10 * GST_SECOND;

/// Whether subtitles may be a track, which tactile-track mux names Tactile and gives the language
/// zxx. Of sparse ones tags are seldom seen in time: the first cue decides.
bool
may_be_track(GstDiscovererStreamInfo *stream)
{
  const GstTagList *tags = gst_discoverer_stream_info_get_tags(stream);
  const auto has_other = [tags](const char *tag, std::string_view expected) {
    g_autofree gchar *value = nullptr;
    return tags != nullptr && gst_tag_list_get_string(tags, tag, &value) && value != expected
           && value != std::string_view("und");
  };
  return !has_other(GST_TAG_TITLE, "Tactile") && !has_other(GST_TAG_LANGUAGE_CODE, "zxx");
}

bool
is_track(GstDiscovererStreamInfo *stream)
{
  g_autoptr(GstCaps) caps = gst_discoverer_stream_info_get_caps(stream);
  const std::optional<CueForm> form = cue_form_of(caps);
  return form && (form == CueForm::klv || may_be_track(stream));
}

} // namespace

FilmProbe::FilmProbe(const std::string &uri)
{
  g_autoptr(GError) error = nullptr;
  discoverer_.reset(gst_discoverer_new(kPatience, &error));
  if (!discoverer_)
    throw std::runtime_error(error->message);
  start_.emplace(discoverer_.get());
  g_signal_connect(discoverer_.get(), "discovered", G_CALLBACK(on_discovered), this);
  gst_discoverer_start(discoverer_.get());
  if (!gst_discoverer_discover_uri_async(discoverer_.get(), uri.c_str()))
    throw std::runtime_error(_("it cannot be opened"));
}

FilmProbe::~FilmProbe()
{
  g_signal_handlers_disconnect_by_data(discoverer_.get(), this);
  // gst_discoverer_stop() alone keeps the discoverer's lock while it stops the pipeline, whose pads
  // are then removed by a handler that waits for this lock. To dispose of it stops the pipeline
  // without the lock, and ends the timeout, which has a reference.
  g_object_run_dispose(G_OBJECT(discoverer_.get()));
}

void
FilmProbe::on_discovered(GstDiscoverer *, GstDiscovererInfo *info, GError *error, gpointer self)
{
  Result result;
  GList *streams = gst_discoverer_info_get_stream_list(info);
  for (const GList *item = streams; item != nullptr; item = item->next) {
    auto *stream = GST_DISCOVERER_STREAM_INFO(item->data);
    result.has_picture
        = result.has_picture
          || (GST_IS_DISCOVERER_VIDEO_INFO(stream)
              && !gst_discoverer_video_info_is_image(GST_DISCOVERER_VIDEO_INFO(stream)));
    result.has_sound = result.has_sound || GST_IS_DISCOVERER_AUDIO_INFO(stream);
    result.may_have_track = result.may_have_track || is_track(stream);
  }
  gst_discoverer_stream_info_list_free(streams);
  if (const GstClockTime duration = gst_discoverer_info_get_duration(info);
      GST_CLOCK_TIME_IS_VALID(duration) && duration > 0)
    result.duration = Time(static_cast<Time::rep>(duration));
  if (!result.has_picture)
    result.complaint = error != nullptr ? error->message : "it has no moving picture";
  auto *probe = static_cast<FilmProbe *>(self);
  result.start = probe->start_->times();
  probe->result_ = std::move(result);
}
