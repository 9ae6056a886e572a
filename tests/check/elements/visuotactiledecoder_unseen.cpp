// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A player cannot tell whether visuotactiledecoder decodes its film: the same steps give the same
// states, positions, frames and messages, in the same order. Compared in PAUSED and at the ends of
// films.
#include <fstream>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"

namespace {

constexpr const char *kPlaybins[] = { "playbin", "playbin3" };

/// What a player learns: a line for each message and each look.
using Report = std::vector<std::string>;

void
rank_decoder(guint rank)
{
  g_autoptr(GstPluginFeature) feature
      = gst_registry_lookup_feature(gst_registry_get(), "visuotactiledecoder");
  fail_unless(feature != nullptr);
  gst_plugin_feature_set_rank(feature, rank);
}

/// A moving ball, with a tone where `sound`.
void
make_film(const std::string &path, guint frames, bool sound)
{
  std::string line = "tactiletestsrc pattern=dynamic-motion num-buffers=" + std::to_string(frames)
                     + " ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! "
                       "jpegenc ! matroskamux name=mux ! filesink location="
                     + path;
  if (sound)
    line += " audiotestsrc samplesperbuffer=1470 num-buffers=" + std::to_string(frames)
            + " ! audio/x-raw,format=S16LE,rate=44100,channels=1 ! mux.";
  play_to_the_end(make_pipeline(line));
}

class Player
{
public:
  Player(const char *playbin, const std::string &film)
      : playbin_(gst_element_factory_make(playbin, "player")), bus_(gst_element_get_bus(playbin_)),
        screen_(gst_element_factory_make("fakesink", nullptr))
  {
    g_object_set(screen_, "sync", FALSE, nullptr);
    GstElement *speakers = gst_element_factory_make("fakesink", nullptr);
    g_object_set(speakers, "sync", FALSE, nullptr);
    g_object_set(playbin_, "video-sink", screen_, "audio-sink", speakers, nullptr);
    g_signal_connect(playbin_, "deep-element-added", G_CALLBACK(on_element), this);
    open(film);
  }
  ~Player()
  {
    gst_element_set_state(playbin_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(playbin_);
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void open(const std::string &film)
  {
    g_autofree gchar *uri = gst_filename_to_uri(film.c_str(), nullptr);
    g_object_set(playbin_, "uri", uri, nullptr);
  }
  void pause()
  {
    report.push_back("pause");
    start_player(playbin_, GST_STATE_PAUSED);
    hear_until(GST_MESSAGE_ASYNC_DONE);
    look();
  }
  void seek(double rate, GstClockTime start, GstClockTime stop)
  {
    report.push_back("seek");
    seek_exactly(playbin_, rate, start, stop);
    hear_until(GST_MESSAGE_ASYNC_DONE);
    look();
  }
  void step(guint frames)
  {
    report.push_back("step");
    gst_element_send_event(playbin_,
                           gst_event_new_step(GST_FORMAT_BUFFERS, frames, 1.0, TRUE, FALSE));
    hear_until(GST_MESSAGE_ASYNC_DONE);
    look();
  }
  void play_to_the_end()
  {
    report.push_back("play");
    gst_element_set_state(playbin_, GST_STATE_PLAYING);
    hear_until(GST_MESSAGE_EOS);
    change_state(playbin_, GST_STATE_PAUSED);
    hear_until(GST_MESSAGE_UNKNOWN);
  }
  /// As players do between two films.
  void stop()
  {
    report.push_back("stop");
    gst_element_set_state(playbin_, GST_STATE_READY);
    hear_until(GST_MESSAGE_UNKNOWN);
  }

  Report report;
  guint felt = 0; ///< decoders with a chair

private:
  static void on_element(GstBin *, GstBin *, GstElement *element, Player *self)
  {
    GstElementFactory *factory = gst_element_get_factory(element);
    if (factory == nullptr || !g_str_equal(GST_OBJECT_NAME(factory), "visuotactiledecoder"))
      return;
    gst_child_proxy_set(GST_CHILD_PROXY(element), "tactors::driver", "simulator", nullptr);
    self->felt++;
  }
  /// Messages of single elements, and those whose order is that of threads, are not compared.
  void hear(GstMessage *message)
  {
    switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_STREAM_STATUS:
    case GST_MESSAGE_LATENCY:
    case GST_MESSAGE_TAG:
    case GST_MESSAGE_ELEMENT:
    case GST_MESSAGE_QOS:
    case GST_MESSAGE_DURATION_CHANGED:
    case GST_MESSAGE_STEP_START:
      return;
    case GST_MESSAGE_STATE_CHANGED: {
      if (GST_MESSAGE_SRC(message) != GST_OBJECT(playbin_))
        return;
      GstState from = GST_STATE_NULL;
      GstState to = GST_STATE_NULL;
      gst_message_parse_state_changed(message, &from, &to, nullptr);
      report.push_back(std::string(gst_element_state_get_name(from)) + " to "
                       + gst_element_state_get_name(to));
      return;
    }
    default:
      report.push_back(GST_MESSAGE_TYPE_NAME(message));
    }
  }
  /// The state that follows a preroll is posted before ASYNC_DONE. UNKNOWN: what is there.
  void hear_until(GstMessageType last)
  {
    const GstClockTime wait = last == GST_MESSAGE_UNKNOWN ? 0 : GST_CLOCK_TIME_NONE;
    while (GstMessage *message = gst_bus_timed_pop(bus_, wait)) {
      const GstMessageType type = GST_MESSAGE_TYPE(message);
      fail_if(type == GST_MESSAGE_ERROR, "%s", Said(message).details.c_str());
      hear(message);
      gst_message_unref(message);
      if (type == last)
        break;
    }
  }
  void look()
  {
    GstState state = GST_STATE_NULL;
    gst_element_get_state(playbin_, &state, nullptr, GST_CLOCK_TIME_NONE);
    gint64 position = -1;
    gst_element_query_position(playbin_, GST_FORMAT_TIME, &position);
    GstSample *sample = nullptr;
    g_object_get(screen_, "last-sample", &sample, nullptr);
    fail_unless(sample != nullptr, "there is no frame in %s", gst_element_state_get_name(state));
    g_autofree gchar *caps = gst_caps_to_string(gst_sample_get_caps(sample));
    report.push_back(std::string(gst_element_state_get_name(state)) + " at "
                     + std::to_string(position) + ", the frame of "
                     + std::to_string(GST_BUFFER_PTS(gst_sample_get_buffer(sample))) + ", " + caps);
    gst_sample_unref(sample);
  }

  GstElement *playbin_;
  GstBus *bus_;
  GstElement *screen_;
};

/// The steps, with the decoder or without. Appends how many films were felt.
Report
report_of(const char *playbin, const std::string &film, const std::string &next, bool felt)
{
  rank_decoder(felt ? GST_RANK_PRIMARY + 1000 : GST_RANK_NONE);
  Player player(playbin, film);
  player.pause();
  player.seek(1, GST_SECOND, GST_CLOCK_TIME_NONE);
  player.step(3);
  player.seek(1, GST_SECOND / 3, GST_CLOCK_TIME_NONE);
  player.seek(2, GST_SECOND / 2, GST_CLOCK_TIME_NONE);
  player.seek(-1, 0, 3 * GST_SECOND / 2);
  player.play_to_the_end();
  player.seek(1, GST_SECOND, GST_CLOCK_TIME_NONE);
  player.play_to_the_end();
  player.stop();
  player.open(next);
  player.pause();
  player.play_to_the_end();
  player.stop();
  if (felt)
    ck_assert_uint_ge(player.felt, 2);
  else
    ck_assert_uint_eq(player.felt, 0);
  return player.report;
}

void
assert_alike(const char *playbin, bool sound)
{
  TemporaryFile film;
  TemporaryFile next;
  make_film(film.path, 60, sound);
  make_film(next.path, 30, sound);
  const Report plain = report_of(playbin, film.path, next.path, false);
  const Report felt = report_of(playbin, film.path, next.path, true);
  for (size_t i = 0; i < plain.size() || i < felt.size(); i++) {
    const std::string expected = i < plain.size() ? plain[i] : "nothing";
    const std::string got = i < felt.size() ? felt[i] : "nothing";
    fail_unless(got == expected, "line %zu: expected '%s', got '%s'", i, expected.c_str(),
                got.c_str());
  }
  ck_assert_uint_ge(plain.size(), 40);
}

} // namespace

CHECK_LOOP_TEST(test_with_sound, 0, G_N_ELEMENTS(kPlaybins))
{
  assert_alike(kPlaybins[__i__], true);
}

CHECK_LOOP_TEST(test_without_sound, 0, G_N_ELEMENTS(kPlaybins))
{
  assert_alike(kPlaybins[__i__], false);
}

CHECK_MAIN(visuotactiledecoder_unseen)
