// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film with sound in playbin and playbin3, shown by visuotactilesink. After seeks, pauses and
// changes of rate, picture, sound and commands must match. Compared are running times: of frames
// and sound at their sinks, and of commands in the trace. No test depends on the machine's speed.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"
#include "trace.h"
#include <gst/base/gstbasesink.h>
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

using tactor::IssuedCommand;
using tactor::Time;

namespace {

constexpr GstClockTime kFilmLength = 8 * GST_SECOND;

/// Eight seconds of a moving ball, with a tone. Every frame is a key frame.
void
make_film(const std::string &path)
{
  const std::string line
      = "tactiletestsrc pattern=dynamic-motion num-buffers=240 ! "
        "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! jpegenc quality=95 ! "
        "matroskamux name=mux ! filesink location="
        + path
        + " audiotestsrc num-buffers=345 ! audio/x-raw,format=S16LE,rate=44100,channels=1 ! mux.";
  play_to_the_end(make_pipeline(line));
}

/// A buffer that passed a pad.
struct Arrival
{
  gint64 running = 0; ///< running time at which it is shown or heard
  gint64 film = 0;    ///< place in the film
  double rate = 1;
  std::vector<bool> felt; ///< cells with a level that a motor starts at
};

struct Watch
{
  std::mutex mutex;
  std::vector<Arrival> arrivals;

  static GstPadProbeReturn on_buffer(GstPad *pad, GstPadProbeInfo *info, gpointer user_data)
  {
    auto *self = static_cast<Watch *>(user_data);
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    GstEvent *event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    guint64 pts = GST_BUFFER_PTS(buffer);
    if (segment->rate < 0) // backwards, a frame is shown from its end on
      pts += GST_BUFFER_DURATION(buffer);
    Arrival arrival;
    arrival.running = static_cast<gint64>(
        gst_segment_to_running_time(segment, GST_FORMAT_TIME, MIN(pts, segment->stop)));
    arrival.film = static_cast<gint64>(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, pts));
    arrival.rate = segment->rate;
    const bool inside
        = gst_segment_clip(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer),
                           GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer), nullptr, nullptr);
    gst_event_unref(event);
    if (const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer))
      for (guint i = 0; i < meta->rows * meta->columns; i++)
        arrival.felt.push_back(meta->levels[i] > 0);
    std::lock_guard lock(self->mutex);
    if (inside)
      self->arrivals.push_back(arrival);
    return GST_PAD_PROBE_OK;
  }
};

/// A player of the film that writes a trace.
class Player
{
public:
  Player(const char *playbin, const std::string &film)
  {
    pipeline = gst_element_factory_make(playbin, nullptr);
    fail_unless(pipeline != nullptr);
    GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
    GstElement *screen = gst_element_factory_make("fakesink", nullptr);
    GstElement *speakers = gst_element_factory_make("fakesink", nullptr);
    g_object_set(screen, "sync", TRUE, nullptr);
    g_object_set(speakers, "sync", TRUE, nullptr);
    watch(screen, "sink", video);
    watch(speakers, "sink", audio);
    g_object_set(chair, "driver", "simulator", "trace-location", trace_file.path.c_str(), "rate",
                 0.0, "video-sink", screen, nullptr);
    // Each map gives commands, without limits.
    gst_child_proxy_set(GST_CHILD_PROXY(chair), "analysis::temporal", FALSE, "tactors::ramp-in",
                        guint64{ 0 }, "tactors::max-active", 0, "tactors::max-duty", 0.0,
                        "tactors::max-on-time", guint64{ 0 }, nullptr);
    g_autofree gchar *uri = gst_filename_to_uri(film.c_str(), nullptr);
    g_object_set(pipeline, "uri", uri, "video-sink", chair, "audio-sink", speakers, nullptr);
    // Watched before the screen, since a seek may fall between a command and its frame.
    g_autoptr(GstElement) analysis = gst_bin_get_by_name(GST_BIN(chair), "analysis");
    watch(analysis, "src", frames);
    tactors = GST_ELEMENT(gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "tactors"));
    bus = gst_element_get_bus(pipeline);
  }
  ~Player()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(bus);
    gst_object_unref(tactors);
    gst_object_unref(pipeline);
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void wait(const std::function<bool()> &done)
  {
    while (!done()) {
      g_autoptr(GstMessage) message
          = gst_bus_timed_pop_filtered(bus, 10 * GST_MSECOND, GST_MESSAGE_ERROR);
      fail_unless(message == nullptr);
    }
  }
  void wait_for_commands(guint64 count)
  {
    wait([this, until = actuation_stat_of(tactors, "issued") + count] {
      return actuation_stat_of(tactors, "issued") >= until;
    });
  }
  std::vector<IssuedCommand> trace()
  {
    return unwrap(tactor::read_command_trace(trace_file.path));
  }
  /// Both sinks and the tactors have the same latency.
  void assert_same_latency()
  {
    GstIterator *sinks = gst_bin_iterate_all_by_element_factory_name(GST_BIN(pipeline), "fakesink");
    GValue item = G_VALUE_INIT;
    guint count = 0;
    while (gst_iterator_next(sinks, &item) == GST_ITERATOR_OK) {
      ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(g_value_get_object(&item))),
                        gst_base_sink_get_latency(GST_BASE_SINK(tactors)));
      count++;
      g_value_reset(&item);
    }
    g_value_unset(&item);
    gst_iterator_free(sinks);
    ck_assert_uint_eq(count, 2);
  }

  Watch frames;
  Watch video;
  Watch audio;
  TemporaryFile trace_file;
  GstElement *pipeline;
  GstElement *tactors;
  GstBus *bus;

