// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink on a GstTestClock: all command times are exact, and nothing waits for real time.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/realtime.h"
#include "support/temporary_file.h"
#include <gst/check/gsttestclock.h>
#include <gst/tactile/tactile.h>

constexpr GstClockTime kMs = GST_MSECOND;
constexpr GstClockTime kFrame = 40 * kMs; // 25 fps, exact in ns
constexpr GstClockTime kLatency
    = 160 * kMs; // max-lead and the wake-up margin, as a pipeline would set it

/// Eq. 1 with Vs = 0, computed independently.
inline double
rise_ms(double volts)
{
  return 241.9 - 175.7 * volts + 38.86 * volts * volts;
}

inline GstClockTime
rise(double volts)
{
  return static_cast<GstClockTime>(std::llround(rise_ms(volts) * 1e6));
}

struct Line
{
  gint64 issued;
  gint64 due;
  gint64 effect;
  int tactor;
  double volts;
};

inline GstElement *
make_tactorsink()
{
  return GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
}

/// A tactorsink with a test clock, a bus and a trace. A streaming thread of its own pushes the
/// data.
class SinkRig
{
public:
  explicit SinkRig(const char *caps = "application/x-tactile-map,rows=1,columns=1,framerate=25/1")
      : element(make_tactorsink()), messages(element), caps_string(caps)
  {
    // Limits have their own tests.
    g_object_set(element, "driver", "simulator", "trace-location", trace_file.path.c_str(),
                 "max-lead", 150 * GST_MSECOND, "max-on-time", guint64{ 0 }, "max-duty", 0.0,
                 "max-active", 0u, "ramp-in", guint64{ 0 }, nullptr);
    clock = GST_TEST_CLOCK(gst_test_clock_new());
    gst_element_set_clock(element, GST_CLOCK(clock));
    gst_element_set_base_time(element, 0);
    sink_pad = gst_element_get_static_pad(element, "sink");
  }

  ~SinkRig()
  {
    finish();
    gst_object_unref(sink_pad);
    gst_object_unref(element);
    gst_object_unref(clock);
  }

  void start(const GstSegment *segment = nullptr, bool play = true)
  {
    g_object_set(element, "async", FALSE, nullptr);
    fail_if(gst_element_set_state(element, play ? GST_STATE_PLAYING : GST_STATE_PAUSED)
            == GST_STATE_CHANGE_FAILURE);
    fail_unless(gst_element_send_event(element, gst_event_new_latency(kLatency)));
    open(segment);
  }

