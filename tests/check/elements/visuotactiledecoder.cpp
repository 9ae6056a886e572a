// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactiledecoder in playbin, playbin3 and in pipelines of its own. Compared are running times
// of frames at the player's sink and of commands in the trace, and what the sink gets with what it
// gets without the chair. No test depends on the machine's speed.
#include "tactor/command_trace.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"
#include "trace.h"
#include <gst/base/gstbasesink.h>
#include <gst/check/gstharness.h>

using tactor::IssuedCommand;

namespace {

constexpr GstClockTime kMs = GST_MSECOND;
constexpr const char *kPlaybins[] = { "playbin", "playbin3" };

void
rank_decoder(const char *name, guint rank)
{
  g_autoptr(GstPluginFeature) feature = gst_registry_lookup_feature(gst_registry_get(), name);
  fail_unless(feature != nullptr, "no %s", name);
  gst_plugin_feature_set_rank(feature, rank);
}

/// A moving ball with a tone. Every frame is a key frame.
void
make_film(const std::string &path, guint frames)
{
  const std::string line
      = "tactiletestsrc pattern=dynamic-motion num-buffers=" + std::to_string(frames)
        + " ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! "
          "jpegenc quality=95 ! matroskamux name=mux ! filesink location="
        + path + " audiotestsrc samplesperbuffer=1470 num-buffers=" + std::to_string(frames)
        + " ! audio/x-raw,format=S16LE,rate=44100,channels=1 ! mux.";
  play_to_the_end(make_pipeline(line));
}

/// A frame at the player's video sink.
struct Shown
{
  gint64 running = 0;
  GstClockTime pts = 0;
  GstClockTime duration = 0;
  std::string checksum;

  bool operator==(const Shown &) const = default;
};

/// A player with sinks of its own, which knows nothing of the chair.
class Player
{
public:
  Player(const char *playbin, const std::string &film, bool sync)
  {
    rank_decoder("visuotactiledecoder", GST_RANK_PRIMARY + 1000);
    pipeline = gst_element_factory_make(playbin, nullptr);
    GstElement *screen = gst_element_factory_make("fakesink", nullptr);
    GstElement *speakers = gst_element_factory_make("fakesink", nullptr);
    g_object_set(screen, "sync", sync, "qos", TRUE, nullptr);
    g_object_set(speakers, "sync", sync, nullptr);
    g_object_set(pipeline, "uri", uri_of(film).c_str(), "video-sink", screen, "audio-sink",
                 speakers, nullptr);
    g_signal_connect(pipeline, "deep-element-added", G_CALLBACK(on_element), this);
    g_signal_connect(pipeline, "about-to-finish", G_CALLBACK(on_finishing), this);
    g_autoptr(GstPad) pad = gst_element_get_static_pad(screen, "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_frame, this, nullptr);
    bus = gst_element_get_bus(pipeline);
  }
  ~Player()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    for (GstElement *decoder : decoders)
      gst_object_unref(decoder);
    gst_object_unref(bus);
    gst_object_unref(pipeline);
    rank_decoder("visuotactiledecoder", GST_RANK_NONE);
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void wait(const std::function<bool()> &done)
  {
    while (!done()) {
      g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
          bus, 10 * kMs,
          static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING | GST_MESSAGE_EOS));
      if (message == nullptr)
        continue;
      fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR, "%s", Said(message).details.c_str());
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
        ended = true;
      else
        warnings.push_back(Said(message).text);
    }
  }
  void play()
  {
    start_player(pipeline, GST_STATE_PLAYING);
  }
  void play_to_the_end()
  {
    play();
    wait([this] { return ended; });
  }
  void pause()
  {
    change_state(pipeline, GST_STATE_PAUSED);
  }
  guint64 issued()
  {
    std::lock_guard lock(mutex);
    return decoders.empty() ? 0 : actuation_stat_of(tactors(), "issued");
  }
  void wait_for_commands(guint64 count)
  {
    wait([this, until = issued() + count] { return issued() >= until; });
  }
  /// The last decoder's, to be read after the play.
  std::vector<IssuedCommand> trace()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    const std::vector<IssuedCommand> lines = unwrap(tactor::read_command_trace(trace_file.path));
    assert_silent_at_end(lines);
    return lines;
  }
  /// Without a lock: once there is one, it stays.
  GstElement *tactors()
  {
    GObject *child = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(decoders.back()), "tactors");
    g_object_unref(child); // the bin holds a reference
    return GST_ELEMENT(child);
  }
  /// Each command takes effect at a frame's time, to the microsecond. Frames are those of the
  /// decoder: a seek may fall between a command and its frame on the screen.
  void assert_commands_are_the_frames(guint at_least)
  {
    guint checked = 0;
    for (const IssuedCommand &line : trace()) {
      if (is_unplanned(line) || line.command.volts == 0)
        continue;
      const gint64 effect = line.command.effect.count();
      fail_unless(std::ranges::any_of(
                      decoded, [&](gint64 frame) { return std::abs(frame - effect) <= 1000; }),
                  "at %" G_GINT64_FORMAT " ns there is no frame", effect);
      checked++;
    }
    fail_unless(checked >= at_least, "%u commands", checked);
  }

  GstElement *pipeline;
  GstBus *bus;
  TemporaryFile trace_file;
  std::vector<std::string> next; ///< films of a gapless play
  std::string driver = "simulator";
  std::vector<std::string> warnings;
  std::vector<Shown> shown;    ///< to be read when nothing plays
  std::vector<gint64> decoded; ///< running times, likewise
  std::vector<GstElement *> decoders;
  bool ended = false;

