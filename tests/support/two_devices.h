// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Two devices that play one stream of maps in one pipeline, each with rise times of its own. Maps
// are of 1 × 2: the left cell is on in the 2nd and 5th map, the right one in the 3rd.
#pragma once

#include "calibration/calibration.h"
#include "support/temporary_file.h"
#include "support/threads_at_rest.h"
#include "support/unwrap.h"
#include "tactor/command_trace.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "support/playing.h"
#include "support/tolerance.h"
#include <gst/base/gstbasesink.h>
#include <gst/check/gsttestclock.h>
#include <gst/tactile/tactile.h>

/// All motors of the second device take this long to any level.
inline constexpr double kSlowRiseMs = 120;

/// What tells that the two are in time.
namespace two_devices {

inline constexpr GstClockTime kMap = 200 * GST_MSECOND;

/// A change that each device makes.
struct Step
{
  int map;
  int tactor;
  double volts;

  std::chrono::nanoseconds effect() const
  {
    return std::chrono::nanoseconds(static_cast<gint64>(kMap) * map);
  }
};

inline const std::vector<Step> kSteps{ { 1, 0, 3 }, { 2, 1, 3 }, { 2, 0, 0 },
                                       { 3, 1, 0 }, { 4, 0, 3 }, { 5, 0, 0 } };

inline constexpr const char *kSource
    = "appsrc name=maps format=time caps=application/x-tactile-map,rows=1,columns=2,"
      "framerate=5/1 ! tee name=t ";

/// Pushes all maps to kSource, and the end.
inline void
push_film(GstElement *pipeline)
{
  GstElement *maps = gst_bin_get_by_name(GST_BIN(pipeline), "maps");
  const std::vector<std::vector<gfloat>> film{ { 0, 0 }, { 1, 0 }, { 0, 1 },
                                               { 0, 0 }, { 1, 0 }, { 0, 0 } };
  GstFlowReturn flow;
  for (std::size_t i = 0; i < film.size(); i++) {
    g_autoptr(GstBuffer) map = gst_tactile_map_buffer_new(film[i].data(), film[i].size());
    GST_BUFFER_PTS(map) = i * kMap;
    GST_BUFFER_DURATION(map) = kMap;
    g_signal_emit_by_name(maps, "push-buffer", map, &flow);
  }
  g_signal_emit_by_name(maps, "end-of-stream", &flow);
  gst_object_unref(maps);
}

/// Of a sink in the pipeline. Running time is the same for all; so has to be what is added to it.
inline GstClockTime
latency(GstElement *pipeline, const char *name)
{
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), name);
  return gst_base_sink_get_latency(GST_BASE_SINK(sink));
}

/// A trace has the effects of all steps at their times, each issued early by the rise time.
inline void
expect_steps(const std::string &path, double rise_ms)
{
  const std::vector<tactor::IssuedCommand> trace = unwrap(tactor::read_command_trace(path));
  ck_assert_uint_eq(trace.size(), kSteps.size());
  for (const Step &step : kSteps) {
    const auto found = std::ranges::find_if(trace, [&](const tactor::IssuedCommand &one) {
      return one.command.effect == step.effect() && one.command.tactor == step.tactor;
    });
    fail_unless(found != trace.end(), "no command for map %d, tactor %d", step.map, step.tactor);
    fail_unless_near(found->command.volts, step.volts, 1e-3);
    const double lead_ms = std::chrono::duration<double, std::milli>(found->command.lead).count();
    fail_unless_near(lead_ms, step.volts > 0 ? rise_ms : 0, 0.01);
    const auto late = found->issued - (step.effect() - found->command.lead);
    fail_unless(late >= std::chrono::nanoseconds(0) && late <= std::chrono::milliseconds(1),
                "%lld ns late", static_cast<long long>(late.count()));
  }
}

/// Moves a clock from wait to wait, each time all threads have done what they could: to the end of
/// the stream, or to the first wait past `until`.
inline void
run_out(GstElement *pipeline, GstTestClock *clock, GstClockTime until = GST_CLOCK_TIME_NONE)
{
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  constexpr auto kEnds = static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  for (;;) {
    GstClockID next = nullptr;
    if (other_threads_rest() && gst_test_clock_peek_next_pending_id(clock, &next)) {
      const GstClockTime time = gst_clock_id_get_time(next);
      gst_clock_id_unref(next);
      if (time > until)
        return;
      if (time > gst_clock_get_time(GST_CLOCK(clock)))
        gst_test_clock_set_time(clock, time);
      if (GstClockID id = gst_test_clock_process_next_clock_id(clock))
        gst_clock_id_unref(id);
    }
    if (g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, GST_MSECOND, kEnds)) {
      fail_unless_equals_int(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
      return;
    }
  }
}

/// Eq. 1 of the paper, from rest to 3 V.
inline constexpr double kPaperRiseMs = 241.9 - 175.7 * 3 + 38.86 * 9;

} // namespace two_devices

/// Two tactorsinks. The motors of the second one take kSlowRiseMs.
class TwoDevices
{
public:
  /// `first` and `second` are properties of the two tactorsinks.
  TwoDevices(const std::string &first, const std::string &second)
  {
    tactor::Calibration slow;
    for (const int tactor : { 0, 1 })
      slow.tactors[tactor].table = tactor::RiseTimeTable{
        .step_volts = 1, .size = 4, .milliseconds = std::vector<double>(16, kSlowRiseMs)
      };
    unwrap(tactor::write_calibration(slow, calibration_.path));
    const std::string common = " rate=0 ramp-in=0 max-duty=0 trace-location=";
    pipeline_ = make_pipeline(two_devices::kSource + ("t. ! queue ! tactorsink name=first " + first)
                              + common + traces_[0].path
                              + " t. ! queue ! tactorsink name=second calibration="
                              + calibration_.path + " " + second + common + traces_[1].path);
    gst_pipeline_use_clock(GST_PIPELINE(pipeline_), clock_);
    two_devices::push_film(pipeline_);
    change_state(pipeline_, GST_STATE_PLAYING);
  }
  ~TwoDevices()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(clock_);
    gst_object_unref(pipeline_);
  }
  TwoDevices(const TwoDevices &) = delete;
  TwoDevices &operator=(const TwoDevices &) = delete;

  /// Plays up to a running time: all that is due by then was done.
  void play_until(GstClockTime time)
  {
    two_devices::run_out(pipeline_, GST_TEST_CLOCK(clock_),
                         time + two_devices::latency(pipeline_, "first"));
  }

  /// Plays to the end: both were given the same effects at the same times.
  void expect_one_film()
  {
    two_devices::run_out(pipeline_, GST_TEST_CLOCK(clock_));
    ck_assert_uint_eq(two_devices::latency(pipeline_, "first"),
                      two_devices::latency(pipeline_, "second"));
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    two_devices::expect_steps(traces_[0].path, two_devices::kPaperRiseMs);
    two_devices::expect_steps(traces_[1].path, kSlowRiseMs);
  }

private:
  TemporaryFile calibration_;
  TemporaryFile traces_[2];
  GstClock *clock_ = gst_test_clock_new();
  GstElement *pipeline_ = nullptr;
};
