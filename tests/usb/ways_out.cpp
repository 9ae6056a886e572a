// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How long motors run on after each way to end or interrupt a play, on an emulated board with the
// seat firmware. Prints a table. Asserts that motors stop, and the exact times that are the
// firmware's.
//
// Times are those at which bytes arrive over the emulated wire, or at which the firmware's watchdog
// trips.
#include "chair.h"
#include "launch.h"
#include "map_stream.h"
#include "support/boards/emulated_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <unistd.h>
#include <utility>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace usb_test;

namespace {

constexpr int kFirstPin = 2; ///< of tactor 0 on a Mega
constexpr auto kWatchdog = FirmataModel::kWatchdog;

/// Held while the clock hangs, with whoever reads it.
std::mutex clock_hangs;

struct HangingClock
{
  GstSystemClock parent;
};
struct HangingClockClass
{
  GstSystemClockClass parent_class;
};
G_DEFINE_TYPE(HangingClock, hanging_clock, GST_TYPE_SYSTEM_CLOCK)

GstClockTime
hanging_clock_get_internal_time(GstClock *clock)
{
  const std::lock_guard lock(clock_hangs);
  return GST_CLOCK_CLASS(hanging_clock_parent_class)->get_internal_time(clock);
}

void
hanging_clock_class_init(HangingClockClass *klass)
{
  GST_CLOCK_CLASS(klass)->get_internal_time = hanging_clock_get_internal_time;
}

void
hanging_clock_init(HangingClock *)
{
}

/// Turns on nine motors, with limits off so that they stay on.
class Play
{
public:
  explicit Play(bool seat)
      : firmware_(std::make_shared<Firmware>(kMega, seat)),
        board(usb, { .baud = 57600, .chip = 128 }, firmware_)
  {
    GError *error = nullptr;
    pipeline = gst_parse_launch(
        "appsrc name=maps format=time is-live=true do-timestamp=true "
        "caps=\"application/x-tactile-map,rows=(int)3,columns=(int)3,framerate=(fraction)25/1\" "
        "! queue name=queue ! tactorsink name=tactors driver=firmata guardian=false max-on-time=0 "
        "max-duty=0 "
        "max-active=0 videotestsrc is-live=true ! fakesink name=video sync=true",
        &error);
    fail_unless(error == nullptr, "%s", error ? error->message : "");
    clock = GST_CLOCK(g_object_new(hanging_clock_get_type(), nullptr));
    gst_object_ref_sink(clock);
    gst_pipeline_use_clock(GST_PIPELINE(pipeline), clock);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    feeder_ = std::thread([this] { feed(); });
    fail_unless(board.wait_until([this] { return firmware_->any_motor_on(); }));
  }
  ~Play()
  {
    if (hung_)
      clock_hangs.unlock();
    quit_ = true;
    feeder_.join();
    if (pipeline) {
      gst_element_set_state(pipeline, GST_STATE_NULL);
      gst_object_unref(pipeline);
    }
    gst_object_unref(clock);
  }
  Play(const Play &) = delete;
  Play &operator=(const Play &) = delete;

  GstElement *element(const char *name)
  {
    GstElement *found = gst_bin_get_by_name(GST_BIN(pipeline), name);
    gst_object_unref(found); // the pipeline keeps it
    return found;
  }
  void set_state(GstState state)
  {
    gst_element_set_state(pipeline, state);
  }
  /// Does nothing if the pipeline is gone or hung.
  void set_state_if_there(GstState state)
  {
    if (pipeline && !hung_)
      set_state(state);
  }
  /// Stops at the first error, as applications do.
  void stop_on_error()
  {
    GstBus *bus = gst_element_get_bus(pipeline);
    GstMessage *message = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ERROR);
    gst_message_unref(message);
    gst_object_unref(bus);
    set_state(GST_STATE_NULL);
  }
  /// Blocks tactorsink's thread at the clock until the play ends. The driver's thread goes on.
  void hang()
  {
    clock_hangs.lock();
    hung_ = true;
  }
  /// Stops the maps.
  void starve()
  {
    feeds_ = false;
  }
  const std::shared_ptr<Firmware> &firmware() const
  {
    return firmware_;
  }