private:
  static std::string uri_of(const std::string &film)
  {
    g_autofree gchar *uri = gst_filename_to_uri(film.c_str(), nullptr);
    return uri;
  }
  static void on_element(GstBin *, GstBin *, GstElement *element, Player *self)
  {
    GstElementFactory *factory = gst_element_get_factory(element);
    if (factory == nullptr || g_strcmp0(GST_OBJECT_NAME(factory), "visuotactiledecoder") != 0)
      return;
    // Each map gives commands, without limits.
    gst_child_proxy_set(GST_CHILD_PROXY(element), "tactors::driver", self->driver.c_str(),
                        "tactors::rate", 0.0, "tactors::ramp-in", guint64{ 0 },
                        "tactors::max-active", 0, "tactors::max-duty", 0.0, "tactors::max-on-time",
                        guint64{ 0 }, "tactors::trace-location", self->trace_file.path.c_str(),
                        "analysis::temporal", FALSE, nullptr);
    g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(element), "video-queue");
    g_autoptr(GstPad) pad = gst_element_get_static_pad(queue, "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_decoded, self, nullptr);
    std::lock_guard lock(self->mutex);
    self->decoders.push_back(GST_ELEMENT(gst_object_ref(element)));
  }
  static void on_finishing(GstElement *playbin, Player *self)
  {
    if (self->next.empty())
      return;
    g_object_set(playbin, "uri", uri_of(self->next.front()).c_str(), nullptr);
    self->next.erase(self->next.begin());
  }
  static gint64 running_time(GstPad *pad, GstBuffer *buffer)
  {
    g_autoptr(GstEvent) event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    return static_cast<gint64>(gst_segment_to_running_time(
        segment, GST_FORMAT_TIME, MAX(GST_BUFFER_PTS(buffer), segment->start)));
  }
  static GstPadProbeReturn on_decoded(GstPad *pad, GstPadProbeInfo *info, gpointer self)
  {
    static_cast<Player *>(self)->decoded.push_back(
        running_time(pad, GST_PAD_PROBE_INFO_BUFFER(info)));
    return GST_PAD_PROBE_OK;
  }
  static GstPadProbeReturn on_frame(GstPad *pad, GstPadProbeInfo *info, gpointer self)
  {
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_READ);
    g_autofree gchar *checksum = g_compute_checksum_for_data(G_CHECKSUM_MD5, map.data, map.size);
    gst_buffer_unmap(buffer, &map);
    static_cast<Player *>(self)->shown.push_back({ .running = running_time(pad, buffer),
                                                   .pts = GST_BUFFER_PTS(buffer),
                                                   .duration = GST_BUFFER_DURATION(buffer),
                                                   .checksum = checksum });
    return GST_PAD_PROBE_OK;
  }

  std::mutex mutex;
};

/// A decoder that is fed by hand.
GstHarness *
make_harness()
{
  GstHarness *harness = gst_harness_new("visuotactiledecoder");
  gst_child_proxy_set(GST_CHILD_PROXY(harness->element), "tactors::driver", "simulator", nullptr);
  return harness;
}

