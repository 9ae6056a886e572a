// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What each family of devices does, as its own server or gamepad sees it: how long motors go on
// after a play ends, when a motor reaches its level, how many messages a slow server has waiting,
// and CPU time. Prints Markdown tables. Devices are SDL's virtual gamepad and the servers of
// tests/support/haptic_server.py.
#include "support/haptic_server.h"
#ifdef HAVE_GAMEPAD
#include "support/virtual_gamepad.h"
#endif

#include "tactor/motor_model.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "support/playing.h"
#include "support/temporary_file.h"
#include <gst/base/gstbasesink.h>
#include <gst/tactile/tactile.h>

using namespace std::chrono_literals;
using tactor::Time;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double kVolts = 3;

/// A level of the device's first motor, and when the device had it.
struct Change
{
  Time at; ///< steady time
  double level;
};

struct Family
{
  const char *name;
  const char *driver;
  const char *kind;   ///< of the server; null: a gamepad
  const char *device; ///< of the server
  double full;        ///< how the server prints level 1
};

const std::vector<Family> kFamilies{
  { "bHaptics", "bhaptics", "bhaptics", "vest-back", 100 },
  { "Intiface, version 3", "intiface", "buttplug3", "Test Vibrator", 1 },
  { "Intiface, version 4", "intiface", "buttplug4", "Test Vibrator", 20 },
#ifdef HAVE_GAMEPAD
  { "gamepad", "gamepad", nullptr, "virtual pad", 65535 },
#endif
};

/// A device, and all that its first motor did.
class Device
{
public:
  explicit Device(const Family &family, std::vector<std::string> options = {})
      : properties(std::string("driver=") + family.driver)
  {
    if (family.kind != nullptr) {
      options.insert(options.begin(), family.kind);
      server = std::make_unique<HapticServer>(
          options, [this, full = family.full](const std::string &line, Clock::time_point at) {
            if (line.starts_with("motors "))
              add({ at.time_since_epoch(), first_of(line) / full });
          });
      properties += " device=\"" + server->device(family.device) + "\"";
      return;
    }
#ifdef HAVE_GAMEPAD
    pad_ = std::make_unique<VirtualPad>(family.device, true, [this, &family](int low, int) {
      add({ Clock::now().time_since_epoch(), low / family.full });
    });
#endif
    properties += std::string(" device=\"") + family.device + "\"";
  }

  /// Waits for a change that `is_it`, among those from `begin` on.
  Change wait_for(Time begin, bool on)
  {
    std::unique_lock lock(mutex_);
    std::vector<Change>::iterator found;
    const auto is_it = [&] {
      found = std::ranges::find_if(changes_, [&](const Change &change) {
        return change.at >= begin && (change.level > 0) == on;
      });
      return found != changes_.end();
    };
    fail_unless(changed_.wait_for(lock, 30s, is_it), "the motor did not go %s", on ? "on" : "off");
    return *found;
  }
  std::vector<Change> changes()
  {
    const std::lock_guard lock(mutex_);
    return changes_;
  }

  std::string properties; ///< of tactorsink

private:
  /// Of motor 0 in a line "motors WHERE 0=LEVEL ...".
  static double first_of(const std::string &line)
  {
    const std::size_t at = line.find(" 0=");
    return at == std::string::npos ? 0 : g_ascii_strtod(line.c_str() + at + 3, nullptr);
  }
  void add(const Change &change)
  {
    const std::lock_guard lock(mutex_);
    changes_.push_back(change);
    changed_.notify_all();
  }

  std::mutex mutex_; ///< guards what follows
  std::condition_variable changed_;
  std::vector<Change> changes_;
#ifdef HAVE_GAMEPAD
  std::unique_ptr<VirtualPad> pad_;
#endif

public:
  std::unique_ptr<HapticServer> server; ///< of a family that has one; ends before the changes do
};

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

constexpr const char *kLine
    = "appsrc name=maps format=time "
      "caps=application/x-tactile-map,rows=1,columns=1,framerate=25/1 ! queue max-size-time=0 "
      "max-size-buffers=0 ! tactorsink name=tactors mapping=0 rate=0 max-on-time=0 max-duty=0 ";

/* ---- ways out ---- */

/// A motor that is on for 20 s.
GstElement *
play_on(Device &device, bool to_the_end)
{
  GstElement *pipeline = make_pipeline(kLine + device.properties);
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
  Device device(family);
  GstElement *pipeline = play_on(device, true);
  GstElement *sink = child(pipeline, "tactors");
  end(child(pipeline, "maps"));
  const Time on = now();
  wait_for_eos(pipeline);
  const Time zero = device.wait_for(on, false).at;
  const Time end(static_cast<gint64>(gst_element_get_base_time(sink)
                                     + gst_base_sink_get_latency(GST_BASE_SINK(sink))
                                     + 25 * 40 * GST_MSECOND));
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return ms(zero - end);
}