  EmulatedUsb usb;

private:
  std::shared_ptr<Firmware> firmware_;

public:
  EmulatedBoard board;
  GstElement *pipeline = nullptr;
  GstClock *clock = nullptr;

private:
  /// A level for each tactor, 25 times per second.
  void feed()
  {
    GstElement *maps = gst_bin_get_by_name(GST_BIN(pipeline), "maps");
    const std::vector<float> levels(9, 0.7f);
    while (!quit_) {
      if (feeds_) {
        GstBuffer *buffer = gst_buffer_new_memdup(levels.data(), levels.size() * sizeof levels[0]);
        GST_BUFFER_DURATION(buffer) = 40 * GST_MSECOND;
        GstFlowReturn flow;
        g_signal_emit_by_name(maps, "push-buffer", buffer, &flow);
        gst_buffer_unref(buffer);
      }
      std::this_thread::sleep_for(40ms);
    }
    gst_object_unref(maps);
  }

  bool hung_ = false;
  std::atomic<bool> quit_{ false };
  std::atomic<bool> feeds_{ true };
  std::thread feeder_;
};

/// A way to end a play in this process.
struct Way
{
  const char *name;
  void (*take)(Play &);
  /// The firmware's watchdog stops the motors exactly 250 ms after the last byte. StandardFirmata
  /// does not.
  bool is_watchdogs = false;
};

const Way kWays[] = {
  { "end of stream",
    [](Play &play) {
      gst_element_send_event(play.pipeline, gst_event_new_eos());
    } },
  { "pause",
    [](Play &play) {
      play.set_state(GST_STATE_PAUSED);
    } },
  { "flush (seek)",
    [](Play &play) {
      play.starve();
      GstPad *pad = gst_element_get_static_pad(play.element("tactors"), "sink");
      gst_pad_send_event(pad, gst_event_new_flush_start());
      gst_object_unref(pad);
    } },
  { "mute",
    [](Play &play) {
      g_object_set(play.element("tactors"), "mute", TRUE, nullptr);
    } },
  { "stop",
    [](Play &play) {
      play.set_state(GST_STATE_NULL);
    } },
  { "upstream delivers nothing",
    [](Play &play) {
      play.starve();
    } },
  { "error upstream",
    [](Play &play) {
      GST_ELEMENT_ERROR(play.element("maps"), STREAM, FAILED, ("test"), (nullptr));
      play.stop_on_error();
    } },
  { "error downstream",
    [](Play &play) {
      GST_ELEMENT_ERROR(play.element("video"), RESOURCE, WRITE, ("test"), (nullptr));
      play.stop_on_error();
    } },
  { "dispose while playing",
    [](Play &play) {
      // Drops the last reference while playing, as faulty bindings do. GStreamer requires NULL
      // first; here the bin does that.
      GstElement *pipeline = std::exchange(play.pipeline, nullptr);
      GstElement *tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
      gst_bin_remove(GST_BIN(pipeline), tactors);
      gst_element_set_state(tactors, GST_STATE_NULL);
      gst_object_unref(tactors);
      gst_element_set_state(pipeline, GST_STATE_NULL);
      gst_object_unref(pipeline);
    } },
  { "unplugged", [](Play &play) { play.board.unplug(); }, true },
  { "a thread that hangs",
    [](Play &play) {
      play.hang();
    } },
  { "stalled endpoint", [](Play &play) { play.board.stall(true); }, true },
  { "suspend: the clock leaps an hour",
    [](Play &play) {
      play.starve();
      GstClockTime internal = 0;
      GstClockTime external = 0;
      GstClockTime numerator = 1;
      GstClockTime denominator = 1;
      gst_clock_get_calibration(play.clock, &internal, &external, &numerator, &denominator);
      gst_clock_set_calibration(play.clock, internal, external + 3600 * GST_SECOND, numerator,
                                denominator);
    } },
};

double
ms(std::chrono::nanoseconds time)
{
  return std::chrono::duration<double, std::milli>(time).count();
}

/// Waits until all motors are off. Returns the time from `begin` to the last change.
std::chrono::nanoseconds
wait_for_zero(EmulatedBoard &board, const Firmware &firmware, Clock::time_point begin)
{
  fail_unless(board.wait_until([&] { return !firmware.any_motor_on(); }));
  std::chrono::nanoseconds last{ 0 };
  board.with_firmware([&] {
    if (!firmware.changes().empty())
      last = firmware.changes().back().time - begin;
  });
  return std::max(last, std::chrono::nanoseconds(0));
}

} // namespace