bool
accepts(GstElement *decoder, const char *text)
{
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  g_autoptr(GstCaps) caps = gst_caps_from_string(text);
  return gst_pad_query_accept_caps(pad, caps);
}

/// Factories of the elements that the bin decodes with, one after the other.
std::string
decoded_by(GstElement *decoder)
{
  std::string names;
  GstIterator *children = gst_bin_iterate_recurse(GST_BIN(decoder));
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(children, &item) == GST_ITERATOR_OK) {
    GstElementFactory *factory = gst_element_get_factory(GST_ELEMENT(g_value_get_object(&item)));
    if (factory
        && gst_element_factory_list_is_type(factory, GST_ELEMENT_FACTORY_TYPE_PARSER
                                                         | GST_ELEMENT_FACTORY_TYPE_DECODER))
      names += std::string(" ") + GST_OBJECT_NAME(factory);
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(children);
  return names;
}

} // namespace

/* ---- players ---- */

GST_START_TEST(test_a_player_is_felt)
{
  TemporaryFile film;
  make_film(film.path, 60);
  Player player(kPlaybins[__i__], film.path, true);
  player.play_to_the_end();
  ck_assert_uint_eq(player.decoders.size(), 1);
  fail_unless(player.warnings.empty(), "%s", player.warnings.front().c_str());
  ck_assert_uint_eq(player.shown.size(), 60);
  player.assert_commands_are_the_frames(5);
}
GST_END_TEST;

GST_START_TEST(test_the_picture_is_the_same)
{
  TemporaryFile film;
  make_film(film.path, 60);
  Player felt(kPlaybins[__i__], film.path, false);
  felt.play_to_the_end();
  gst_element_set_state(felt.pipeline, GST_STATE_NULL);
  ck_assert_uint_eq(felt.decoders.size(), 1);
  Player plain(kPlaybins[__i__], film.path, false);
  rank_decoder("visuotactiledecoder", GST_RANK_NONE);
  plain.play_to_the_end();
  gst_element_set_state(plain.pipeline, GST_STATE_NULL);
  ck_assert_uint_eq(plain.decoders.size(), 0);
  ck_assert_uint_eq(plain.shown.size(), 60);
  fail_unless(felt.shown == plain.shown);
}
GST_END_TEST;

GST_START_TEST(test_a_pause_is_silent)
{
  TemporaryFile film;
  make_film(film.path, 240);
  Player player(kPlaybins[__i__], film.path, true);
  player.play();
  player.wait_for_commands(5);
  player.pause();
  std::map<int, double> levels;
  for (const IssuedCommand &line : unwrap(tactor::read_command_trace(player.trace_file.path)))
    levels[line.command.tactor] = line.command.volts;
  for (const auto &[tactor, volts] : levels)
    fail_unless(volts == 0, "tactor %d has %g V in a pause", tactor, volts);
  gst_element_set_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(5);
  player.assert_commands_are_the_frames(5);
}
GST_END_TEST;

