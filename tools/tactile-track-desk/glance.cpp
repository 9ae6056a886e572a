// SPDX-License-Identifier: LGPL-2.1-or-later
#include "glance.h"

#include "film/background.h"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <utility>

namespace {

/// Longest time for the glance.
constexpr guint kLongest = 3; // s

} // namespace

std::string
jpeg_of(GstSample *sample)
{
  g_autoptr(GstCaps) caps = gst_caps_new_empty_simple("image/jpeg");
  GstSample *jpeg = gst_video_convert_sample(sample, caps, 5 * GST_SECOND, nullptr);
  std::string bytes;
  if (jpeg == nullptr)
    return bytes;
  GstMapInfo map;
  if (gst_buffer_map(gst_sample_get_buffer(jpeg), &map, GST_MAP_READ)) {
    bytes.assign(reinterpret_cast<const char *>(map.data), map.size);
    gst_buffer_unmap(gst_sample_get_buffer(jpeg), &map);
  }
  gst_sample_unref(jpeg);
  return bytes;
}

std::string
small_pictures(int width, int height)
{
  return " ! videoscale add-borders=false ! videoconvert ! "
         "video/x-raw,format=RGB,pixel-aspect-ratio=1/1,width="
         + std::to_string(width) + ",height=" + std::to_string(height)
         + " ! appsink name=eye sync=false max-buffers=4";
}

Glance::Glance(const Film &film, int width, int height, gint64 every, Events events)
    : events_(std::move(events)), start_(film.start.stream.count()),
      pipeline_(make_pipeline(film_source(film) + " film." + small_pictures(width, height)))
{
  const auto count = static_cast<gint64>(film.duration / GST_MSECOND - 1) / every + 1;
  for (gint64 step = 1; step < 2 * count; step *= 2)
    for (gint64 i = count - 1; i > 0; i--)
      if (i % step == 0 && i % (2 * step) != 0)
        times_.push_back(i * every);
  times_.push_back(0);
  const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
  run_in_background(pipeline_.get());
  use_one_thread(pipeline_.get()); // with more, a decoder shows no frame until it has several
  decode_picture_only(pipeline_.get());
  watch_ = gst_bus_add_watch(
      bus.get(),
      +[](GstBus *, GstMessage *message, gpointer self) {
        return static_cast<Glance *>(self)->on_message(message);
      },
      this);
  limit_ = g_timeout_add_seconds(
      kLongest,
      +[](gpointer data) -> gboolean {
        auto *self = static_cast<Glance *>(data);
        self->limit_ = 0;
        self->stop();
        self->events_.done();
        return G_SOURCE_REMOVE;
      },
      this);
  gst_element_set_state(pipeline_.get(), GST_STATE_PAUSED); // an error is posted
}

Glance::~Glance()
{
  stop();
}

void
Glance::stop()
{
  for (guint *source : { &watch_, &limit_ })
    if (*source != 0)
      g_source_remove(std::exchange(*source, 0));
  pipeline_.reset();
}

gboolean
Glance::on_message(GstMessage *message)
{
  bool is_over = GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR
                 || GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
  if (!is_over && GST_MESSAGE_TYPE(message) != GST_MESSAGE_ASYNC_DONE)
    return G_SOURCE_CONTINUE;
  if (!is_over) {
    const Owned<GstElement> eye = element(pipeline_, "eye");
    if (GstSample *sample = gst_app_sink_try_pull_preroll(GST_APP_SINK(eye.get()), 0)) {
      events_.taken(times_.back(), jpeg_of(sample));
      gst_sample_unref(sample);
    }
    times_.pop_back();
    is_over = times_.empty()
              || !gst_element_seek_simple(
                  pipeline_.get(), GST_FORMAT_TIME,
                  static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_KEY_UNIT),
                  start_ + times_.back() * static_cast<gint64>(GST_MSECOND));
  }
  if (!is_over)
    return G_SOURCE_CONTINUE;
  watch_ = 0; // removed by the result
  stop();
  events_.done();
  return G_SOURCE_REMOVE;
}
