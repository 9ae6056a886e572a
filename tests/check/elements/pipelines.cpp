// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Whole pipelines on the system clock, from film to motors. Whatever is done to them, the trace
// ends with every motor at zero. No test depends on the machine's speed: each waits for events.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/temporary_file.h"
#include "trace.h"
#include <gst/base/gstbasesink.h>

#include "support/check_tests.h"

using std::chrono::milliseconds;
using tactor::IssuedCommand;
using tactor::Time;

namespace {

constexpr GstClockTime kMs = GST_MSECOND;
constexpr guint64 kRenderDelay = 190 * kMs; ///< max-lead of 180 ms and a margin of 10 ms

const std::string kSource = "tactiletestsrc name=source ";
const std::string kCaps = " ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ";
const std::string kQueue
    = " ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=300000000 ! ";
const std::string kTactors = "tactorsink name=tactors ";
const std::string kBranches = " ! tactileextractor name=x x.src" + kQueue
                              + "fakesink name=video sync=true x.tactile" + kQueue + kTactors;
/// A ball that moves from the first second on, so there are cues wherever a test seeks to.
const std::string kFilm
    = kSource + "pattern=dynamic-motion" + kCaps + "! saliencytactile temporal=false" + kBranches;

/// A pipeline with an element `tactors`, and the messages on its bus.
class Player
{
public:
  explicit Player(const std::string &description)
  {
    pipeline = make_pipeline(description);
    tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
    video = gst_bin_get_by_name(GST_BIN(pipeline), "video");
    bus = gst_element_get_bus(pipeline);
    if (tactors)
      g_object_set(tactors, "trace-location", trace_file.path.c_str(), "ramp-in", guint64{ 0 },
                   nullptr);
  }
  ~Player()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    drain_bus();
    gst_clear_object(&tactors);
    gst_clear_object(&video);
    gst_object_unref(bus);
    gst_object_unref(pipeline);
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void wait(const std::function<bool()> &done)
  {
    while (!done())
      if (GstMessage *message = gst_bus_timed_pop(bus, 10 * kMs))
        take(message);
  }
  void wait_for_eos()
  {
    eos = false;
    wait([this] { return eos; });
  }
  guint64 stat(const char *field)
  {
    return actuation_stat_of(tactors, field);
  }
  /// Plays until this many more commands are issued.
  void wait_for_commands(guint64 count)
  {
    wait([this, count, until = stat("issued") + count] {
      fail_if(eos, "the film ended after %" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT " commands",
              stat("issued") + count - until, count);
      return stat("issued") >= until;
    });
  }
  guint64 rendered()
  {
    ck_assert_uint_eq(stat_of(video, "dropped"), 0);
    return stat_of(video, "rendered");
  }

  /// The trace so far, for use when nothing plays: paused, after the stream or after the run. Each
  /// motor's last command must be zero.
  std::vector<IssuedCommand> trace()
  {
    const std::vector<IssuedCommand> lines = unwrap(tactor::read_command_trace(trace_file.path));
    for (const IssuedCommand &line : lines) {
      fail_unless(line.command.lead >= Time(0) && line.command.lead <= milliseconds(180));
      fail_unless(line.issued >= line.command.due());
      fail_unless(line.command.volts <= 3.0);
    }
    assert_silent_at_end(lines);
    return lines;
  }
  /// The trace after the run. Between seeks and pauses, effects must be in order for each motor: a
  /// command that needs more lead may be issued before an earlier one for another motor.
  std::vector<IssuedCommand> final_trace()
  {
    change_state(pipeline, GST_STATE_NULL);
    drain_bus();
    const std::vector<IssuedCommand> lines = trace();
    std::map<int, Time> effects;
    Time issued = Time::min();
    bool vibrated = false;
    for (const IssuedCommand &line : lines) {
      // A pause or a seek. If all motors are at rest, only a restart of running time tells of it,
      // if anything.
      const bool begins = is_unplanned(line) || line.issued < issued
                          || (seeks > 0 && line.issued > line.command.effect);
      if (begins)
        effects.clear();
      Time &effect = effects.try_emplace(line.command.tactor, Time::min()).first->second;
      fail_unless(line.command.effect >= effect);
      effect = is_unplanned(line) ? Time::min() : line.command.effect;
      issued = line.issued;
      vibrated |= line.command.volts > 0;
    }
    fail_unless(vibrated);
    return lines;
  }