GST_START_TEST(test_seeks)
{
  TemporaryFile film;
  make_film(film.path, 240);
  Player player(kPlaybins[__i__], film.path, true);
  player.play();
  for (const GstClockTime to : { 3 * GST_SECOND, GST_SECOND, 2 * GST_SECOND }) {
    player.wait_for_commands(3);
    seek_exactly(player.pipeline, 1, to, 8 * GST_SECOND);
    gst_element_get_state(player.pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
  }
  player.wait_for_commands(3);
  player.assert_commands_are_the_frames(10);
}
GST_END_TEST;

/* GStreamer leaves the decoder in PLAYING then. The wait is until the last frame that is ahead
 * would have been felt. */
GST_START_TEST(test_a_pause_before_a_seek_is_done)
{
  TemporaryFile film;
  make_film(film.path, 240);
  Player player(kPlaybins[__i__], film.path, true);
  player.play();
  player.wait_for_commands(5);
  seek_exactly(player.pipeline, 1, 3 * GST_SECOND, 8 * GST_SECOND);
  player.pause();
  const guint64 issued = player.issued();
  g_autoptr(GstClock) clock = gst_system_clock_obtain();
  const GstClockID later
      = gst_clock_new_single_shot_id(clock, gst_clock_get_time(clock) + GST_SECOND);
  gst_clock_id_wait(later, nullptr);
  gst_clock_id_unref(later);
  fail_unless_equals_uint64(player.issued(), issued);
  gst_element_set_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(5);
  player.assert_commands_are_the_frames(5);
}
GST_END_TEST;

/* Only playbin3: with these sinks, playbin of GStreamer 1.22 stops between the films, with and
 * without the chair. playbin3 loses frames there, so times are compared with the second film's
 * rate. */
GST_START_TEST(test_gapless)
{
  TemporaryFile first;
  TemporaryFile second;
  make_film(first.path, 45);
  make_film(second.path, 90);
  Player player("playbin3", first.path, true);
  player.next.push_back(second.path);
  player.play_to_the_end();
  guint checked = 0;
  for (const IssuedCommand &line : player.trace()) {
    if (is_unplanned(line) || line.command.volts == 0
        || line.command.effect < 2600 * std::chrono::milliseconds(1))
      continue;
    const gint64 from_end = player.shown.back().running - line.command.effect.count();
    const gint64 frames = (from_end * 30 + GST_SECOND / 2) / static_cast<gint64>(GST_SECOND);
    const gint64 off = from_end - frames * static_cast<gint64>(GST_SECOND) / 30;
    fail_unless(std::abs(off) <= 2000000, "%" G_GINT64_FORMAT " ns from a frame", off);
    checked++;
  }
  fail_unless(checked >= 5, "%u commands of the second film", checked);
}
GST_END_TEST;

GST_START_TEST(test_a_chair_that_fails)
{
  TemporaryFile film;
  make_film(film.path, 60);
  Player player(kPlaybins[__i__], film.path, true);
  player.driver = "none-such";
  player.play_to_the_end();
  ck_assert_uint_eq(player.shown.size(), 60);
  ck_assert_uint_eq(player.warnings.size(), 1);
  fail_unless(player.warnings.front().starts_with("The film plays without touch: "), "%s",
              player.warnings.front().c_str());
}
GST_END_TEST;

/// The tactors wait for the play with a map in hand.
GST_START_TEST(test_a_chair_that_fails_in_a_pause)
{
  TemporaryFile film;
  make_film(film.path, 120);
  Player player(kPlaybins[__i__], film.path, true);
  player.play();
  player.wait_for_commands(5);
  player.pause();
  GST_ELEMENT_ERROR(player.tactors(), STREAM, FAILED, ("Broken."), (nullptr));
  player.wait([&] { return !player.warnings.empty(); });
  gst_element_set_state(player.pipeline, GST_STATE_PLAYING);
  player.wait([&] { return player.ended; });
  ck_assert_uint_eq(player.warnings.size(), 1);
}
GST_END_TEST;

/* ---- streams ---- */

GST_START_TEST(test_the_best_decoder)
{
  GstHarness *harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, width=160, height=120"));
  fail_unless(decoded_by(harness->element) == " jpegdec");
  gst_harness_teardown(harness);

  rank_decoder("jpegdec", GST_RANK_NONE);
  harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, parsed=true, width=160, height=120"));
  fail_unless(decoded_by(harness->element) == " avdec_mjpeg");
  gst_harness_teardown(harness);
  rank_decoder("jpegdec", GST_RANK_PRIMARY);
}
GST_END_TEST;

GST_START_TEST(test_only_a_stream_replaces_a_decoder)
{
  GstHarness *harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, width=160, height=120"));
  g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(harness->element), "video-queue");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(queue, "sink");
  g_autoptr(GstPad) chosen = gst_pad_get_peer(pad);
  fail_unless(accepts(harness->element, "video/x-theora"));
  g_autoptr(GstPad) asked = gst_pad_get_peer(pad);
  fail_unless(asked == chosen);
  fail_if(accepts(harness->element, "video/x-wmv, wmvversion=99"));
  gst_harness_set_src_caps_str(harness, "video/x-theora");
  fail_unless(decoded_by(harness->element) == " theoradec");
  gst_harness_teardown(harness);
}
GST_END_TEST;

GST_START_TEST(test_two_threads_ask)
{
  for (int i = 0; i < 10; i++) {
    GstHarness *harness = make_harness();
    bool accepted[2] = {};
    {
      std::vector<std::jthread> threads;
      for (bool &answer : accepted)
        threads.emplace_back([&] { answer = accepts(harness->element, "image/jpeg"); });
    }
    fail_unless(accepted[0] && accepted[1]);
    fail_unless(decoded_by(harness->element) == " jpegdec");
    gst_harness_teardown(harness);
  }
}
GST_END_TEST;

