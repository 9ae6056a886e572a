// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactilesink as a whole in an application: seeks and other events go upstream once, a step
// advances one frame, and motors resume with the visible frame.
#include <algorithm>
#include <map>

#include "visuotactilesink_rig.h"

#include <gst/check/gsttestclock.h>
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

namespace {

constexpr guint kFrames = 50;
constexpr guint kCells = 9;
constexpr GstClockTime kFrame = 40 * kMs;

/// Frame i has one cell on, number i mod 9.
int
cell_of(guint64 number)
{
  return static_cast<int>(number % kCells);
}

/// Rounds a frame's time to the millisecond, but not its duration, like Matroska.
GstPadProbeReturn
add_map(GstPad *, GstPadProbeInfo *info, gpointer)
{
  GstBuffer *buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_BUFFER_PTS(buffer) = (GST_BUFFER_PTS(buffer) + kMs / 2) / kMs * kMs;
  gfloat levels[kCells] = {};
  levels[cell_of(GST_BUFFER_OFFSET(buffer))] = 1;
  gst_buffer_add_tactile_meta(buffer, 3, 3, levels, kCells);
  info->data = buffer;
  return GST_PAD_PROBE_OK;
}

/// A film of fifty frames. Each frame's cell plays when the frame is shown.
class SteppedPlayer : public Player
{
public:
  /// `rate` is the actuation rate, 0 for every frame.
  explicit SteppedPlayer(int rate = 0, int frames_per_second = 25)
      : Player("videotestsrc num-buffers=" + std::to_string(kFrames)
               + " ! video/x-raw,format=I420,width=32,height=32,framerate="
               + std::to_string(frames_per_second) + "/1 ! " + kSink
               + "rate=" + std::to_string(rate)
               + " tactors::compensation=none tactors::max-active=0 tactors::max-duty=0 "
                 "tactors::max-on-time=0 video-sink=visuotactiletestsink"),
        pad(gst_element_get_static_pad(chair, "sink"))
  {
    g_object_get(chair, "video-sink", &screen, nullptr);
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, add_map, nullptr, nullptr);
    change_state(pipeline, GST_STATE_PAUSED);
  }
  ~SteppedPlayer()
  {
    gst_object_unref(screen);
    gst_object_unref(pad);
  }

  void play_until_shown(gint frames)
  {
    change_state(pipeline, GST_STATE_PLAYING);
    while (g_atomic_int_get(&test_video_sink(screen)->frames) < frames)
      g_usleep(1000);
  }
  void let_time_pass(GstClockTime time)
  {
    g_autoptr(GstClock) clock = gst_pipeline_get_clock(GST_PIPELINE(pipeline));
    const GstClockID id = gst_clock_new_single_shot_id(clock, gst_clock_get_time(clock) + time);
    gst_clock_id_wait(id, nullptr);
    gst_clock_id_unref(id);
  }
  /// Steps one frame, the way players do.
  void step()
  {
    fail_unless(gst_element_send_event(
        pipeline, gst_event_new_step(GST_FORMAT_BUFFERS, 1, 1.0, TRUE, FALSE)));
    ck_assert_int_eq(gst_element_get_state(pipeline, nullptr, nullptr,
                                           static_cast<GstClockTime>(30) * GST_SECOND),
                     GST_STATE_CHANGE_SUCCESS);
  }
  gint64 position()
  {
    gint64 position = -1;
    fail_unless(gst_element_query_position(pipeline, GST_FORMAT_TIME, &position));
    return position;
  }
  std::size_t lines_of_trace()
  {
    return unwrap(tactor::read_command_trace(trace_file.path)).size();
  }
  /// From line `after` of the trace on, every command belongs to a frame that is shown at its time,
  /// from frame `from` on. A busy machine may skip commands.
  void assert_felt_is_seen(std::size_t after, guint64 from)
  {
    const std::vector<ShownFrame> shown = *test_video_sink(screen)->shown;
    const std::vector<IssuedCommand> lines = trace();
    guint felt = 0;
    for (std::size_t i = after; i < lines.size(); i++) {
      const tactor::Command &command = lines[i].command;
      if (command.volts == 0)
        continue;
      felt++;
      const bool is_seen = std::ranges::any_of(shown, [&](const ShownFrame &frame) {
        return frame.running == static_cast<GstClockTime>(command.effect.count())
               && frame.number >= from && cell_of(frame.number) == command.tactor;
      });
      fail_unless(is_seen, "tactor %d at %" GST_STIME_FORMAT, command.tactor,
                  GST_STIME_ARGS(command.effect.count()));
    }
    fail_unless(felt >= 5, "%u commands", felt);
  }

  GstPad *pad;
  GstElement *screen = nullptr;
};

} // namespace

