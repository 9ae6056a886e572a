// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A chair whose motors all differ, played by tactorsink with and without calibration.
#include "calibration/calibration.h"
#include "calibration/rise_time_fit.h"
#include "support/measured_chair.h"
#include "tactor/command_trace.h"
#include "tactor/motor_model.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "support/contains.h"
#include "support/playing.h"
#include "support/temporary_file.h"
#include "support/tolerance.h"
#include "support/unwrap.h"
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr int kTactors = 4;

/// Motors of different rise times and latencies.
std::vector<MotorParameters>
chair()
{
  std::vector<MotorParameters> motors;
  for (int i = 0; i < kTactors; i++) {
    RiseTimeTable table{ .step_volts = 0.1, .size = 31, .milliseconds = {} };
    for (int start = 0; start < 31; start++)
      for (int target = 0; target < 31; target++)
        table.milliseconds.push_back((0.5 + 0.25 * i)
                                     * (30 + 130 * std::exp(-0.1 * (target - 0.3 * start) / 0.9)));
    motors.push_back({ .rise_time = RiseTime(table), .latency = (3 + 7 * i) * 1ms });
  }
  return motors;
}

/// Plays one second of rest, then a random map every half second.
void
play(const std::string &calibration, const std::string &trace)
{
  GstElement *pipeline
      = make_pipeline("appsrc name=maps format=time max-bytes=0 "
                      "caps=application/x-tactile-map,rows=1,columns=4,framerate=0/1 ! "
                      "tactorsink name=sink driver=simulator sync=false rate=0 max-on-time=0 "
                      "max-duty=0 max-active=0");
  GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  GstElement *maps = gst_bin_get_by_name(GST_BIN(pipeline), "maps");
  g_object_set(sink, "trace-location", trace.c_str(), nullptr);
  if (!calibration.empty())
    g_object_set(sink, "calibration", calibration.c_str(), nullptr);

  std::mt19937 random(11);
  std::uniform_real_distribution<float> level(0.25F, 1.0F);
  std::bernoulli_distribution on(0.6);
  for (int i = 0; i < 200; i++) {
    std::vector<gfloat> levels(kTactors);
    for (gfloat &value : levels)
      value = i > 1 && on(random) ? level(random) : 0;
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = static_cast<GstClockTime>(i) * 500 * GST_MSECOND;
    GST_BUFFER_DURATION(map) = 500 * GST_MSECOND;
    GstFlowReturn ret;
    g_signal_emit_by_name(maps, "push-buffer", map, &ret);
    gst_buffer_unref(map);
    fail_unless_equals_int(ret, GST_FLOW_OK);
  }
  GstFlowReturn ret;
  g_signal_emit_by_name(maps, "end-of-stream", &ret);
  gst_object_unref(maps);
  gst_object_unref(sink);
  play_to_the_end(pipeline);
}

/// For each rise, the time in ms between the frame and 90 % of the vibration, sorted.
std::vector<double>
errors(const std::string &path)
{
  const std::vector<IssuedCommand> trace = unwrap(read_command_trace(path));
  const std::vector<MotorParameters> motors = chair();
  std::vector<double> result;
  for (int tactor = 0; tactor < kTactors; tactor++) {
    std::vector<IssuedCommand> own;
    for (const IssuedCommand &issued : trace)
      if (issued.command.tactor == tactor)
        own.push_back(issued);
    fail_unless(own.size() > 50);
    fail_unless(own.back().command.volts == 0);
    MotorModel motor(motors[static_cast<std::size_t>(tactor)]);
    const Time latency = *motor.parameters().latency;
    for (std::size_t i = 0; i < own.size(); i++) {
      const Time at = own[i].issued + latency;
      const double goal = 0.9 * own[i].command.volts;
      const bool rises = motor.amplitude(at) < goal;
      motor.set(at, own[i].command.volts);
      if (!rises)
        continue;
      const Time until = i + 1 < own.size() ? own[i + 1].issued + latency : at + 1s;
      Time arrival = at;
      while (arrival < until && motor.amplitude(arrival) < goal)
        arrival += 50us;
      result.push_back(
          std::abs(static_cast<double>((arrival - own[i].command.effect).count()) / 1e6));
    }
  }
  std::ranges::sort(result);
  return result;
}

double
percentile(const std::vector<double> &sorted, double share)
{
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

} // namespace

CHECK_TEST(error_falls_with_the_calibration)
{
  std::vector<StepResponse> responses
      = measure({ .tactors = { 0, 1, 2, 3 }, .repetitions = 2 }, chair(),
                { .gains = { 1, 0.8, 1.2, 0.9 }, .separate = true, .noise = 0.002 });
  const Calibration calibration = calibrate(responses);
  fail_unless(calibration.tactors.size() == kTactors);
  const TemporaryFile file;
  const TemporaryFile trace;
  write_calibration(calibration, file.path);

  play("", trace.path);
  const std::vector<double> without = errors(trace.path);
  play(file.path, trace.path);
  const std::vector<double> with = errors(trace.path);
  std::printf("%zu rises: p50 %.1f, p95 %.1f, max %.1f ms without; %zu: p50 %.1f, p95 %.1f, max "
              "%.1f ms with\n",
              without.size(), percentile(without, 0.5), percentile(without, 0.95), without.back(),
              with.size(), percentile(with, 0.5), percentile(with, 0.95), with.back());
  fail_unless(percentile(without, 0.5) > 10);
  fail_unless(percentile(without, 0.95) > 30);
  fail_unless_at_most(percentile(with, 0.95), 5);
}

static void
expect_error(const gchar *path, const gchar *says)
{
  g_autoptr(GstElement) sink = gst_element_factory_make("tactorsink", nullptr);
  const ElementBus messages(sink);
  g_object_set(sink, "driver", "simulator", "calibration", path, nullptr);
  fail_unless_equals_int(gst_element_set_state(sink, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  const Said said = messages.said(GST_MESSAGE_ERROR);
  fail_unless(said.domain == GST_RESOURCE_ERROR && said.code == GST_RESOURCE_ERROR_SETTINGS);
  assert_contains(said.text, { says });
  gst_element_set_state(sink, GST_STATE_NULL);
}

CHECK_TEST(invalid_calibrations_are_refused)
{
  expect_error("/nowhere/motors.calibration", "/nowhere/motors.calibration");
  const TemporaryFile file;
  std::ofstream(file.path) << "[Calibration]\nversion=1\n[Tactor 0]\nlatency-ms=late\n";
  expect_error(file.path.c_str(), "latency-ms");
}

// Motors slower than max-lead cannot be on time, which causes a warning.
CHECK_TEST(too_short_a_lead_causes_a_warning)
{
  const TemporaryFile file;
  Calibration slow{ .tactors = { { 0, {} } } };
  slow.tactors[0].table
      = RiseTimeTable{ .step_volts = 3, .size = 2, .milliseconds = { 300, 300, 300, 300 } };
  write_calibration(slow, file.path);
  for (const guint64 lead : { 180 * GST_MSECOND, 400 * GST_MSECOND }) {
    g_autoptr(GstElement) sink = gst_element_factory_make("tactorsink", nullptr);
    const ElementBus messages(sink);
    g_object_set(sink, "driver", "simulator", "calibration", file.path.c_str(), "max-lead", lead,
                 nullptr);
    fail_if(gst_element_set_state(sink, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    fail_unless(messages.has(GST_MESSAGE_WARNING) == (lead == 180 * GST_MSECOND));
    gst_element_set_state(sink, GST_STATE_NULL);
  }
}

CHECK_MAIN(tactorsink_calibration)
