// SPDX-License-Identifier: LGPL-2.1-or-later
#include "proxy.h"

#include "film/sound.h"
#include "web/soup.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace {

constexpr int kWidest = 854; ///< pixels
constexpr const char *kQueue = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=3000000000";

std::string
launch_line(const Film &film)
{
  const int width = std::min(film.width, kWidest) / 2 * 2;
  const int height = film.width > 0 ? (film.height * width / film.width + 1) / 2 * 2 : 480;
  std::string line = film_source(film)
                     + " webmmux name=mux streamable=true ! appsink name=out "
                       "sync=false max-buffers=16 film. ! "
                     + kQueue + " ! videoconvert ! videoscale ! video/x-raw,width="
                     + std::to_string(width) + ",height=" + std::to_string(height)
                     + ",pixel-aspect-ratio=1/1 ! vp8enc deadline=1 cpu-used=8 threads=2 "
                       "target-bitrate=1500000 keyframe-max-dist=60 ! "
                     + kQueue + " ! mux.";
  if (film.has_sound)
    line += heard_sound(kQueue, nullptr) + "audioresample ! audio/x-raw,channels=2 ! opusenc ! "
            + kQueue + " ! mux.";
  return line;
}

} // namespace

/// An answer while it is converted and sent.
class Proxies::Stream
{
public:
  /// Throws std::runtime_error if it cannot be made; start() does if it cannot be played.
  Stream(const Film &film, SoupServerMessage *message, GstClockTime from)
      : message_(SOUP_SERVER_MESSAGE(g_object_ref(message))),
        from_(from + static_cast<GstClockTime>(film.start.stream.count())),
        has_sound_(film.has_sound), pipeline_(make_pipeline(launch_line(film))),
        film_(element(pipeline_, "film")), out_(element(pipeline_, "out"))
  {
    handlers_ = {
      g_signal_connect(message_, "wrote-chunk", G_CALLBACK(+[](SoupServerMessage *, gpointer self) {
                         static_cast<Stream *>(self)->send();
                       }),
                       this),
      g_signal_connect(message_, "finished", G_CALLBACK(+[](SoupServerMessage *, gpointer self) {
                         static_cast<Stream *>(self)->end();
                       }),
                       this)
    };
    GstAppSinkCallbacks callbacks{};
    callbacks.new_sample = [](GstAppSink *, gpointer self) {
      static_cast<Stream *>(self)->wake();
      return GST_FLOW_OK;
    };
    callbacks.eos = [](GstAppSink *, gpointer self) {
      static_cast<Stream *>(self)->wake();
    };
    gst_app_sink_set_callbacks(GST_APP_SINK(out_.get()), &callbacks, this, nullptr);
    if (from_ > 0)
      g_signal_connect(film_.get(), "pad-added",
                       G_CALLBACK(+[](GstElement *, GstPad *pad, gpointer self) {
                         static_cast<Stream *>(self)->hold(pad);
                       }),
                       this);
    g_signal_connect(film_.get(), "no-more-pads", G_CALLBACK(+[](GstElement *, gpointer self) {
                       static_cast<Stream *>(self)->all_pads_are_there();
                     }),
                     this);
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    watch_ = gst_bus_add_watch(
        bus.get(),
        +[](GstBus *, GstMessage *of, gpointer self) -> gboolean {
          if (GST_MESSAGE_TYPE(of) == GST_MESSAGE_ERROR)
            static_cast<Stream *>(self)->cut();
          return G_SOURCE_CONTINUE;
        },
        this);
  }

  void start()
  {
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
      return;
    const std::string error
        = start_error(Owned<GstBus>(gst_element_get_bus(pipeline_.get())).get());
    end(); // the connection stays, for the answer
    throw std::runtime_error(error);
  }

  ~Stream()
  {
    for (const gulong handler : handlers_)
      g_signal_handler_disconnect(message_, handler);
    if (!is_over_)
      cut();
    end();
    g_object_unref(message_);
  }
  Stream(const Stream &) = delete;
  Stream &operator=(const Stream &) = delete;

  bool is_over() const
  {
    return is_over_;
  }

private:
  struct Held
  {
    GstPad *pad; ///< a reference
    gulong probe;
  };

  /// On a streaming thread: encoders see nothing from before the requested time.
  void hold(GstPad *pad)
  {
    const std::lock_guard lock(mutex_);
    held_.push_back({ .pad = GST_PAD(gst_object_ref(pad)),
                      .probe = gst_pad_add_probe(
                          pad, GST_PAD_PROBE_TYPE_BLOCK_DOWNSTREAM,
                          [](GstPad *, GstPadProbeInfo *, gpointer) { return GST_PAD_PROBE_OK; },
                          nullptr, nullptr) });
  }