  GstElement *pipeline;
  GstElement *tactors;
  GstElement *video;
  GstBus *bus;
  TemporaryFile trace_file;
  bool eos = false;
  int errors = 0;
  int errors_expected = 0;
  int seeks = 0; ///< flushing seeks while it played

private:
  void drain_bus()
  {
    while (GstMessage *message = gst_bus_pop(bus))
      take(message);
  }
  /// Fails on warnings and on more errors than expected.
  void take(GstMessage *message)
  {
    const GstMessageType type = GST_MESSAGE_TYPE(message);
    eos |= type == GST_MESSAGE_EOS;
    if (type == GST_MESSAGE_ERROR || type == GST_MESSAGE_WARNING) {
      errors += type == GST_MESSAGE_ERROR;
      const Said said(message);
      fail_unless(type == GST_MESSAGE_ERROR && errors <= errors_expected, "%s: %s (%s)",
                  GST_MESSAGE_SRC_NAME(message), said.text.c_str(), said.details.c_str());
    }
    gst_message_unref(message);
  }
};

void
assert_effects_within(const std::vector<IssuedCommand> &lines, Time from, Time to)
{
  for (const IssuedCommand &line : lines)
    if (!is_unplanned(line))
      fail_unless(line.command.effect >= from && line.command.effect <= to, "effect at %g s",
                  static_cast<double>(line.command.effect.count()) * 1e-9);
}

} // namespace

CHECK_TEST(test_to_the_end)
{
  Player player(kSource + "num-buffers=60" + kCaps + "! saliencytactile" + kBranches);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_uint_eq(player.rendered(), 60);
  // The zeros at the end are issued, or dropped if the sink has silenced all motors already.
  const guint64 commands = player.stat("issued") + player.stat("dropped");
  const std::vector<IssuedCommand> lines = player.final_trace();
  // The first second is plain gray, and the last frame ends at 2 s.
  assert_effects_within(lines, milliseconds(1000), milliseconds(2000));
  fail_unless(lines.size() <= commands); // some change nothing
}

CHECK_TEST(test_pause_and_play)
{
  Player player(kFilm);
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, 1.0, GST_SECOND, 60 * GST_SECOND);
  for (int i = 0; i < 10; i++) {
    change_state(player.pipeline, GST_STATE_PLAYING);
    player.wait_for_commands(1);
    change_state(player.pipeline, GST_STATE_PAUSED);
    player.trace();
  }
  player.final_trace();
}

/// Half a second of the film at a rate. Running time is film time divided by the rate, and the
/// number of frames stays the same.
static void
check_rate(double rate)
{
  Player player(kFilm);
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, rate, GST_SECOND, 1500 * kMs);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_uint_eq(player.rendered(), 15);
  const Time end(static_cast<gint64>(GST_SECOND / 2 / std::abs(rate)));
  const std::vector<IssuedCommand> lines = player.final_trace();
  assert_effects_within(lines, Time(0), end + Time(10));
  // motors are on until the last frame ends
  fail_unless(lines.back().command.effect >= end - Time(10));
}

CHECK_TEST(test_rates)
{
  check_rate(0.5);
  check_rate(2.0);
  check_rate(-1.0);
}

CHECK_TEST(test_flushing_seeks)
{
  Player player(kFilm);
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, 1.0, GST_SECOND, 60 * GST_SECOND);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(2);
  for (const double rate : { 1.0, 2.0, -1.0, 0.5, -2.0, 1.0 }) {
    player.seeks++;
    seek_exactly(player.pipeline, rate, rate > 0 ? 3 * GST_SECOND : 0,
                 rate > 0 ? 60 * GST_SECOND : 5 * GST_SECOND);
    player.wait_for_commands(2);
  }
  // In quick succession: the pipeline may not have prerolled when the next one comes.
  for (int i = 0; i < 10; i++) {
    player.seeks++;
    seek_exactly(player.pipeline, 1.0, static_cast<GstClockTime>(1 + i) * GST_SECOND,
                 60 * GST_SECOND);
  }
  player.wait_for_commands(2);
  change_state(player.pipeline, GST_STATE_PAUSED);
  player.trace();
  player.seeks++;
  seek_exactly(player.pipeline, 1.0, 2 * GST_SECOND, 60 * GST_SECOND);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(2);
  player.final_trace();
}