/// A parser alone is no promise. Each decoder leaves the registry, and returns.
GST_START_TEST(test_what_nobody_decodes_behind_a_parser)
{
  g_autoptr(GstCaps) h264 = gst_caps_from_string("video/x-h264");
  GList *all = gst_element_factory_list_get_elements(
      GST_ELEMENT_FACTORY_TYPE_DECODER | GST_ELEMENT_FACTORY_TYPE_MEDIA_VIDEO, GST_RANK_MARGINAL);
  GList *gone = gst_element_factory_list_filter(all, h264, GST_PAD_SINK, FALSE);
  fail_unless(gone != nullptr);
  GstHarness *harness = make_harness();
  g_autoptr(GstPad) pad = gst_element_get_static_pad(harness->element, "sink");
  for (const bool decodable : { true, false, true }) {
    g_autoptr(GstCaps) caps = gst_pad_query_caps(pad, h264);
    ck_assert_int_eq(!gst_caps_is_empty(caps), decodable);
    for (GList *item = gone; item != nullptr; item = item->next) {
      auto *feature = GST_PLUGIN_FEATURE(item->data);
      if (decodable)
        gst_registry_remove_feature(gst_registry_get(), feature);
      else
        gst_registry_add_feature(gst_registry_get(), GST_PLUGIN_FEATURE(gst_object_ref(feature)));
    }
  }
  gst_harness_teardown(harness);
  gst_plugin_feature_list_free(gone);
  gst_plugin_feature_list_free(all);
}
GST_END_TEST;

GST_START_TEST(test_what_nobody_decodes)
{
  GstHarness *harness = make_harness();
  fail_if(accepts(harness->element, "video/x-none-such, width=160, height=120"));
  fail_if(accepts(harness->element, "video/x-wmv, wmvversion=99"));
  fail_unless(decoded_by(harness->element) == "");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(harness->element, "sink");
  g_autoptr(GstCaps) caps = gst_pad_query_caps(pad, nullptr);
  g_autoptr(GstCaps) jpeg = gst_caps_from_string("image/jpeg");
  g_autoptr(GstCaps) unknown = gst_caps_from_string("video/x-wmv, wmvversion=99");
  fail_unless(gst_caps_can_intersect(caps, jpeg));
  fail_if(gst_caps_can_intersect(caps, unknown));
  gst_harness_teardown(harness);
}
GST_END_TEST;

GST_START_TEST(test_a_stream_that_needs_a_parser)
{
  GstElement *pipeline = make_pipeline(
      "videotestsrc num-buffers=10 ! video/x-raw,width=160,height=120 ! x264enc tune=zerolatency ! "
      "video/x-h264,stream-format=byte-stream ! "
      "capssetter replace=true caps=video/x-h264,stream-format=byte-stream ! "
      "visuotactiledecoder name=decoder tactors::driver=simulator ! fakesink name=sink");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  change_state(pipeline, GST_STATE_PAUSED);
  fail_unless(decoded_by(decoder).find("h264parse") != std::string::npos, "%s",
              decoded_by(decoder).c_str());
  play_to_the_end(pipeline);
}
GST_END_TEST;

/// Bases of the segments that the analysis gets.
struct Bases
{
  std::mutex mutex;
  std::vector<GstClockTime> seen;

  static GstPadProbeReturn on_event(GstPad *, GstPadProbeInfo *info, gpointer user_data)
  {
    auto *self = static_cast<Bases *>(user_data);
    GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
    const GstSegment *segment = nullptr;
    if (GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT) {
      gst_event_parse_segment(event, &segment);
      std::lock_guard lock(self->mutex);
      self->seen.push_back(segment->base);
    }
    return GST_PAD_PROBE_OK;
  }
  GstClockTime wait_for(std::size_t count)
  {
    for (;;) {
      {
        std::lock_guard lock(mutex);
        if (seen.size() >= count)
          return seen.back();
      }
      g_usleep(1000);
    }
  }
};

void
begin_film(GstHarness *harness, guint group)
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  GstEvent *start = gst_event_new_stream_start("film");
  gst_event_set_group_id(start, group);
  gst_harness_push_event(harness, start);
  g_autoptr(GstCaps) caps = gst_caps_from_string("image/jpeg, width=64, height=48, framerate=10/1");
  gst_harness_push_event(harness, gst_event_new_caps(caps));
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
}

