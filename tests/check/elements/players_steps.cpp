// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When a film is sought and stepped through, playbin and playbin3 behave with visuotactilesink as
// with GStreamer's own sink: they flush as often, each step is a frame, and the sound stays with
// the picture.
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

constexpr gint64 kFrame = 40 * GST_MSECOND;
constexpr int kSteps = 20;

struct Container
{
  const char *suffix;
  const char *picture;
  const char *mux;
  const char *sound;
};

constexpr std::array kContainers{
  Container{ ".mkv", "jpegenc", "matroskamux", "vorbisenc" },
  Container{ ".mp4", "x264enc key-int-max=10 ! h264parse", "mp4mux", "avenc_aac ! aacparse" },
  Container{ ".ogg", "theoraenc keyframe-freq=10", "oggmux", "vorbisenc" },
  Container{ ".avi", "avenc_mpeg4 gop-size=10", "avimux", "lamemp3enc ! mpegaudioparse" },
};
constexpr std::array kPlayers{ "playbin", "playbin3" };

/// Three seconds with a tone.
void
make_film(const Container &container, const std::string &path)
{
  play_to_the_end(make_pipeline(
      std::string("videotestsrc num-buffers=75 pattern=ball ! "
                  "video/x-raw,format=I420,width=160,height=120,framerate=25/1 ! ")
      + container.picture + " ! queue ! " + container.mux + " name=mux ! filesink location=" + path
      + " audiotestsrc num-buffers=141 ! audio/x-raw,rate=48000,channels=1 ! " + container.sound
      + " ! queue ! mux."));
}

/// The results of three seeks and twenty steps.
struct Outcome
{
  int flushes = 0; ///< flush-starts at the video sink
  int sought = 0;  ///< seek events from the video sink
  std::vector<gint64> player;
  std::vector<gint64> picture;
  std::vector<gint64> sound;
  std::vector<int> done; ///< step-done messages after each step

  bool operator==(const Outcome &) const = default;
};

GstPadProbeReturn
count_event(GstPad *, GstPadProbeInfo *info, gpointer data)
{
  auto *outcome = static_cast<Outcome *>(data);
  const GstEventType type = GST_EVENT_TYPE(info->data);
  outcome->flushes += type == GST_EVENT_FLUSH_START;
  outcome->sought += type == GST_EVENT_SEEK;
  return GST_PAD_PROBE_OK;
}

gint64
position_of(GstElement *element)
{
  gint64 position = -1;
  fail_unless(gst_element_query_position(element, GST_FORMAT_TIME, &position));
  return position;
}

GstElement *
make_sink()
{
  GstElement *sink = gst_element_factory_make("fakesink", nullptr);
  g_object_set(sink, "sync", TRUE, nullptr);
  return sink;
}

/// Seeks and steps a paused film. `sink` is `screen` or contains it.
Outcome
seek_and_step(const char *playbin, const std::string &film, GstElement *sink, GstElement *screen)
{
  Outcome outcome;
  GstElement *player = gst_element_factory_make(playbin, nullptr);
  fail_unless(player != nullptr);
  GstElement *speakers = make_sink();
  g_autofree gchar *uri = gst_filename_to_uri(film.c_str(), nullptr);
  g_object_set(player, "uri", uri, "video-sink", sink, "audio-sink", speakers, nullptr);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  gst_pad_add_probe(
      pad,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_EVENT_BOTH | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
      count_event, &outcome, nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(player);

  start_player(player, GST_STATE_PAUSED);
  change_state(player, GST_STATE_PAUSED);
  for (const GstClockTime place : { 1000, 500, 0 }) {
    seek_exactly(player, 1.0, place * GST_MSECOND, GST_CLOCK_TIME_NONE);
    change_state(player, GST_STATE_PAUSED);
  }
  for (int i = 0; i < kSteps; i++) {
    fail_unless(gst_element_send_event(
        player, gst_event_new_step(GST_FORMAT_BUFFERS, 1, 1.0, TRUE, FALSE)));
    change_state(player, GST_STATE_PAUSED);
    outcome.player.push_back(position_of(player));
    outcome.picture.push_back(position_of(screen));
    outcome.sound.push_back(position_of(speakers));
    int done = 0;
    while (GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_STEP_DONE)) {
      gst_message_unref(message);
      done++;
    }
    outcome.done.push_back(done);
  }
  gst_element_set_state(player, GST_STATE_NULL);
  gst_object_unref(player);
  return outcome;
}

} // namespace

CHECK_LOOP_TEST(test_as_with_gstreamers_own_sink, 0, kContainers.size() * kPlayers.size())
{
  const Container &container = kContainers[static_cast<std::size_t>(__i__) % kContainers.size()];
  const char *playbin = kPlayers[static_cast<std::size_t>(__i__) / kContainers.size()];
  const TemporaryFile film("", container.suffix);
  make_film(container, film.path);

  GstElement *own = make_sink();
  const Outcome expected = seek_and_step(playbin, film.path, own, own);
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  GstElement *screen = make_sink();
  gst_util_set_object_arg(G_OBJECT(chair), "driver", "simulator");
  g_object_set(chair, "video-sink", screen, nullptr);
  const Outcome outcome = seek_and_step(playbin, film.path, chair, screen);

  const std::string what = std::string(playbin) + ", " + container.suffix;
  ck_assert_msg(outcome.flushes == expected.flushes && outcome.sought == expected.sought,
                "%s: %d flushes of %d seeks, GStreamer's own sink: %d of %d", what.c_str(),
                outcome.flushes, outcome.sought, expected.flushes, expected.sought);
  for (std::size_t i = 0; i < kSteps; i++) {
    const gint64 place = static_cast<gint64>(i + 1) * kFrame;
    ck_assert_msg(
        outcome.player[i] == place && outcome.picture[i] == place && outcome.sound[i] == place,
        "%s: after %d steps the player is at %d ms, the picture at %d, the sound at %d",
        what.c_str(), static_cast<int>(i + 1), static_cast<int>(outcome.player[i] / GST_MSECOND),
        static_cast<int>(outcome.picture[i] / GST_MSECOND),
        static_cast<int>(outcome.sound[i] / GST_MSECOND));
  }
  fail_unless(outcome == expected);
}

CHECK_MAIN(players_steps)
