// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_part.h"
#include "translation.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

using visuotactile::Time;

namespace {

/// Without a frame for so long, a film has stalled.
constexpr guint kStalled = 15; // s, or up to twice as long

/// Looks for a stall until a part must have begun.
constexpr int kMostEmpty = 4;

constexpr Time kBefore = std::chrono::minutes(1);

} // namespace

FilmPart::FilmPart(const Film &film, const AnalysisSettings &settings, Span span, Events events,
                   const std::string &more)
    : span_(span), start_(film.start.stream), events_(std::move(events)),
      has_sought_(span.begin == Time(0) && span.end == Time(0)), position_(span.begin.count()),
      pipeline_(make_analysis(film_source(film), settings, more))
{
  const Owned<GstElement> sink = element(pipeline_, "maps");
  GstAppSinkCallbacks callbacks{};
  callbacks.new_sample = [](GstAppSink *maps, gpointer self) {
    return static_cast<FilmPart *>(self)->on_map(maps);
  };
  gst_app_sink_set_callbacks(GST_APP_SINK(sink.get()), &callbacks, this, nullptr);
}

void
FilmPart::start()
{
  const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
  watch_ = gst_bus_add_watch(
      bus.get(),
      +[](GstBus *, GstMessage *message, gpointer self) {
        return static_cast<FilmPart *>(self)->on_message(message);
      },
      this);
  if (gst_element_set_state(pipeline_.get(), has_sought_ ? GST_STATE_PLAYING : GST_STATE_PAUSED)
      == GST_STATE_CHANGE_FAILURE) {
    stop();
    throw std::runtime_error(_("it cannot be played"));
  }
  stall_ = g_timeout_add_seconds(
      kStalled, +[](gpointer self) { return static_cast<FilmPart *>(self)->look_for_stall(); },
      this);
}

FilmPart::~FilmPart()
{
  stop();
}

void
FilmPart::stop()
{
  for (guint *source : { &watch_, &stall_ })
    if (*source != 0)
      g_source_remove(std::exchange(*source, 0));
  pipeline_.reset();
}

/// To the key frame before the part.
bool
FilmPart::seek()
{
  const Time from = start_ + std::max(span_.begin - kBefore, Time(0));
  return gst_element_seek(pipeline_.get(), 1, GST_FORMAT_TIME,
                          static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_KEY_UNIT),
                          GST_SEEK_TYPE_SET, from.count(),
                          span_.end > Time(0) ? GST_SEEK_TYPE_SET : GST_SEEK_TYPE_NONE,
                          span_.end > Time(0) ? (start_ + span_.end).count() : -1)
             != FALSE
         && gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE;
}

/// On the streaming thread.
GstFlowReturn
FilmPart::on_map(GstAppSink *maps)
{
  GstSample *sample = gst_app_sink_pull_sample(maps);
  if (!sample)
    return GST_FLOW_EOS;
  frames_++;
  GstFlowReturn flow = GST_FLOW_OK;
  if (std::optional<FilmMap> map = film_map(sample, start_)) {
    if (!first_)
      first_ = map->begin;
    advances_ = advances_ || map->begin > *first_;
    position_ = std::max(map->end.count(), position_.load());
    if (map->begin >= span_.begin && (span_.end == Time(0) || map->begin < span_.end)) {
      if (const auto taken = events_.analyzed(*std::move(map)); !taken) {
        GST_ELEMENT_ERROR(GST_ELEMENT(maps), STREAM, FAILED, ("%s", taken.error().text().c_str()),
                          (nullptr));
        flow = GST_FLOW_ERROR;
      }
    }
  }
  gst_sample_unref(sample);
  return flow;
}

/// GStreamer 1.22 comes to no end of some films, such as short animations. Sound may be longer than
/// the picture.
gboolean
FilmPart::look_for_stall()
{
  gint64 at = 0;
  if (gst_element_query_position(pipeline_.get(), GST_FORMAT_TIME, &at)
      && std::exchange(reached_, at) != at)
    return G_SOURCE_CONTINUE;
  const std::size_t frames = frames_;
  const bool begins = frames == 0 && (span_.begin == Time(0) || ++empty_looks_ < kMostEmpty);
  if (begins || (frames > 0 && std::exchange(seen_, frames) != frames))
    return G_SOURCE_CONTINUE;
  const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
  g_autoptr(GError) error = g_error_new(GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
                                        "nothing comes after %" G_GSIZE_FORMAT
                                        " frames, nor the film's end; ffmpeg may convert it",
                                        frames);
  gst_bus_post(bus.get(), gst_message_new_error(GST_OBJECT(pipeline_.get()), error, nullptr));
  return G_SOURCE_CONTINUE;
}

gboolean
FilmPart::on_message(GstMessage *message)
{
  std::string failure;
  switch (GST_MESSAGE_TYPE(message)) {
  case GST_MESSAGE_ERROR: {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    failure = error->message;
    break;
  }
  case GST_MESSAGE_ASYNC_DONE:
    if (std::exchange(has_sought_, true) || seek())
      return G_SOURCE_CONTINUE;
    failure = "a part of it cannot be read: expected a film that can seek, or --parts=1";
    break;
  case GST_MESSAGE_EOS:
    break;
  default:
    return G_SOURCE_CONTINUE;
  }
  gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
  // The picture may end before the film does.
  if (failure.empty() && frames_ == 0 && span_.begin == Time(0))
    failure = "no frame can be decoded";
  else if (failure.empty()
           && ((span_.begin == Time(0) && position_.load() == 0) || (frames_ > 1 && !advances_)))
    failure = "the times of its " + std::to_string(frames_)
              + " frames do not advance: expected a film whose container or decoder has them; "
                "ffmpeg may convert it";
  watch_ = 0; // removed by the result
  if (stall_ != 0)
    g_source_remove(std::exchange(stall_, 0));
  events_.finished(failure);
  return G_SOURCE_REMOVE;
}