void
push_frames(GstHarness *harness, GstBuffer *jpeg, guint first, guint count)
{
  for (guint i = first; i < first + count; i++) {
    GstBuffer *frame = gst_buffer_copy(jpeg);
    GST_BUFFER_PTS(frame) = GST_BUFFER_DTS(frame) = i * 100 * kMs;
    GST_BUFFER_DURATION(frame) = 100 * kMs;
    ck_assert_int_eq(gst_harness_push(harness, frame), GST_FLOW_OK);
  }
}

void
send_qos(GstHarness *harness, GstClockTime shown, gint64 offset)
{
  GstEvent *qos = gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 1, 0, shown);
  gst_event_set_running_time_offset(qos, offset);
  gst_harness_push_upstream_event(harness, qos);
}

GST_START_TEST(test_films_one_after_the_other)
{
  GstHarness *encoder = gst_harness_new("jpegenc");
  gst_harness_set_src_caps_str(encoder,
                               "video/x-raw,format=I420,width=64,height=48,framerate=10/1");
  GstBuffer *raw = gst_buffer_new_allocate(nullptr, 64 * 48 * 3 / 2, nullptr);
  gst_buffer_memset(raw, 0, 90, 64 * 48 * 3 / 2);
  GST_BUFFER_PTS(raw) = 0;
  GstBuffer *jpeg = gst_harness_push_and_pull(encoder, raw);
  GstHarness *harness = make_harness();
  Bases bases;
  GObject *analysis
      = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(harness->element), "analysis");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(GST_ELEMENT(analysis), "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, Bases::on_event, &bases, nullptr);

  begin_film(harness, 1);
  push_frames(harness, jpeg, 0, 2);
  ck_assert_uint_eq(bases.wait_for(1), 0);
  begin_film(harness, 2); // after the first one, as it seems
  push_frames(harness, jpeg, 0, 2);
  ck_assert_uint_eq(bases.wait_for(2), 200 * kMs);
  send_qos(harness, 100 * kMs, 0);                               // no streamsynchronizer behind
  send_qos(harness, 900 * kMs, -5 * static_cast<gint64>(kMs));   // of a frame that has not come
  send_qos(harness, 310 * kMs, -210 * static_cast<gint64>(kMs)); // the sound is longer
  push_frames(harness, jpeg, 10, 1); // the decoder drops what QoS calls late
  ck_assert_uint_eq(bases.wait_for(3), 210 * kMs);
  gst_harness_push_event(harness, gst_event_new_flush_start());
  gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  begin_film(harness, 2);
  push_frames(harness, jpeg, 0, 1);
  ck_assert_uint_eq(bases.wait_for(4), 0);

  gst_buffer_unref(jpeg);
  g_object_unref(analysis);
  gst_harness_teardown(harness);
  gst_harness_teardown(encoder);
}
GST_END_TEST;

/// Whether the chair's elements of a paused or playing decoder play, too.
bool
has_chair(GstElement *pipeline)
{
  g_autoptr(GstElement) tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
  GstState state = GST_STATE_NULL;
  gst_element_get_state(tactors, &state, nullptr, GST_CLOCK_TIME_NONE);
  return state > GST_STATE_READY;
}

/* The next turn is given on a thread of GStreamer's. */
void
wait_for_chair(GstElement *pipeline)
{
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  while (!has_chair(pipeline))
    if (GstMessage *message = gst_bus_timed_pop_filtered(bus, 10 * kMs, GST_MESSAGE_STATE_CHANGED))
      gst_message_unref(message);
}

GstElement *
make_felt_film(guint frames)
{
  return make_pipeline("tactiletestsrc pattern=dynamic-motion num-buffers=" + std::to_string(frames)
                       + " ! video/x-raw,width=64,height=48 ! jpegenc ! "
                         "visuotactiledecoder tactors::driver=simulator ! fakesink sync=true");
}