/// Running time continues, and so do the effects.
CHECK_TEST(test_seeks_without_flush)
{
  Player player(kFilm);
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, 1.0, GST_SECOND, 60 * GST_SECOND);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(2);
  for (const double rate : { 2.0, 0.5, 1.0 }) {
    seek_exactly(player.pipeline, rate, 3 * GST_SECOND, 60 * GST_SECOND, GST_SEEK_FLAG_NONE);
    player.wait_for_commands(3);
  }
  seek_exactly(player.pipeline, -1.0, GST_SECOND, 2 * GST_SECOND, GST_SEEK_FLAG_NONE);
  player.wait_for_eos();
  player.final_trace();
}

CHECK_TEST(test_null_while_playing)
{
  Player player(kFilm);
  for (const GstState rest : { GST_STATE_READY, GST_STATE_NULL }) {
    change_state(player.pipeline, GST_STATE_PAUSED);
    seek_exactly(player.pipeline, 1.0, GST_SECOND, 60 * GST_SECOND);
    change_state(player.pipeline, GST_STATE_PLAYING);
    player.wait_for_commands(2);
    change_state(player.pipeline, rest);
  }
  player.final_trace();
}

/// All sinks have the pipeline's latency. Only this one has a render-delay.
static void
assert_latencies(Player &player, bool live)
{
  GstBaseSink *tactors = GST_BASE_SINK(player.tactors);
  GstBaseSink *video = GST_BASE_SINK(player.video);
  ck_assert_uint_eq(gst_base_sink_get_render_delay(tactors), kRenderDelay);
  ck_assert_uint_eq(gst_base_sink_get_render_delay(video), 0);
  fail_unless(gst_base_sink_get_latency(tactors) >= kRenderDelay);
  ck_assert_uint_eq(gst_base_sink_get_latency(tactors), gst_base_sink_get_latency(video));

  gboolean sync = FALSE;
  gboolean upstream_live = !live;
  fail_unless(gst_base_sink_query_latency(video, &sync, &upstream_live, nullptr, nullptr));
  ck_assert_int_eq(upstream_live, live);

  GstQuery *query = gst_query_new_latency();
  fail_unless(gst_element_query(player.pipeline, query));
  GstClockTime min = 0;
  GstClockTime max = 0;
  gst_query_parse_latency(query, nullptr, &min, &max);
  gst_query_unref(query);
  fail_unless(min >= kRenderDelay);
  fail_unless(max >= min);
  ck_assert_uint_eq(gst_base_sink_get_latency(tactors), min);
}

CHECK_TEST(test_film_waits_for_motors)
{
  Player player(kFilm);
  change_state(player.pipeline, GST_STATE_PLAYING);
  assert_latencies(player, false);
}

CHECK_TEST(test_live)
{
  Player player(kSource + "is-live=true" + kCaps + "! saliencytactile" + kBranches);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(1); // the first second is plain gray
  assert_latencies(player, true);
  change_state(player.pipeline, GST_STATE_PAUSED);
  player.trace();
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_commands(2);
  gst_element_send_event(player.pipeline, gst_event_new_eos());
  player.wait_for_eos();
  player.final_trace();
}

CHECK_TEST(test_error_upstream)
{
  Player player(kSource + kCaps + "! identity error-after=36 ! saliencytactile" + kBranches);
  player.errors_expected = 2; // from identity, and from the source as its data flow nowhere
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait([&] { return player.errors > 0; });
  player.wait_for_commands(1); // earlier maps are still played
  player.final_trace();
}

