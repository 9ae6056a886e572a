// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What each family of devices does, as its own server or gamepad sees it: how long motors go on
// after a play ends, when a motor reaches its level, how many messages a slow server has waiting,
// and CPU time. Prints Markdown tables. Devices are those of device_families.h.
#include "device_families.h"

#include "support/boards/emulated_usb.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "support/playing.h"
#include "support/temporary_file.h"
#include <gst/base/gstbasesink.h>
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using tactor::Time;
using Clock = std::chrono::steady_clock;

namespace {

Time
now()
{
  return Clock::now().time_since_epoch();
}

double
ms(Time time)
{
  return std::chrono::duration<double, std::milli>(time).count();
}

void
push(GstElement *maps, float level, GstClockTime pts, GstClockTime duration)
{
  g_autoptr(GstBuffer) map = gst_tactile_map_buffer_new(&level, 1);
  GST_BUFFER_PTS(map) = pts;
  GST_BUFFER_DURATION(map) = duration;
  GstFlowReturn flow;
  g_signal_emit_by_name(maps, "push-buffer", map, &flow);
}

void
end(GstElement *maps)
{
  GstFlowReturn flow;
  g_signal_emit_by_name(maps, "end-of-stream", &flow);
}

GstElement *
child(GstElement *pipeline, const char *name)
{
  GstElement *found = gst_bin_get_by_name(GST_BIN(pipeline), name);
  gst_object_unref(found); // the pipeline keeps it
  return found;
}

GstElement *
make_player(const Device &device, const std::string &properties = "")
{
  return make_pipeline(
      "appsrc name=maps format=time "
      "caps=application/x-tactile-map,rows=1,columns=1,framerate=25/1 ! queue max-size-time=0 "
      "max-size-buffers=0 ! "
      + device.sink + " name=tactors mapping=0 rate=0 max-on-time=0 max-duty=0 " + properties);
}

/// When the map of time 0 is shown, on the steady clock. While it plays: a sound card's clock is
/// another one.
Time
first_frame(GstElement *pipeline, const Device &device)
{
  GstElement *sink = child(pipeline, device.own.empty() ? "tactors" : device.own.c_str());
  g_autoptr(GstClock) clock = gst_element_get_clock(sink);
  const Time before = now();
  const Time on_clock(static_cast<gint64>(gst_clock_get_time(clock)));
  const Time shown(static_cast<gint64>(gst_element_get_base_time(sink)
                                       + gst_base_sink_get_latency(GST_BASE_SINK(sink))));
  return shown + (before - on_clock);
}

/* ---- ways out ---- */

/// A motor that is on for 20 s.
GstElement *
play_on(Device &device, bool to_the_end)
{
  GstElement *pipeline = make_player(device);
  for (GstClockTime i = 0; i < (to_the_end ? 25 : 500); i++)
    push(child(pipeline, "maps"), 1, i * 40 * GST_MSECOND, 40 * GST_MSECOND);
  const Time begin = now();
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  device.wait_for(begin, true);
  return pipeline;
}

struct Way
{
  const char *name;
  void (*take)(GstElement *pipeline);
};

const Way kWays[] = {
  { "pause",
    [](GstElement *pipeline) {
      gst_element_set_state(pipeline, GST_STATE_PAUSED);
    } },
  { "flush (seek)",
    [](GstElement *pipeline) {
      g_autoptr(GstPad) pad = gst_element_get_static_pad(child(pipeline, "tactors"), "sink");
      gst_pad_send_event(pad, gst_event_new_flush_start());
    } },
  { "error",
    [](GstElement *pipeline) {
      GST_ELEMENT_ERROR(child(pipeline, "maps"), STREAM, FAILED, ("test"), (nullptr));
      g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
      g_autoptr(GstMessage) message
          = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ERROR);
      gst_element_set_state(pipeline, GST_STATE_NULL);
    } },
  { "stop",
    [](GstElement *pipeline) {
      gst_element_set_state(pipeline, GST_STATE_NULL);
    } },
};

/// After the end of the last map, when the motor should end.
double
after_eos(const Family &family)
{
  const std::unique_ptr<Device> device = family.make(false);
  GstElement *pipeline = play_on(*device, true);
  end(child(pipeline, "maps"));
  const Time on = now();
  const Time end = first_frame(pipeline, *device) + 25 * 40ms;
  wait_for_eos(pipeline);
  const Time zero = device->wait_for(on, false).at;
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return ms(zero - end);
}