GST_START_TEST(test_several_films_at_a_time)
{
  GstElement *films[] = { make_felt_film(90), make_felt_film(30), make_felt_film(600) };
  for (GstElement *film : films)
    change_state(film, GST_STATE_PAUSED);
  fail_unless(has_chair(films[0]) && !has_chair(films[1]) && !has_chair(films[2]));
  change_state(films[0], GST_STATE_READY); // leaves it
  wait_for_chair(films[1]);
  fail_unless(!has_chair(films[0]) && !has_chair(films[2]));
  change_state(films[2], GST_STATE_PLAYING);
  gst_element_set_state(films[1], GST_STATE_PLAYING);
  wait_for_eos(films[1]);
  wait_for_chair(films[2]); // what has ended needs it no more
  fail_if(has_chair(films[1]));
  change_state(films[2], GST_STATE_NULL);
  change_state(films[0], GST_STATE_PAUSED); // nor does it take it again
  wait_for_chair(films[0]);
  for (GstElement *film : films) {
    gst_element_set_state(film, GST_STATE_NULL);
    gst_object_unref(film);
  }
}
GST_END_TEST;

/* The chair comes in the middle of a film, which is felt from then on. */
GST_START_TEST(test_a_turn_in_the_middle_of_a_film)
{
  GstElement *other = make_pipeline("tactiletestsrc num-buffers=90 ! jpegenc ! "
                                    "visuotactiledecoder tactors::driver=simulator ! fakesink");
  GstElement *film = make_pipeline("tactiletestsrc pattern=dynamic-motion num-buffers=150 ! "
                                   "video/x-raw,width=160,height=120 ! jpegenc ! "
                                   "visuotactiledecoder tactors::driver=simulator ! "
                                   "fakesink sync=true name=screen");
  change_state(other, GST_STATE_PAUSED);
  change_state(film, GST_STATE_PLAYING);
  fail_if(has_chair(film));
  change_state(other, GST_STATE_NULL);
  wait_for_eos(film);
  g_autoptr(GstElement) tactors = gst_bin_get_by_name(GST_BIN(film), "tactors");
  fail_unless(actuation_stat_of(tactors, "issued") > 0);
  gst_element_set_state(film, GST_STATE_NULL);
  gst_object_unref(film);
  gst_object_unref(other);
}
GST_END_TEST;

GST_START_TEST(test_another_size)
{
  GstElement *pipeline = make_pipeline(
      "concat name=c ! visuotactiledecoder name=decoder tactors::driver=simulator ! "
      "fakesink name=sink "
      "videotestsrc num-buffers=5 ! video/x-raw,width=160,height=120 ! jpegenc ! c. "
      "videotestsrc num-buffers=5 ! video/x-raw,width=64,height=48 ! jpegenc ! c.");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  gint width = 0;
  gst_structure_get_int(gst_caps_get_structure(caps, 0), "width", &width);
  ck_assert_int_eq(width, 64);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}
GST_END_TEST;

GST_START_TEST(test_the_latency_of_a_live_source)
{
  const bool live = __i__ == 1;
  GstElement *pipeline = make_pipeline(
      std::string("tactiletestsrc is-live=") + (live ? "true" : "false")
      + " num-buffers=60 ! video/x-raw,width=64,height=48,framerate=30/1 ! jpegenc ! "
        "visuotactiledecoder name=decoder tactors::driver=simulator ! "
        "fakesink name=sink sync=true");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  g_autoptr(GstPad) src = gst_element_get_static_pad(decoder, "src");
  gst_element_set_state(pipeline, live ? GST_STATE_PLAYING : GST_STATE_PAUSED);
  gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
  g_autoptr(GstQuery) before = gst_query_new_latency();
  g_autoptr(GstQuery) behind = gst_query_new_latency();
  fail_unless(gst_pad_peer_query(pad, before) && gst_pad_query(src, behind));
  GstClockTime lead = 0;
  GstClockTime min_before = 0;
  GstClockTime min_behind = 0;
  gst_child_proxy_get(GST_CHILD_PROXY(decoder), "tactors::render-delay", &lead, nullptr);
  gst_query_parse_latency(before, nullptr, &min_before, nullptr);
  gst_query_parse_latency(behind, nullptr, &min_behind, nullptr);
  fail_unless(lead > 0);
  fail_unless(min_behind - min_before >= (live ? lead + 20 * kMs : 0));
  fail_unless(min_behind - min_before <= (live ? lead + 20 * kMs + 100 * kMs : 100 * kMs));
  if (live) { // the chair plays by the latency of the pipeline
    GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(decoder), "tactors");
    gst_bin_recalculate_latency(GST_BIN(pipeline));
    fail_unless(gst_base_sink_get_latency(GST_BASE_SINK(sink)) >= lead);
    ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(tactors)),
                      gst_base_sink_get_latency(GST_BASE_SINK(sink)));
    g_object_unref(tactors);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}