CHECK_TEST(test_ways_out_of_a_play)
{
  for (const Way &way : kWays) {
    Play play(true);
    std::fflush(stdout);
    const Clock::time_point begin = Clock::now();
    way.take(play);
    const auto after = wait_for_zero(play.board, *play.firmware(), begin);
    std::printf("| %s | %.0f ms |\n", way.name, ms(after));
    if (way.is_watchdogs)
      fail_unless(play.firmware()->changes().back().time
                  == play.board.received().back().time + kWatchdog);
  }
}

/// With StandardFirmata only the driver stops motors. Bytes that are lost when the kernel gets the
/// board back are not sent again.
CHECK_TEST(test_ways_out_without_a_watchdog)
{
  for (const Way &way : kWays) {
    if (way.is_watchdogs)
      continue;
    Play play(false);
    way.take(play);
    wait_for_zero(play.board, *play.firmware(), Clock::now());
    play.set_state_if_there(GST_STATE_NULL);
    play.board.with_firmware([&] { fail_if(play.firmware()->any_motor_on(), "%s", way.name); });
    fail_unless_equals_int(play.board.cut_off(), 0);
  }
}

/// Ways to end a process: motors are off before it is gone, or the firmware's watchdog stops them.
CHECK_TEST(test_ways_out_of_a_process)
{
  struct Signal
  {
    const char *name;
    int number;
    bool is_watchdogs;
  };
  const Signal signals[] = { { "SIGINT", SIGINT, false },
                             { "SIGTERM", SIGTERM, false },
                             { "SIGKILL", SIGKILL, true } };
  for (const Signal &signal : signals) {
    EmulatedUsb usb;
    const auto firmware = std::make_shared<Firmware>(kMega, true);
    EmulatedBoard board(usb, { .baud = 57600, .chip = 128 }, firmware);
    Launch launch({}, { "driver=seat" });
    fail_unless(board.wait_until([&] { return firmware->any_motor_on(); }));
    const Clock::time_point begin = Clock::now();
    launch.send(signal.number);
    const auto after = wait_for_zero(board, *firmware, begin);
    std::printf("| %s | %.0f ms |\n", signal.name, ms(after));
    std::fflush(stdout);
    if (signal.is_watchdogs) {
      const Clock::time_point last = board.received().back().time;
      board.with_firmware(
          [&] { fail_unless(firmware->changes().back().time == last + kWatchdog); });
    }
  }
}

/// With StandardFirmata: by the player itself, or by its guardian.
CHECK_TEST(test_ways_out_of_a_process_without_a_watchdog)
{
  const auto measure
      = [](const char *name, Program &launch, Chair &chair, const std::function<void()> &take) {
          fail_unless(chair.wait_for_motors());
          const Clock::time_point begin = Clock::now();
          take();
          launch.wait();
          std::printf("| StandardFirmata: %s | %.0f ms |\n", name,
                      ms(wait_for_zero(chair.board, *chair.firmware, begin)));
          std::fflush(stdout);
          fail_unless(chair.wait_for_return());
        };
  for (const auto &[name, number] : { std::pair("SIGKILL", SIGKILL), { "SIGSEGV", SIGSEGV } }) {
    Chair chair;
    BarePlayer player;
    measure(name, player, chair, [&] { player.send(number); });
  }
  for (const char *word : { "exit", "_exit", "quick_exit", "abort", "exec" }) {
    Chair chair;
    BarePlayer player;
    measure(word, player, chair, [&] { player.tell(word); });
  }
  Chair chair;
  Launch launch({ "-e" });
  measure("gst-launch-1.0 -e, SIGINT twice", launch, chair, [&] {
    launch.send(SIGINT);
    launch.send(SIGINT);
  });
}

namespace {

struct NamedSignal
{
  const char *name;
  int number;
};

constexpr std::array kSignals{
  NamedSignal{ "SIGINT", SIGINT },   NamedSignal{ "SIGTERM", SIGTERM },
  NamedSignal{ "SIGHUP", SIGHUP },   NamedSignal{ "SIGQUIT", SIGQUIT },
  NamedSignal{ "SIGPIPE", SIGPIPE }, NamedSignal{ "SIGALRM", SIGALRM },
  NamedSignal{ "SIGUSR1", SIGUSR1 }, NamedSignal{ "SIGABRT", SIGABRT },
};

} // namespace

