// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactiledecoder in playbin and playbin3. Compared are running times of frames at the player's
// sink and of commands in the trace, and what the sink gets with what it gets without the chair. No
// test depends on the machine's speed.
#include "tactor/command_trace.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/patient_clock.h"
#include "support/played_film.h"
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"
#include "trace.h"

#include "support/check_tests.h"

using tactor::IssuedCommand;

namespace {

constexpr GstClockTime kMs = GST_MSECOND;
constexpr const char *kPlaybins[] = { "playbin", "playbin3" };

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
    clock.emplace(pipeline);
    screen = gst_element_factory_make("fakesink", nullptr);
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
  /// Decoders drop frames that would come too late for a sink that tells them so, as on a busy
  /// machine.
  void show_all()
  {
    g_object_set(screen, "qos", FALSE, nullptr);
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
  GstElement *screen; ///< the pipeline's
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
  std::optional<PatientClock> clock;
};

} // namespace

CHECK_LOOP_TEST(test_a_player_is_felt, 0, 2)
{
  TemporaryFile film;
  make_film(film.path, 60);
  Player player(kPlaybins[__i__], film.path, true);
  player.show_all();
  player.play_to_the_end();
  ck_assert_uint_eq(player.decoders.size(), 1);
  fail_unless(player.warnings.empty(), "%s", player.warnings.front().c_str());
  ck_assert_uint_eq(player.shown.size(), 60);
  player.assert_commands_are_the_frames(5);
}

CHECK_LOOP_TEST(test_the_picture_is_the_same, 0, 2)
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

CHECK_LOOP_TEST(test_a_pause_is_silent, 0, 2)
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

CHECK_LOOP_TEST(test_seeks, 0, 2)
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

/* GStreamer leaves the decoder in PLAYING then. The wait is until the last frame that is ahead
 * would have been felt. */
CHECK_LOOP_TEST(test_a_pause_before_a_seek_is_done, 0, 2)
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

/* Only playbin3: with these sinks, playbin of GStreamer 1.22 stops between the films, with and
 * without the chair. playbin3 loses frames there, so times are compared with the second film's
 * rate. */
constexpr GstClockTime kSecondFilm = 2600 * kMs; ///< when the first one has ended for sure

/// Plays two films of 1.5 and 3 s. The second one is seen.
static void
play_gapless(Player &player, const std::string &second)
{
  player.next.push_back(second);
  player.play_to_the_end();
  const auto seen = std::ranges::count_if(player.shown, [](const Shown &frame) {
    return frame.running >= static_cast<gint64>(kSecondFilm);
  });
  fail_unless(seen >= 30, "%d frames of the second film", static_cast<int>(seen));
}

CHECK_TEST(test_gapless)
{
  TemporaryFile first;
  TemporaryFile second;
  make_film(first.path, 45);
  make_film(second.path, 90);
  Player player("playbin3", first.path, true);
  play_gapless(player, second.path);
  guint checked = 0;
  for (const IssuedCommand &line : player.trace()) {
    if (is_unplanned(line) || line.command.volts == 0
        || line.command.effect < tactor::Time(kSecondFilm))
      continue;
    const gint64 from_end = player.shown.back().running - line.command.effect.count();
    const gint64 frames = (from_end * 30 + GST_SECOND / 2) / static_cast<gint64>(GST_SECOND);
    const gint64 off = from_end - frames * static_cast<gint64>(GST_SECOND) / 30;
    fail_unless(std::abs(off) <= 2000000, "%" G_GINT64_FORMAT " ns from a frame", off);
    checked++;
  }
  fail_unless(checked >= 5, "%u commands of the second film", checked);
}

/// What GStreamer itself does: `tests/machines/gstreamer.sh gapless` compares.
CHECK_TEST(test_gapless_without_a_chair)
{
  TemporaryFile first;
  TemporaryFile second;
  make_film(first.path, 45);
  make_film(second.path, 90);
  Player player("playbin3", first.path, true);
  rank_decoder("visuotactiledecoder", GST_RANK_NONE);
  play_gapless(player, second.path);
  ck_assert_uint_eq(player.decoders.size(), 0);
}

CHECK_LOOP_TEST(test_a_chair_that_fails, 0, 2)
{
  TemporaryFile film;
  make_film(film.path, 60);
  Player player(kPlaybins[__i__], film.path, true);
  player.driver = "none-such";
  player.show_all();
  player.play_to_the_end();
  ck_assert_uint_eq(player.shown.size(), 60);
  ck_assert_uint_eq(player.warnings.size(), 1);
  fail_unless(player.warnings.front().starts_with("The film plays without touch: "), "%s",
              player.warnings.front().c_str());
}

/// The tactors wait for the play with a map in hand.
CHECK_LOOP_TEST(test_a_chair_that_fails_in_a_pause, 0, 2)
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

CHECK_MAIN(visuotactiledecoder_players)