  void open(const GstSegment *segment = nullptr)
  {
    GstSegment plain;
    gst_segment_init(&plain, GST_FORMAT_TIME);
    GstCaps *caps = gst_caps_from_string(caps_string.c_str());
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_stream_start("test")));
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_caps(caps)));
    gst_caps_unref(caps);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_segment(segment ? segment : &plain)));
  }

  /// Without compensation, commands are issued at their frames' times.
  void uncompensated()
  {
    g_object_set(element, "compensation", 2, nullptr);
  }

  /// Runs `work` in the streaming thread, after earlier work.
  void stream(std::function<void()> work)
  {
    if (pusher.joinable())
      pusher.join();
    pusher = std::thread(std::move(work));
  }

  void join()
  {
    if (pusher.joinable())
      pusher.join();
  }

  GstBuffer *buffer(GstClockTime pts, const std::vector<gfloat> &levels,
                    GstClockTime duration = kFrame)
  {
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = pts;
    GST_BUFFER_DURATION(map) = duration;
    return map;
  }

  GstFlowReturn push(GstClockTime pts, const std::vector<gfloat> &levels,
                     GstClockTime duration = kFrame)
  {
    return gst_pad_chain(sink_pad, buffer(pts, levels, duration));
  }

  /// Pushes maps of one level from `start` to `stop`.
  void push_level(GstClockTime start, GstClockTime stop, gfloat level)
  {
    for (GstClockTime pts = start; pts < stop; pts += kFrame)
      ck_assert_int_eq(push(pts, { level }), GST_FLOW_OK);
  }

  /// Sends caps of another grid from the streaming thread.
  void change_grid(guint rows, guint columns)
  {
    g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(rows, columns, 25, 1);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_caps(caps)));
  }

  void end()
  {
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_eos()));
  }

  /// Waits until `waiters` threads wait on the clock, and moves it to the earliest of their times.
  /// Returns the new time.
  GstClockTime step(guint waiters)
  {
    GList *pending = nullptr;
    gst_test_clock_wait_for_multiple_pending_ids(clock, waiters, &pending);
    g_list_free_full(pending, gst_clock_id_unref);
    const GstClockTime next = gst_test_clock_get_next_entry_time(clock);
    if (next > gst_clock_get_time(GST_CLOCK(clock)))
      gst_test_clock_set_time(clock, next);
    GstClockID id = gst_test_clock_process_next_clock_id(clock);
    fail_unless(id != nullptr);
    gst_clock_id_unref(id);
    rendered = true;
    return next;
  }

  /// Whether all threads now wait on the clock: the streaming thread and, after the first map, the
  /// scheduler, which then always has something to wait for. A single wait that is over is ended.
  /// Returns after a short time-out, so that the caller can check whether the work is done.
  bool all_asleep()
  {
    GList *pending = nullptr;
    const bool asleep
        = gst_test_clock_timed_wait_for_multiple_pending_ids(clock, rendered ? 2 : 1, 10, &pending);
    g_list_free_full(pending, gst_clock_id_unref);
    if (asleep)
      return true;
    const GstClockTime next = gst_test_clock_get_next_entry_time(clock);
    if (next != GST_CLOCK_TIME_NONE && next <= gst_clock_get_time(GST_CLOCK(clock)))
      if (GstClockID id = gst_test_clock_process_next_clock_id(clock))
        gst_clock_id_unref(id);
    return false;
  }

  /// Ends every wait that is over.
  void wake_all_due()
  {
    while (GstClockID id = gst_test_clock_process_next_clock_id(clock))
      gst_clock_id_unref(id);
    std::this_thread::yield();
  }

  /// Runs the clock to `time`. The streaming thread must still be waiting to render something
  /// later.
  void run_to(GstClockTime time)
  {
    for (;;) {
      while (!all_asleep())
        ;
      if (gst_test_clock_get_next_entry_time(clock) > time)
        break;
      step(rendered ? 2 : 1);
    }
    gst_test_clock_set_time(clock, time);
  }

  /// Does the work in the streaming thread and runs the clock until it is done.
  void run_out(const std::function<void()> &work)
  {
    std::atomic<bool> done{ false };
    stream([&] {
      work();
      done = true;
    });
    while (!done)
      if (all_asleep())
        step(rendered ? 2 : 1);
    join();
  }

  /// The same, followed by EOS.
  void run_to_end(const std::function<void()> &work)
  {
    run_out([&] {
      work();
      end();
    });
  }

  /// Starts, pushes with `work`, and ends the stream.
  void play(const std::function<void()> &work)
  {
    start();
    run_to_end(work);
  }

  void finish()
  {
    if (!finished) {
      finished = true;
      gst_element_set_state(element, GST_STATE_NULL);
      join();
    }
  }

  std::vector<Line> trace()
  {
    finish();
    std::vector<Line> lines;
    std::ifstream file(trace_file.path);
    std::string text;
    std::getline(file, text);
    ck_assert_str_eq(text.c_str(), "issued_ns,due_ns,effect_ns,tactor,volts");
    while (std::getline(file, text)) {
      Line line;
      char comma;
      std::istringstream in(text);
      const bool read = bool(in >> line.issued >> comma >> line.due >> comma >> line.effect >> comma
                             >> line.tactor >> comma >> line.volts);
      fail_unless(read, "bad line: %s", text.c_str());
      lines.push_back(line);
    }
    return lines;
  }

  guint64 stat(const char *field)
  {
    return actuation_stat_of(element, field);
  }

  GstElement *element;
  ElementBus messages;
  GstTestClock *clock;
  GstPad *sink_pad;
  TemporaryFile trace_file;
  std::string caps_string;
  std::thread pusher;
  bool rendered = false; ///< the scheduler has something to wait for
  bool finished = false;
};

inline void
assert_line(const Line &line, GstClockTime issued, GstClockTime due, GstClockTime effect,
            int tactor, double volts)
{
  ck_assert_int_eq(line.issued, static_cast<gint64>(issued));
  ck_assert_int_eq(line.due, static_cast<gint64>(due));
  ck_assert_int_eq(line.effect, static_cast<gint64>(effect));
  ck_assert_int_eq(line.tactor, tactor);
  fail_unless(std::abs(line.volts - (volts)) <= 5e-4);
}

/// Each motor's last command must be zero.
inline void
assert_silent_at_end(const std::vector<Line> &lines)
{
  std::map<int, double> last;
  for (const Line &line : lines)
    last[line.tactor] = line.volts;
  for (const auto &[tactor, volts] : last)
    fail_unless(volts == 0, "tactor %d is left at %g V", tactor, volts);
}