/// gst-launch-1.0 with a track, which SIGTERM ends.
double
after_signal(const Family &family)
{
  const std::unique_ptr<Device> device = family.make(false);
  const TemporaryFile track("WEBVTT\n\nNOTE tactile grid=1x1 rate=5\n\n"
                            "00:00:00.000 --> 00:00:30.000\n100\n",
                            ".vtt");
  const std::string line = "exec gst-launch-1.0 -q filesrc location=" + track.path
                           + " ! subparse ! tactileconverter ! " + device->sink
                           + " mapping=0 max-on-time=0 max-duty=0";
  const Time begin = now();
  const pid_t pid = fork();
  if (pid == 0) {
    (void)std::freopen("/dev/null", "w", stderr);
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  device->wait_for(begin, true);
  const Time sent = now();
  kill(pid, SIGTERM);
  const Time zero = device->wait_for(sent, false).at;
  waitpid(pid, nullptr, 0);
  return ms(zero - sent);
}

void
print_ways_out()
{
  std::printf("| device | listed | end of stream |");
  for (const Way &way : kWays)
    std::printf(" %s |", way.name);
  std::printf(" SIGTERM |\n|---|---|---|---|---|---|---|---|\n");
  for (const Family &family : families()) {
    std::printf("| %s | %s | %.0f ms |", family.name.c_str(), family.is_listed ? "yes" : "no",
                after_eos(family));
    for (const Way &way : kWays) {
      const std::unique_ptr<Device> device = family.make(false);
      GstElement *pipeline = play_on(*device, false);
      const Time begin = now();
      way.take(pipeline);
      std::printf(" %.0f ms |", std::max(0.0, ms(device->wait_for(begin, false).at - begin)));
      gst_element_set_state(pipeline, GST_STATE_NULL);
      gst_object_unref(pipeline);
    }
    if (family.has_own_process)
      std::printf(" %.0f ms |\n", after_signal(family));
    else
      std::printf(" – |\n");
    std::fflush(stdout);
  }
}

/* ---- when levels arrive ---- */

constexpr int kRises = 30;
constexpr GstClockTime kHalf = 400 * GST_MSECOND;

double
cpu_seconds()
{
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval &time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// When `motor`, at rest, with these changes reaches 90 % of `volts`, from `from` to `until`.
Time
arrival(tactor::MotorModel motor, const std::vector<Device::Change> &changes, double volts,
        Time from, Time until)
{
  std::size_t next = 0;
  for (Time at = from; at < until; at += 100us) {
    for (; next < changes.size() && changes[next].at <= at; next++)
      motor.set(changes[next].at, changes[next].level * kVolts);
    if (motor.amplitude(at) >= 0.9 * volts)
      return at;
  }
  return until;
}

void
print_timing()
{
  std::printf("| device | rises | error of the 90 %% p50 | p95 | later by, median | in flight, "
              "slow server | CPU |\n|---|---|---|---|---|---|---|\n");
  for (const Family &family : families()) {
    const std::unique_ptr<Device> device = family.make(false);
    GstElement *pipeline = make_player(*device, "ramp-in=0");
    std::mt19937 random(7);
    std::uniform_int_distribution<int> tenth(4, 10);
    std::vector<double> levels;
    for (GstClockTime i = 0; i < kRises; i++) {
      levels.push_back(0.1 * tenth(random));
      push(child(pipeline, "maps"), 0, 2 * i * kHalf, kHalf);
      push(child(pipeline, "maps"), static_cast<float>(levels.back()), (2 * i + 1) * kHalf, kHalf);
    }
    end(child(pipeline, "maps"));
    gst_element_set_state(pipeline, GST_STATE_PAUSED);
    gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    const double cpu = cpu_seconds();
    const Time begin = now();
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    device->wait_for(begin, true);
    const Time zero = first_frame(pipeline, *device);
    wait_for_eos(pipeline);
    const double share = (cpu_seconds() - cpu) / (ms(now() - begin) / 1000);
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
    const std::vector<Device::Change> changes = device->changes();
    std::vector<double> late;
    std::vector<double> error;
    for (int i = 0; i < kRises; i++) {
      const Time frame = zero + (2 * i + 1) * Time(kHalf);
      const double volts = kVolts * levels[static_cast<std::size_t>(i)];
      // Levels are rounded on their way.
      late.push_back(ms(
          arrival(family.motor(), changes, volts * 0.999, frame - 350ms, frame + 390ms) - frame));
      error.push_back(std::abs(late.back()));
    }
    std::ranges::sort(late);
    std::ranges::sort(error);
    std::printf("| %s | %d | %.1f ms | %.1f ms | %+.1f ms |", family.name.c_str(), kRises,
                error[kRises / 2], error[kRises * 95 / 100], late[kRises / 2]);
    if (family.answers) {
      const std::unique_ptr<Device> slow = family.make(true);
      GstElement *busy = make_player(*slow, "compensation=none");
      for (GstClockTime i = 0; i < 150; i++)
        push(child(busy, "maps"), i % 2 ? 1 : 0.5F, i * 40 * GST_MSECOND, 40 * GST_MSECOND);
      end(child(busy, "maps"));
      gst_element_set_state(busy, GST_STATE_PLAYING);
      wait_for_eos(busy);
      // While it plays: what stops the device does not wait for an answer.
      const std::vector<std::size_t> waiting = slow->waiting();
      gst_element_set_state(busy, GST_STATE_NULL);
      gst_object_unref(busy);
      std::printf(" %zu (of %zu) |", std::ranges::max(waiting) + 1, waiting.size());
    } else {
      std::printf(" – |");
    }
    std::printf(" %.2f %% |\n", 100 * share);
    std::fflush(stdout);
  }
}

} // namespace

CHECK_TEST(test_ways_out)
{
  print_ways_out();
}

CHECK_TEST(test_timing)
{
  print_timing();
}

CHECK_MAIN_AFTER(devices, 300, usb_test::begin_emulation())