GST_END_TEST;

GstPadProbeReturn
forget_time(GstPad *, GstPadProbeInfo *info, gpointer)
{
  GstBuffer *frame = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  info->data = frame;
  GST_BUFFER_PTS(frame) = GST_BUFFER_DTS(frame) = GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
  return GST_PAD_PROBE_OK;
}

GST_START_TEST(test_frames_without_times_do_not_pile_up)
{
  GstElement *pipeline
      = make_pipeline("videotestsrc num-buffers=100 ! "
                      "video/x-raw,width=64,height=48,framerate=30/1 ! vp8enc deadline=1 ! "
                      "capssetter join=true caps=video/x-vp8,framerate=0/1 ! "
                      "visuotactiledecoder name=decoder tactors::driver=simulator ! fakesink");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(pipeline), "video-queue");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, forget_time, nullptr, nullptr);
  gint full = 0;
  g_signal_connect(queue, "overrun",
                   G_CALLBACK(+[](GstElement *, gint *seen) { g_atomic_int_set(seen, 1); }), &full);
  change_state(pipeline, GST_STATE_PAUSED);
  guint waiting = 0;
  while (!g_atomic_int_get(&full)) {
    g_object_get(queue, "current-level-buffers", &waiting, nullptr);
    fail_unless(waiting <= 64, "%u frames", waiting);
    g_usleep(1000);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}
GST_END_TEST;

GST_START_TEST(test_messages_of_the_chair)
{
  GstHarness *harness = make_harness();
  ElementBus bus(harness->element);
  GObject *tactors
      = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(harness->element), "tactors");
  GstObject *source = GST_OBJECT(tactors);
  gst_element_post_message(GST_ELEMENT(tactors),
                           gst_message_new_property_notify(source, "driver", nullptr));
  gst_element_post_message(GST_ELEMENT(tactors), gst_message_new_eos(source));
  fail_unless(bus.has(GST_MESSAGE_PROPERTY_NOTIFY));
  fail_if(bus.has(GST_MESSAGE_EOS));
  g_object_unref(tactors);
  gst_harness_teardown(harness);
}
GST_END_TEST;

static Suite *
visuotactiledecoder_suite(void)
{
  Suite *suite = suite_create("visuotactiledecoder");
  TCase *players = tcase_create("players");
  suite_add_tcase(suite, players);
  tcase_add_loop_test(players, test_a_player_is_felt, 0, 2);
  tcase_add_loop_test(players, test_the_picture_is_the_same, 0, 2);
  tcase_add_loop_test(players, test_a_pause_is_silent, 0, 2);
  tcase_add_loop_test(players, test_seeks, 0, 2);
  tcase_add_loop_test(players, test_a_pause_before_a_seek_is_done, 0, 2);
  tcase_add_test(players, test_gapless);
  tcase_add_loop_test(players, test_a_chair_that_fails, 0, 2);
  tcase_add_loop_test(players, test_a_chair_that_fails_in_a_pause, 0, 2);
  TCase *streams = tcase_create("streams");
  suite_add_tcase(suite, streams);
  tcase_add_test(streams, test_the_best_decoder);
  tcase_add_test(streams, test_only_a_stream_replaces_a_decoder);
  tcase_add_test(streams, test_two_threads_ask);
  tcase_add_test(streams, test_what_nobody_decodes);
  tcase_add_test(streams, test_what_nobody_decodes_behind_a_parser);
  tcase_add_test(streams, test_a_stream_that_needs_a_parser);
  tcase_add_test(streams, test_films_one_after_the_other);
  tcase_add_test(streams, test_several_films_at_a_time);
  tcase_add_test(streams, test_a_turn_in_the_middle_of_a_film);
  tcase_add_test(streams, test_another_size);
  tcase_add_loop_test(streams, test_the_latency_of_a_live_source, 0, 2);
  tcase_add_test(streams, test_frames_without_times_do_not_pile_up);
  tcase_add_test(streams, test_messages_of_the_chair);
  return suite;
}

GST_CHECK_MAIN(visuotactiledecoder);