/// gst-launch-1.0 with a track, which SIGTERM ends.
double
after_signal(const Family &family)
{
  Device device(family);
  const TemporaryFile track("WEBVTT\n\nNOTE tactile grid=1x1 rate=5\n\n"
                            "00:00:00.000 --> 00:00:30.000\n100\n",
                            ".vtt");
  const std::string line = "exec gst-launch-1.0 -q filesrc location=" + track.path
                           + " ! subparse ! tactileconverter ! tactorsink mapping=0 max-on-time=0 "
                             "max-duty=0 "
                           + device.properties;
  const Time begin = now();
  const pid_t pid = fork();
  if (pid == 0) {
    (void)std::freopen("/dev/null", "w", stderr);
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  device.wait_for(begin, true);
  const Time sent = now();
  kill(pid, SIGTERM);
  const Time zero = device.wait_for(sent, false).at;
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
  for (const Family &family : kFamilies) {
    std::printf("| %s | %s | %.0f ms |", family.name, family.kind ? "no" : "yes",
                after_eos(family));
    for (const Way &way : kWays) {
      Device device(family);
      GstElement *pipeline = play_on(device, false);
      const Time begin = now();
      way.take(pipeline);
      std::printf(" %.0f ms |", ms(device.wait_for(begin, false).at - begin));
      gst_element_set_state(pipeline, GST_STATE_NULL);
      gst_object_unref(pipeline);
    }
    if (family.kind)
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

/// When a motor with these changes reaches 90 % of `volts`, from `from` to `until`.
Time
arrival(const std::vector<Change> &changes, double volts, Time from, Time until)
{
  tactor::MotorModel motor;
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
  for (const Family &family : kFamilies) {
    Device device(family);
    GstElement *pipeline = make_pipeline(kLine + std::string("ramp-in=0 ") + device.properties);
    GstElement *sink = child(pipeline, "tactors");
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
    wait_for_eos(pipeline);
    const double share = (cpu_seconds() - cpu) / (ms(now() - begin) / 1000);
    const gint64 zero = static_cast<gint64>(gst_element_get_base_time(sink)
                                            + gst_base_sink_get_latency(GST_BASE_SINK(sink)));
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
    const std::vector<Change> changes = device.changes();
    std::vector<double> late;
    std::vector<double> error;
    for (int i = 0; i < kRises; i++) {
      const Time frame(zero + (2 * i + 1) * static_cast<gint64>(kHalf));
      const double volts = kVolts * levels[static_cast<std::size_t>(i)];
      // Levels are rounded on their way.
      late.push_back(ms(arrival(changes, volts * 0.999, frame - 350ms, frame + 390ms) - frame));
      error.push_back(std::abs(late.back()));
    }
    std::ranges::sort(late);
    std::ranges::sort(error);
    std::printf("| %s | %d | %.1f ms | %.1f ms | %+.1f ms |", family.name, kRises,
                error[kRises / 2], error[kRises * 95 / 100], late[kRises / 2]);
    if (family.kind) {
      Device slow(family, { "slow=200" });
      GstElement *busy = make_pipeline(kLine + std::string("compensation=none ") + slow.properties);
      for (GstClockTime i = 0; i < 150; i++)
        push(child(busy, "maps"), i % 2 ? 1 : 0.5F, i * 40 * GST_MSECOND, 40 * GST_MSECOND);
      end(child(busy, "maps"));
      gst_element_set_state(busy, GST_STATE_PLAYING);
      wait_for_eos(busy);
      // While it plays: what stops the device does not wait for an answer.
      const std::vector<std::string> lines = slow.server->lines("waiting ");
      gst_element_set_state(busy, GST_STATE_NULL);
      gst_object_unref(busy);
      std::size_t most = 0;
      for (const std::string &line : lines)
        most = std::max<std::size_t>(most, std::stoul(line.substr(8)));
      std::printf(" %zu (of %zu) |", most + 1, lines.size());
    } else {
      std::printf(" – |");
    }
    std::printf(" %.2f %% |\n", 100 * share);
    std::fflush(stdout);
  }
}

} // namespace

GST_START_TEST(test_ways_out)
{
  print_ways_out();
}
GST_END_TEST;

GST_START_TEST(test_timing)
{
  print_timing();
}
GST_END_TEST;

static Suite *
devices_suite(void)
{
  Suite *suite = suite_create("devices");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_test(tests, test_ways_out);
  tcase_add_test(tests, test_timing);
  return suite;
}

GST_CHECK_MAIN(devices);