/// Both sinks get the event, and upstream gets it once.
CHECK_TEST(test_events_reach_upstream_once)
{
  register_test_sink(GST_RANK_NONE);
  SteppedPlayer film;
  std::map<GstEventType, guint> heard;
  gst_pad_add_probe(
      film.pad, GST_PAD_PROBE_TYPE_EVENT_UPSTREAM,
      [](GstPad *, GstPadProbeInfo *info, gpointer data) {
        (*static_cast<std::map<GstEventType, guint> *>(data))[GST_EVENT_TYPE(info->data)]++;
        return GST_PAD_PROBE_OK;
      },
      &heard, nullptr);

  seek_exactly(film.chair, 1.0, GST_SECOND, GST_CLOCK_TIME_NONE);
  ck_assert_uint_eq(heard[GST_EVENT_SEEK], 1);
  ck_assert_int_eq(gst_element_get_state(film.pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE),
                   GST_STATE_CHANGE_SUCCESS);

  heard.clear();
  gst_element_send_event(film.chair, gst_event_new_latency(300 * kMs));
  ck_assert_uint_eq(heard[GST_EVENT_LATENCY], 1);
  g_autoptr(GObject) tactors
      = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(film.chair), "tactors");
  ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(tactors)), 300 * kMs);
  ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(film.screen)), 300 * kMs);

  gst_element_send_event(film.chair, gst_event_new_navigation(gst_structure_new_empty("key")));
  gst_element_send_event(film.chair, gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 1.0, 0, GST_SECOND));
  gst_element_send_event(film.chair, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                                                          gst_structure_new_empty("custom")));
  for (const GstEventType type : { GST_EVENT_NAVIGATION, GST_EVENT_QOS, GST_EVENT_CUSTOM_UPSTREAM })
    ck_assert_msg(heard[type] == 1, "%s: %u times", gst_event_type_get_name(type), heard[type]);

  // Events from the tactors' branch do not reach the picture's decoder.
  heard.clear();
  g_autoptr(GstPad) end = gst_element_get_static_pad(GST_ELEMENT(tactors), "sink");
  for (GstEvent *event : { gst_event_new_reconfigure(),
                           gst_event_new_seek(1.0, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                              GST_SEEK_TYPE_SET, 0, GST_SEEK_TYPE_NONE, 0) })
    gst_pad_push_event(end, event);
  fail_unless(heard.empty());
}

/// A step advances one frame, and its messages are those of any video sink.
CHECK_TEST(test_steps_once)
{
  register_test_sink(GST_RANK_NONE);
  SteppedPlayer film;
  for (gint64 i = 1; i <= 20; i++) {
    gst_bus_set_flushing(film.bus, TRUE);
    gst_bus_set_flushing(film.bus, FALSE);
    film.step();
    ck_assert_int_eq(film.position(), i * static_cast<gint64>(kFrame));
    guint64 begun = 0;
    guint64 done = 0;
    while (GstMessage *message = gst_bus_pop(film.bus)) {
      begun += GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_START;
      done += GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_DONE;
      gst_message_unref(message);
    }
    ck_assert_uint_eq(done, 1);
    ck_assert_uint_eq(begun, 2); // requested and begun
  }
}

/// Frames that were stepped over do not play. The visible frame and all later ones do, when they
/// are shown.
CHECK_TEST(test_motors_resume_with_the_visible_frame)
{
  register_test_sink(GST_RANK_NONE);
  for (const auto &[rate, frames_per_second] : { std::pair(0, 25), { 5, 25 }, { 5, 30 } }) {
    SteppedPlayer film(rate, frames_per_second);
    // At 30 Hz the last frame ends a third of a millisecond after this one begins.
    for (guint i = 0; i < 21; i++)
      film.step();
    film.play();
    film.assert_felt_is_seen(0, 21);
  }
}

/// The same in the middle of a film with maps in flight, and after a pause during which the clock
/// goes on.
CHECK_TEST(test_motors_go_on_after_a_pause)
{
  register_test_sink(GST_RANK_NONE);
  SteppedPlayer film;
  film.play_until_shown(15);
  change_state(film.pipeline, GST_STATE_PAUSED);
  const std::size_t before = film.lines_of_trace();
  film.let_time_pass(GST_SECOND / 2);
  for (guint i = 0; i < 5; i++)
    film.step();
  const auto seen = static_cast<guint64>(film.position()) / kFrame;
  fail_unless(seen >= 20);
  film.play();
  film.assert_felt_is_seen(before, seen);
}

/// Near the end the picture has frames left, but the tactors, which are ahead, do not. Stepping
/// still works.
CHECK_TEST(test_steps_at_the_end)
{
  register_test_sink(GST_RANK_NONE);
  SteppedPlayer film;
  g_autoptr(GstClock) clock = gst_test_clock_new();
  gst_pipeline_use_clock(GST_PIPELINE(film.pipeline), clock);
  change_state(film.pipeline, GST_STATE_PLAYING);
  const GstClockTime latency = gst_base_sink_get_latency(GST_BASE_SINK(film.screen));
  gst_test_clock_set_time(GST_TEST_CLOCK(clock), latency + (kFrames - 3) * kFrame);
  const auto pass_time_until = [&](const auto &done) {
    while (!done())
      if (GstClockID due = gst_test_clock_process_next_clock_id(GST_TEST_CLOCK(clock)))
        gst_clock_id_unref(due);
      else
        g_usleep(1000);
  };
  pass_time_until([&] {
    return g_atomic_int_get(&test_video_sink(film.screen)->frames)
           == static_cast<gint>(kFrames) - 2;
  });
  change_state(film.pipeline, GST_STATE_PAUSED);
  film.step();
  change_state(film.pipeline, GST_STATE_PLAYING);
  gst_test_clock_advance_time(GST_TEST_CLOCK(clock), 2 * GST_SECOND);
  pass_time_until([&] {
    g_autoptr(GstMessage) end = gst_bus_pop_filtered(film.bus, GST_MESSAGE_EOS);
    return end != nullptr;
  });
  film.finish();
  film.trace();
}

CHECK_MAIN(visuotactilesink_steps)