/// Two signals, one right after the other, without a guardian: motors are at zero before the
/// process ends, by the first one or, where the kernel delivers that later, the second. All pairs
/// with WAYS_OUT=all, else each signal with itself and with the next one.
CHECK_TEST(test_two_signals)
{
  const bool all = g_strcmp0(g_getenv("WAYS_OUT"), "all") == 0;
  for (std::size_t i = 0; i < kSignals.size(); i++)
    for (std::size_t j = 0; j < kSignals.size(); j++) {
      if (!all && j != i && j != (i + 1) % kSignals.size())
        continue;
      const NamedSignal &first = kSignals[i];
      const NamedSignal &second = kSignals[j];
      Chair chair;
      BarePlayer player({ "driver=firmata", "guardian=false" });
      fail_unless(chair.wait_for_motors());
      const Clock::time_point begin = Clock::now();
      player.send(first.number);
      player.send(second.number);
      const int status = player.wait();
      fail_if(chair.any_motor_on(), "%s, %s", first.name, second.name);
      fail_unless(WIFSIGNALED(status)
                  && (WTERMSIG(status) == first.number || WTERMSIG(status) == second.number));
      fail_unless(chair.wait_for_return());
      std::printf("| %s, %s | %.0f ms |\n", first.name, second.name,
                  ms(wait_for_zero(chair.board, *chair.firmware, begin)));
      std::fflush(stdout);
    }
}

namespace {

/// A track in a temporary file.
class TrackFile
{
public:
  explicit TrackFile(const std::string &cues) : path("/tmp/ways-out-XXXXXX")
  {
    const int fd = mkstemp(path.data());
    fail_unless(fd >= 0);
    const std::string text = "WEBVTT\n\nNOTE tactile grid=3x3 rate=5\n\n" + cues;
    fail_unless(write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    close(fd);
  }
  ~TrackFile()
  {
    unlink(path.c_str());
  }
  TrackFile(const TrackFile &) = delete;
  TrackFile &operator=(const TrackFile &) = delete;

  std::string path;
};

} // namespace

/// A process that is suspended (job control, a debugger, a frozen machine) and resumed: the
/// firmware's watchdog stops the motors, and cues of the time in between are dropped.
CHECK_TEST(test_stopped_and_continued)
{
  // 0.6 s of 80 % before the suspension, 0.6 s of 60 % during it, and 40 % from 8 s on: the level
  // tells which cue a command belongs to.
  const TrackFile track("00:00:00.000 --> 00:00:01.000\n0 0 0\n0 0 0\n0 0 0\n\n"
                        "00:00:01.000 --> 00:00:01.600\n80 80 80\n80 80 80\n80 80 80\n\n"
                        "00:00:02.500 --> 00:00:03.100\n60 60 60\n60 60 60\n60 60 60\n\n"
                        "00:00:08.000 --> 00:00:20.000\n40 40 40\n40 40 40\n40 40 40\n");
  EmulatedUsb usb;
  const auto firmware = std::make_shared<Firmware>(kMega, true);
  EmulatedBoard board(usb, { .baud = 57600 }, firmware);
  Launch launch({ "filesrc", "location=" + track.path, "!", "subparse", "!", "tactileconverter" },
                {}, { "driver=seat", "ramp-in=0", "compensation=none" });
  const int early = static_cast<int>(std::lround(0.8 * 255));
  const int later = static_cast<int>(std::lround(0.4 * 255));
  fail_unless(board.wait_until([&] {
    for (int pin = kFirstPin; pin < kFirstPin + 9; pin++)
      if (firmware->duty(pin) != early)
        return false;
    return true;
  }));
  const Clock::time_point begin = Clock::now();
  launch.send(SIGSTOP);
  std::printf("| SIGSTOP | %.0f ms |\n", ms(wait_for_zero(board, *firmware, begin)));
  std::fflush(stdout);
  const Clock::time_point last = board.received().back().time;
  std::size_t before = 0;
  board.with_firmware([&] {
    fail_unless(firmware->changes().back().time == last + kWatchdog);
    before = firmware->changes().size();
  });
  // Until after the first cue, including its catch-up.
  std::this_thread::sleep_until(begin + 3s);
  launch.send(SIGCONT);
  fail_unless(board.wait_until([&] { return firmware->duty(kFirstPin) == later; }));
  board.with_firmware([&] {
    for (std::size_t i = before; i < firmware->changes().size(); i++)
      fail_unless(firmware->changes()[i].duty == 0 || firmware->changes()[i].duty == later);
  });
}

CHECK_MAIN_AFTER(ways_out, g_getenv("WAYS_OUT") ? 1000 : -1, begin_emulation())