  /// On a streaming thread.
  void all_pads_are_there()
  {
    if (has_sound_)
      end_missing_sound(top_);
    if (from_ > 0)
      g_idle_add(
          +[](gpointer self) -> gboolean {
            static_cast<Stream *>(self)->seek();
            return G_SOURCE_REMOVE;
          },
          this);
  }

  void seek()
  {
    std::vector<Held> held;
    {
      const std::lock_guard lock(mutex_);
      held.swap(held_);
    }
    constexpr auto kFlags = static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE);
    if (!held.empty())
      gst_pad_send_event(held.front().pad,
                         gst_event_new_seek(1, GST_FORMAT_TIME, kFlags, GST_SEEK_TYPE_SET,
                                            static_cast<gint64>(from_), GST_SEEK_TYPE_NONE, -1));
    for (const Held &one : held) {
      gst_pad_remove_probe(one.pad, one.probe);
      gst_object_unref(one.pad);
    }
  }

  /// Cuts the connection, so that the client sees an incomplete answer.
  void cut()
  {
    g_socket_shutdown(soup_server_message_get_socket(message_), TRUE, TRUE, nullptr);
  }

  void end()
  {
    is_over_ = true;
    if (watch_ != 0)
      g_source_remove(watch_);
    watch_ = 0;
    out_.reset();
    film_.reset();
    pipeline_.reset(); // after that no thread calls
    while (g_source_remove_by_user_data(this)) {
    }
    for (const Held &one : held_)
      gst_object_unref(one.pad);
    held_.clear();
  }

  /// On a streaming thread.
  void wake()
  {
    if (is_woken_.exchange(true))
      return;
    g_idle_add(
        +[](gpointer data) -> gboolean {
          auto *self = static_cast<Stream *>(data);
          self->is_woken_ = false;
          if (!self->is_sending_)
            self->send();
          return G_SOURCE_REMOVE;
        },
        this);
  }

  /// Sends the data that is ready, and more after it was sent.
  void send()
  {
    is_sending_ = false;
    if (is_over_)
      return;
    SoupMessageBody *body = soup_server_message_get_response_body(message_);
    if (GstSample *sample = gst_app_sink_try_pull_sample(GST_APP_SINK(out_.get()), 0)) {
      GstMapInfo map;
      GstBuffer *buffer = gst_sample_get_buffer(sample);
      if (gst_buffer_map(buffer, &map, GST_MAP_READ)) {
        soup_message_body_append(body, SOUP_MEMORY_COPY, map.data, map.size);
        gst_buffer_unmap(buffer, &map);
        is_sending_ = true;
      }
      gst_sample_unref(sample);
    } else if (gst_app_sink_is_eos(GST_APP_SINK(out_.get()))) {
      soup_message_body_complete(body);
      is_sending_ = true;
    }
    if (is_sending_)
      soup_server_message_unpause(message_);
  }

  SoupServerMessage *message_; ///< a reference
  GstClockTime from_;          ///< stream time
  bool has_sound_;
  Pipeline pipeline_;
  GstElement *const top_ = pipeline_.get(); ///< also while that is stopped
  Owned<GstElement> film_;
  Owned<GstElement> out_;
  std::array<gulong, 2> handlers_{};
  guint watch_ = 0;
  std::mutex mutex_;
  std::vector<Held> held_;
  std::atomic<bool> is_woken_{ false };
  bool is_sending_ = false;
  bool is_over_ = false;
};

Proxies::Proxies(Film film) : film_(std::move(film))
{
}

Proxies::~Proxies() = default;

void
Proxies::answer(SoupServerMessage *message, GstClockTime from)
{
  streams_.remove_if([](const auto &stream) { return stream->is_over(); });
  while (streams_.size() >= kMost)
    streams_.pop_front();
  try {
    auto stream = std::make_unique<Stream>(film_, message, from);
    stream->start();
    streams_.push_back(std::move(stream));
  } catch (const std::runtime_error &error) {
    answer_error(message, 500, "the film cannot be converted: " + std::string(error.what()));
    return;
  }
  SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
  soup_server_message_set_status(message, 200, nullptr);
  soup_message_headers_set_content_type(headers, "video/webm", nullptr);
  soup_message_headers_set_encoding(headers, SOUP_ENCODING_CHUNKED);
  soup_message_body_set_accumulate(soup_server_message_get_response_body(message), FALSE);
}