/// The frames' size and the grid change within a stream: motors of the old grid stop, those of the
/// new one play.
CHECK_TEST(test_caps_change)
{
  Player player("tactiletestsrc num-buffers=45" + kCaps
                + "! saliencytactile rows=1 columns=12 ! concat name=c "
                  "tactiletestsrc num-buffers=45 ! "
                  "video/x-raw,format=NV12,width=96,height=160,framerate=25/1 "
                  "! saliencytactile rows=2 columns=2 ! c. c."
                + kBranches);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_uint_eq(player.rendered(), 45);
  const std::vector<IssuedCommand> lines = player.final_trace();
  assert_effects_within(lines, milliseconds(1000), milliseconds(1500 + 1800));
  // 1.5 s and 1.8 s, of which one second each is gray.
  bool old_grid = false;
  bool new_grid = false;
  for (const IssuedCommand &line : lines) {
    const bool vibrates = line.command.volts > 0;
    old_grid |= vibrates && line.command.effect < milliseconds(1500);
    new_grid |= vibrates && line.command.effect >= milliseconds(2500);
    fail_if(vibrates && line.command.effect > milliseconds(1500) && line.command.tactor >= 4);
    fail_if(vibrates && line.command.effect > milliseconds(1500)
            && line.command.effect < milliseconds(2500));
  }
  fail_unless(old_grid && new_grid);
}

CHECK_TEST(test_unlinked_pads)
{
  const std::string source
      = kSource + "num-buffers=40" + kCaps + "! saliencytactile ! tactileextractor name=x ";
  Player video_only(source + "x.src" + kQueue + "fakesink name=video sync=true");
  change_state(video_only.pipeline, GST_STATE_PLAYING);
  video_only.wait_for_eos();
  ck_assert_uint_eq(video_only.rendered(), 40);

  Player tactors_only(source + "x.tactile" + kQueue + kTactors);
  change_state(tactors_only.pipeline, GST_STATE_PLAYING);
  tactors_only.wait_for_eos();
  tactors_only.final_trace();
}

/// Tactors at the end of the video branch, which take frames with metas.
CHECK_TEST(test_without_extractor)
{
  Player player(kSource + "num-buffers=45" + kCaps + "! saliencytactile" + kQueue + kTactors);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  assert_effects_within(player.final_trace(), milliseconds(1000), milliseconds(1500));
}

static bool
have_elements(const std::vector<const char *> &names)
{
  for (const char *name : names) {
    GstElementFactory *factory = gst_element_factory_find(name);
    if (!factory) {
      GST_WARNING("left out: there is no element %s", name);
      return false;
    }
    gst_object_unref(factory);
  }
  return true;
}

/// The film passes through a container, and its maps through network packets.
CHECK_TEST(test_muxed_and_payloaded)
{
  if (!have_elements({ "matroskamux", "matroskademux", "rtpgstpay", "rtpgstdepay" }))
    return;
  Player player(
      kSource + "num-buffers=60" + kCaps
      + "! matroskamux ! matroskademux ! queue ! saliencytactile ! tactileextractor name=x x.src"
      + kQueue + "fakesink name=video sync=true x.tactile ! rtpgstpay ! rtpgstdepay" + kQueue
      + kTactors);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_uint_eq(player.rendered(), 60);
  assert_effects_within(player.final_trace(), milliseconds(950), milliseconds(2050));
}

/// Two seconds of a street film, if available.
CHECK_TEST(test_clip)
{
  const char *folder = std::getenv("TEST_CLIPS");
  const std::string clip = std::string(folder ? folder : "") + "/car-detection.mp4";
  if (!folder || !std::filesystem::exists(clip)) {
    GST_WARNING("left out: TEST_CLIPS is not a folder with car-detection.mp4");
    return;
  }
  Player player("filesrc location=" + clip + " ! decodebin ! videoconvert ! saliencytactile"
                + kBranches);
  change_state(player.pipeline, GST_STATE_PAUSED);
  seek_exactly(player.pipeline, 1.0, 5 * GST_SECOND, 7 * GST_SECOND);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  fail_unless(player.rendered() > 10);
  assert_effects_within(player.final_trace(), Time(0), milliseconds(2100));
}

CHECK_MAIN(pipelines)