private:
  static void watch(GstElement *element, const char *pad_name, Watch &what)
  {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, pad_name);
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, Watch::on_buffer, &what, nullptr);
  }
};

/// Each command takes effect when a frame is shown that has this cell on, to the microsecond. Call
/// it when nothing plays.
void
assert_commands_are_the_frames(Player &player, guint at_least)
{
  constexpr gint64 kSame = 1000;
  guint checked = 0;
  for (const IssuedCommand &line : player.trace()) {
    if (is_unplanned(line) || line.command.volts == 0)
      continue;
    const gint64 effect = line.command.effect.count();
    const auto cell = static_cast<std::size_t>(line.command.tactor);
    // A flushing seek restarts running time, so several frames may have the same one.
    const bool shown = std::ranges::any_of(player.frames.arrivals, [&](const Arrival &frame) {
      return std::abs(frame.running - effect) <= kSame && cell < frame.felt.size()
             && frame.felt[cell];
    });
    fail_unless(shown, "tactor %d at %" G_GINT64_FORMAT " ns", line.command.tactor, effect);
    checked++;
  }
  fail_unless(checked >= at_least, "%u commands", checked);
}

/// Picture and sound of the same place in the film have the same running time at each rate. The
/// tolerance is 1.5 ms, as Matroska's timestamps are in milliseconds. Compared is stream time minus
/// rate × running time.
void
assert_sound_is_the_pictures(Player &player, const std::vector<double> &rates)
{
  constexpr double kSame = 1.5e6;
  for (const double rate : rates) {
    const auto offsets = [rate](const std::vector<Arrival> &arrivals) {
      std::vector<double> values;
      for (const Arrival &arrival : arrivals)
        if (arrival.rate == rate)
          values.push_back(static_cast<double>(arrival.film)
                           - rate * static_cast<double>(arrival.running));
      std::ranges::sort(values);
      return values;
    };
    const std::vector<double> seen = offsets(player.video.arrivals);
    const std::vector<double> heard = offsets(player.audio.arrivals);
    fail_if(seen.empty() || heard.empty());
    fail_unless(std::abs(seen.front() - heard.front()) < kSame,
                "rate %g: picture at %g ns, sound at %g ns", rate, seen.front(), heard.front());
    fail_unless(std::abs(seen.back() - heard.back()) < kSame);
  }
}

void
check_player(const char *playbin)
{
  const TemporaryFile film("", ".mkv");
  make_film(film.path);
  Player player(playbin, film.path);

  start_player(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(5);
  player.assert_same_latency();
  change_state(player.pipeline, GST_STATE_PAUSED);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(5);
  player.assert_same_latency();

  for (const double rate : { 2.0, 0.5, 1.0 }) {
    seek_exactly(player.pipeline, rate, 3 * GST_SECOND, kFilmLength);
    player.wait_for_commands(8);
    player.assert_same_latency();
  }
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, 1.0, 6 * GST_SECOND, 7 * GST_SECOND);
  change_state(player.pipeline, GST_STATE_PLAYING);
  wait_for_eos(player.pipeline);
  assert_commands_are_the_frames(player, 15);
  assert_sound_is_the_pictures(player, { 0.5, 2.0 });
  change_state(player.pipeline, GST_STATE_READY);
  assert_silent_at_end(player.trace());
}

} // namespace

CHECK_TEST(test_playbin)
{
  check_player("playbin");
}

CHECK_TEST(test_playbin3)
{
  check_player("playbin3");
}

/// The analysis as the player's video-filter, with any video sink.
CHECK_TEST(test_video_filter)
{
  const TemporaryFile film("", ".mkv");
  make_film(film.path);
  g_autofree gchar *uri = gst_filename_to_uri(film.path.c_str(), nullptr);
  for (const char *playbin : { "playbin", "playbin3" }) {
    GstElement *pipeline = gst_element_factory_make(playbin, nullptr);
    GstElement *screen = gst_element_factory_make("fakesink", nullptr);
    Watch shown;
    g_autoptr(GstPad) pad = gst_element_get_static_pad(screen, "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, Watch::on_buffer, &shown, nullptr);
    g_object_set(pipeline, "uri", uri, "video-sink", screen, "video-filter",
                 gst_element_factory_make("saliencytactile", nullptr), "audio-sink",
                 gst_element_factory_make("fakesink", nullptr), nullptr);
    start_player(pipeline, GST_STATE_PAUSED);
    gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    {
      std::lock_guard lock(shown.mutex);
      fail_if(shown.arrivals.empty());
      ck_assert_uint_eq(shown.arrivals.front().felt.size(), 9);
    }
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
}

CHECK_MAIN(players)
