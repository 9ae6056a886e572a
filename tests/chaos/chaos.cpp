// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Everything that an application, a user, a network and a cable can do to a film with a chair, in an order drawn by lot. After each step:
// nothing waits for ever, GLib warned of nothing, the motors are where the film is or at zero, and none was told what was asked for
// before a flush. The first thing that is wrong ends the run with the seed, the steps and the stacks.
#include "stage.h"
#include "watchdog.h"
#include "witness.h"

#include "gst/tactor/gsttactorsink.h"

#include <gst/base/gstbasesink.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

using std::chrono::milliseconds;

namespace {

constexpr int kPatience = 30; ///< s, for one step
constexpr gint64 kFilmLength = 12 * GST_SECOND;
/// The test's grid is 3 × 3 or smaller; the second mirrors it.
const std::vector<std::vector<int>> kMappings{ {}, { 2, 1, 0, 5, 4, 3, 8, 7, 6 } };

const char *
name(GstState state)
{
  return gst_element_state_get_name(state);
}

/// What was done, for whoever has to find out.
class Log
{
public:
  void begin(std::uint64_t seed, const std::string &kind, bool verbose)
  {
    std::lock_guard lock(mutex_);
    seed_ = seed;
    kind_ = kind;
    verbose_ = verbose;
    lines_.clear();
  }
  void add(const std::string &line)
  {
    std::lock_guard lock(mutex_);
    lines_.push_back(line);
    if (verbose_)
      std::fprintf(stderr, "%4zu %s\n", lines_.size(), line.c_str());
  }
  void print(const std::string &fault)
  {
    std::lock_guard lock(mutex_);
    if (!verbose_)
      for (std::size_t i = 0; i < lines_.size(); i++)
        std::fprintf(stderr, "%4zu %s\n", i + 1, lines_[i].c_str());
    std::fprintf(stderr, "FAULT: %s\nagain: chaos --kind=%s --seed=%llu --steps=%zu\n",
                 fault.c_str(), kind_.c_str(), static_cast<unsigned long long>(seed_),
                 lines_.size());
  }

private:
  std::mutex mutex_;
  std::uint64_t seed_ = 0;
  std::string kind_;
  bool verbose_ = false;
  std::vector<std::string> lines_;
};

Log steps;

/// With GST_DEBUG: the last of what each thread logged, at a fault. All of it would be gigabytes.
void
keep_gstreamer_log()
{
  if (!g_getenv("GST_DEBUG"))
    return;
  gst_debug_remove_log_function(gst_debug_log_default);
  gst_debug_add_ring_buffer_logger(1 << 20, 0);
}

void
print_gstreamer_log()
{
  if (!g_getenv("GST_DEBUG"))
    return;
  g_auto(GStrv) logs = gst_debug_ring_buffer_logger_get_logs();
  for (gchar **log = logs; log && *log; log++)
    std::fprintf(stderr, "==== log of a thread\n%s", *log);
}

[[noreturn]] void
accuse(const std::string &fault)
{
  steps.print(fault);
  print_gstreamer_log();
  std::_Exit(1);
}

GLogWriterOutput
on_glib_log(GLogLevelFlags level, const GLogField *fields, gsize count, gpointer)
{
  if (!(level & (G_LOG_LEVEL_ERROR | G_LOG_LEVEL_CRITICAL | G_LOG_LEVEL_WARNING)))
    return G_LOG_WRITER_HANDLED;
  g_autofree char *text = g_log_writer_format_fields(level, fields, count, FALSE);
  print_own_stack(0);
  accuse(std::string("GLib warns: ") + text);
}

class Chaos
{
public:
  Chaos(Stage::Kind kind, const std::string &film, std::uint64_t seed, Watchdog &watchdog)
      : kind_(kind), film_(film), random_(seed), watchdog_(watchdog)
  {
    witness().sockets.plug(witness().mega);
    make_stage();
  }
  ~Chaos()
  {
    leave_stage();
    for (MemoryBoard *board : { &witness().mega, &witness().seat })
      if (board->is_plugged)
        witness().sockets.unplug(*board);
  }
  void run(int count)
  {
    for (int i = 0; i < count; i++) {
      watchdog_.feed();
      step();
      watchdog_.feed();
      check();
    }
  }

  std::map<std::string, int> tally;

private:
  struct Step
  {
    const char *name;
    int weight;
    void (Chaos::*act)();
    bool only_seekable = false;
  };

  // ---- dice

  int dice(int sides)
  {
    return std::uniform_int_distribution<int>(0, sides - 1)(random_);
  }
  double fraction()
  {
    return std::uniform_real_distribution<double>(0, 1)(random_);
  }
  template <typename Value, std::size_t size> Value pick(const std::array<Value, size> &values)
  {
    return values[static_cast<std::size_t>(dice(size))];
  }

  // ---- the stage

  void make_stage()
  {
    stage_ = std::make_unique<Stage>(kind_, film_);
    witness().watch(stage_->tactors);
    g_object_set(stage_->tactors, "driver", "firmata", nullptr);
    bus_ = gst_element_get_bus(stage_->pipeline);
    state_ = GST_STATE_NULL;
    has_prerolled_ = is_excused_ = false;
    is_settled_ = is_muted_ = is_broken_ = has_ended_ = is_cut_ = false;
    if (kind_ != Stage::Kind::network)
      set_state(GST_STATE_PLAYING);
    else
      set_state(GST_STATE_PLAYING);
  }
  void leave_stage()
  {
    hear();
    forget_probe();
    restore_branch();
    gst_object_unref(bus_);
    stage_.reset();
    witness().expect_silence("after the pipeline was given up");
  }

  /// Takes what is on the bus. Errors that nobody made are faults.
  void hear()
  {
    while (GstMessage *message = gst_bus_pop(bus_)) {
      switch (GST_MESSAGE_TYPE(message)) {
      case GST_MESSAGE_ERROR: {
        GError *error = nullptr;
        gchar *debug = nullptr;
        gst_message_parse_error(message, &error, &debug);
        const std::string text = std::string(error->message) + " (" + (debug ? debug : "") + ")";
        g_error_free(error);
        g_free(debug);
        if (!is_excused_)
          accuse("an error that nothing asked for: " + text);
        is_broken_ = true;
        break;
      }
      case GST_MESSAGE_EOS:
        has_ended_ = true;
        break;
      case GST_MESSAGE_ASYNC_DONE:
        has_prerolled_ = is_settled_ = true;
        break;
      case GST_MESSAGE_LATENCY:
        gst_bin_recalculate_latency(GST_BIN(stage_->pipeline));
        break;
      case GST_MESSAGE_CLOCK_LOST:
        // As applications do.
        if (state_ == GST_STATE_PLAYING) {
          gst_element_set_state(stage_->pipeline, GST_STATE_PAUSED);
          gst_element_set_state(stage_->pipeline, GST_STATE_PLAYING);
        }
        break;
      default:
        break;
      }
      gst_message_unref(message);
    }
  }

  void set_state(GstState state)
  {
    if (state <= GST_STATE_READY) {
      forget_probe();
      restore_branch();
      has_prerolled_ = is_settled_ = false;
    }
    state_ = state;
    const GstStateChangeReturn ret = gst_element_set_state(stage_->pipeline, state);
    if (ret == GST_STATE_CHANGE_FAILURE) {
      if (!is_excused_)
        accuse(std::string("the pipeline does not become ") + name(state));
      hear();
      is_broken_ = true;
    }
    if (state < GST_STATE_PLAYING)
      witness().expect_silence(std::string("when the pipeline has become ") + name(state));
    if (state <= GST_STATE_READY) {
      hear();
      is_broken_ = has_ended_ = false;
      // What is broken stays so until it is mended; what was broken before is over.
      is_excused_ = !boards_are_well();
    }
  }

  bool boards_are_well()
  {
    return witness().sockets.locked([] {
      return witness().mega.is_plugged && !witness().mega.refusal && !witness().mega.takes_nothing
             && !witness().mega.says_nothing;
    });
  }

  /// Waits, in small pieces, until it holds; the watchdog ends what takes too long. False if it need not hold any more.
  template <typename Condition> bool await(Condition condition)
  {
    for (;;) {
      hear();
      if (is_broken_)
        return false;
      if (condition())
        return true;
      std::this_thread::sleep_for(milliseconds(5));
    }
  }

  // ---- steps

  void step()
  {
    static const std::vector<Step> all{
      { "play", 24, &Chaos::play },
      { "pause", 8, &Chaos::pause },
      { "ready", 1, &Chaos::ready },
      { "null", 1, &Chaos::null },
      { "seek", 14, &Chaos::seek, true },
      { "skip", 6, &Chaos::skip_frames, true },
      { "caps", 5, &Chaos::change_caps },
      { "property", 12, &Chaos::change_property },
      { "clock", 4, &Chaos::change_clock },
      { "latency", 5, &Chaos::change_latency },
      { "device", 2, &Chaos::change_device },
      { "unplug", 3, &Chaos::unplug },
      { "plug", 8, &Chaos::plug },
      { "refuse", 1, &Chaos::refuse },
      { "stall-board", 1, &Chaos::stall_board },
      { "eos", 2, &Chaos::send_eos },
      { "error", 1, &Chaos::post_error },
      { "flow-error", 1, &Chaos::flow_error },
      { "gap", 4, &Chaos::gap },
      { "starve", 4, &Chaos::starve },
      { "cut", 2, &Chaos::cut_branch },
      { "mend", 8, &Chaos::mend_branch },
      { "query", 4, &Chaos::query },
      { "two-at-once", 8, &Chaos::two_at_once },
      { "dispose", 1, &Chaos::dispose },
      { "network", 6, &Chaos::disturb_network },
    };
    // After an error, an end and long times in rest mostly what gets the film going again.
    if ((is_broken_ || state_ < GST_STATE_PAUSED) && dice(3) > 0) {
      recover();
      return;
    }
    if (has_ended_ && dice(2) == 0) {
      note("rewind");
      if (stage_->is_seekable() && state_ >= GST_STATE_PAUSED)
        seek();
      else
        recover();
      return;
    }
    int total = 0;
    for (const Step &each : all)
      total += each.weight;
    for (;;) {
      int left = dice(total);
      const Step *chosen = &all.back();
      for (const Step &each : all) {
        if (left < each.weight) {
          chosen = &each;
          break;
        }
        left -= each.weight;
      }
      if (chosen->only_seekable && !stage_->is_seekable())
        continue;
      tally[chosen->name]++;
      note(chosen->name);
      (this->*chosen->act)();
      break;
    }
    // The film goes on for a while, or not at all.
    const int pause = dice(3) == 0 ? 0 : dice(12) == 0 ? 1000 + dice(1000) : dice(150);
    std::this_thread::sleep_for(milliseconds(pause));
  }
  void note(const std::string &what)
  {
    steps.add(what + "  [" + name(state_) + (is_broken_ ? ", broken" : "")
              + (has_ended_ ? ", ended" : "") + (is_cut_ ? ", cut" : "")
              + (is_muted_ ? ", muted" : "") + "]");
  }
  void recover()
  {
    note("recover");
    restore_branch();
    repair_boards();
    set_state(dice(2) ? GST_STATE_READY : GST_STATE_NULL);
    is_excused_ = false;
    set_state(GST_STATE_PLAYING);
    std::this_thread::sleep_for(milliseconds(dice(1500)));
  }

  void play()
  {
    if (is_broken_)
      return;
    set_state(GST_STATE_PLAYING);
    // Mostly it is let begin; a live one without data begins at once.
    if (dice(4) && !is_cut_ && !has_ended_)
      await([this] {
        GstState state = GST_STATE_NULL;
        return gst_element_get_state(stage_->pipeline, &state, nullptr, 0) != GST_STATE_CHANGE_ASYNC
               || has_ended_;
      });
  }
  void pause()
  {
    if (state_ >= GST_STATE_PAUSED && !is_broken_)
      set_state(GST_STATE_PAUSED);
  }
  void ready()
  {
    set_state(GST_STATE_READY);
  }
  void null()
  {
    set_state(GST_STATE_NULL);
  }
  void seek()
  {
    if (!has_prerolled_ || is_broken_)
      return;
    // By seeks: where a change of rate without one (GST_SEEK_FLAG_INSTANT_RATE_CHANGE) meets a flush, GStreamer 1.22 itself asserts in
    // gst_segment_position_from_running_time_full.
    static constexpr std::array<double, 7> kRates{ 1, 1, 0.25, 0.5, 2, 4, -1 };
    const double rate = pick(kRates);
    // A seek without a flush waits for the streaming thread, which in a pause waits for the play.
    GstState now = GST_STATE_NULL;
    const bool plays
        = gst_element_get_state(stage_->pipeline, &now, nullptr, 0) == GST_STATE_CHANGE_SUCCESS
          && now == GST_STATE_PLAYING && !has_ended_ && !is_cut_;
    const bool flush = dice(4) > 0 || !plays;
    const auto kind = pick(std::array<GstSeekFlags, 3>{
        GST_SEEK_FLAG_ACCURATE, GST_SEEK_FLAG_KEY_UNIT, GST_SEEK_FLAG_NONE });
    const gint64 place = dice(20) == 0 ? 0 : static_cast<gint64>(fraction() * kFilmLength);
    const auto flags
        = static_cast<GstSeekFlags>(kind | (flush ? GST_SEEK_FLAG_FLUSH : GST_SEEK_FLAG_NONE));
    g_autofree char *text = g_strdup_printf("  seek to %.3f s, rate %g, flags %d",
                                            static_cast<double>(place) / GST_SECOND, rate, flags);
    steps.add(text);
    const bool sought
        = gst_element_seek(stage_->pipeline, rate, GST_FORMAT_TIME, flags, GST_SEEK_TYPE_SET,
                           rate > 0 ? place : 0, GST_SEEK_TYPE_SET, rate > 0 ? -1 : place);
    is_settled_ = is_settled_ && !flush;
    if (sought && flush)
      has_ended_ = false;
  }
  /// Frame after frame, as players do it: in a pause.
  void skip_frames()
  {
    if (!is_settled_ || is_broken_ || has_ended_ || state_ != GST_STATE_PAUSED)
      return;
    // GstBaseSink (1.22) gives its state up for a step and gets it back with the next frame: after the last one it waits for ever.
    GstState now = GST_STATE_NULL;
    if (gst_element_get_state(stage_->pipeline, &now, nullptr, 0) != GST_STATE_CHANGE_SUCCESS
        || now != GST_STATE_PAUSED || stage_->is_at_end())
      return;
    gst_element_send_event(stage_->pipeline,
                           gst_event_new_step(GST_FORMAT_BUFFERS, 1, 1.0, TRUE, FALSE));
  }
  void change_caps()
  {
    static constexpr std::array<const char *, 4> kSizes{
      "width=160,height=120", "width=320,height=240", "width=64,height=64", "width=33,height=17"
    };
    if (stage_->size && dice(2)) {
      const bool is_camera = kind_ != Stage::Kind::file;
      GstCaps *caps
          = gst_caps_from_string((std::string("video/x-raw,")
                                  + (is_camera ? "format=I420,framerate=30/1," : "") + pick(kSizes))
                                     .c_str());
      g_object_set(stage_->size, "caps", caps, nullptr);
      gst_caps_unref(caps);
    } else if (stage_->analysis) {
      g_object_set(stage_->analysis, "rows", 1 + dice(3), "columns", 1 + dice(3), nullptr);
    }
  }
  void change_property()
  {
    GstElement *tactors = stage_->tactors;
    switch (dice(11)) {
    case 0:
      g_object_set(tactors, "intensity", fraction(), nullptr);
      break;
    case 1:
      is_muted_ = !is_muted_ && dice(3) == 0;
      g_object_set(tactors, "mute", is_muted_, nullptr);
      if (is_muted_)
        witness().expect_silence("when muted");
      break;
    case 2:
      g_object_set(tactors, "rate", pick(std::array<double, 4>{ 0, 1, 5, 30 }), nullptr);
      break;
    case 3:
      g_object_set(tactors, "max-lead", static_cast<guint>(dice(181)), nullptr);
      break;
    case 4: {
      const bool mirrored = dice(2);
      gst_util_set_object_arg(G_OBJECT(tactors), "mapping",
                              mirrored ? "<2,1,0,5,4,3,8,7,6>" : "<>");
      break;
    }
    case 5:
      g_object_set(tactors, "max-on-time", static_cast<guint64>(dice(3)) * GST_SECOND, "max-duty",
                   0.2 * dice(3), "max-active", static_cast<guint>(dice(4)), nullptr);
      break;
    case 6:
      g_object_set(tactors, "ramp-in", static_cast<guint64>(dice(3)) * 100 * GST_MSECOND, nullptr);
      break;
    case 7:
      // Beyond what the queues hold, one sink would wait for the other.
      g_object_set(tactors, "ts-offset",
                   gint64{ dice(200) - 100 } * GST_MSECOND / (stage_->is_seekable() ? 10 : 1),
                   nullptr);
      break;
    case 8:
      if (!stage_->is_seekable()) // likewise
        g_object_set(tactors, "sync", static_cast<gboolean>(dice(4) > 0), nullptr);
      break;
    case 9:
      g_object_set(tactors, "compensation", dice(3), "kick-start", static_cast<gboolean>(dice(2)),
                   nullptr);
      break;
    default:
      if (stage_->analysis)
        g_object_set(stage_->analysis, "threshold", fraction(), "max-rate",
                     pick(std::array<double, 3>{ 0, 5, 15 }), nullptr);
      break;
    }
  }
  void change_clock()
  {
    GstClock *clock = nullptr;
    switch (dice(3)) {
    case 0:
      gst_pipeline_auto_clock(GST_PIPELINE(stage_->pipeline));
      break;
    case 1: // begins anywhere
      clock = GST_CLOCK(g_object_new(GST_TYPE_SYSTEM_CLOCK, "clock-type",
                                     dice(2) ? GST_CLOCK_TYPE_REALTIME : GST_CLOCK_TYPE_MONOTONIC,
                                     nullptr));
      gst_object_ref_sink(clock);
      gst_pipeline_use_clock(GST_PIPELINE(stage_->pipeline), clock);
      gst_object_unref(clock);
      break;
    default:
      clock = gst_element_get_clock(stage_->pipeline);
      if (clock) {
        gst_element_post_message(stage_->pipeline,
                                 gst_message_new_clock_lost(GST_OBJECT(stage_->pipeline), clock));
        gst_object_unref(clock);
      }
      break;
    }
  }
  void change_latency()
  {
    if (is_broken_)
      return;
    switch (dice(3)) {
    case 0:
      gst_element_send_event(
          stage_->pipeline,
          gst_event_new_latency(static_cast<GstClockTime>(dice(600)) * GST_MSECOND));
      break;
    case 1:
      gst_pipeline_set_latency(GST_PIPELINE(stage_->pipeline),
                               dice(2) ? GST_CLOCK_TIME_NONE
                                       : static_cast<GstClockTime>(dice(800)) * GST_MSECOND);
      break;
    default:
      break;
    }
    gst_bin_recalculate_latency(GST_BIN(stage_->pipeline));
  }
  /// Which takes effect when the board is opened next.
  void change_device()
  {
    static constexpr std::array<const char *, 4> kDrivers{ "firmata", "seat", "auto", "simulator" };
    const char *driver = pick(kDrivers);
    g_object_set(stage_->tactors, "driver", driver, nullptr);
    if (std::string(driver) == "seat") {
      plug(witness().seat);
    } else if (dice(2)) {
      plug(witness().mega);
    }
    if (dice(2))
      set_state(GST_STATE_READY);
    // With "seat" a Mega is looked at, too, and the other way round: whatever comes of it.
    is_excused_ = true;
  }
  void plug(MemoryBoard &board)
  {
    if (!board.is_plugged)
      witness().sockets.plug(board);
  }
  void unplug()
  {
    is_excused_ = true;
    MemoryBoard &board = dice(3) ? witness().mega : witness().seat;
    if (board.is_plugged)
      witness().sockets.unplug(board);
  }
  void plug()
  {
    plug(dice(3) ? witness().mega : witness().seat);
  }
  void refuse()
  {
    is_excused_ = true;
    static constexpr std::array<tactor::DriverError::Kind, 3> kKinds{
      tactor::DriverError::Kind::busy, tactor::DriverError::Kind::permission,
      tactor::DriverError::Kind::failed
    };
    const auto kind = pick(kKinds);
    witness().sockets.locked([=] { witness().mega.refusal = kind; });
  }
  void stall_board()
  {
    is_excused_ = true;
    const bool writes = dice(2);
    witness().sockets.locked(
        [=] { (writes ? witness().mega.takes_nothing : witness().mega.says_nothing) = true; });
  }
  void repair_boards()
  {
    // A board that took nothing has what it had then: it is plugged out.
    for (MemoryBoard *board : { &witness().mega, &witness().seat }) {
      const bool stalled = witness().sockets.locked([=] {
        board->refusal.reset();
        board->says_nothing = false;
        return std::exchange(board->takes_nothing, false);
      });
      if (stalled && board->is_plugged)
        witness().sockets.unplug(*board);
    }
    plug(witness().mega);
    g_object_set(stage_->tactors, "driver", "firmata", nullptr);
  }
  /// GstBaseSrc (1.22) takes the end of a live stream only when it does not wait for downstream, which in a pause it may.
  bool can_end() const
  {
    return !is_broken_
           && (stage_->is_seekable() ? has_prerolled_.load() : state_ == GST_STATE_PLAYING);
  }
  void send_eos()
  {
    if (can_end())
      gst_element_send_event(stage_->pipeline, gst_event_new_eos());
  }
  void post_error()
  {
    is_excused_ = true;
    GST_ELEMENT_ERROR(stage_->analysis && dice(2) ? stage_->analysis : stage_->tactors, STREAM,
                      FAILED, ("Chaos."), (nullptr));
    hear();
  }

  /// Does something to one buffer on its way to tactorsink, the next that comes.
  void once(GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int), int value = 0)
  {
    GstPad *pad = stage_->upstream_pad();
    if (!pad) // cut
      return;
    forget_probe();
    once_.act = act;
    once_.value = value;
    once_.is_done = false;
    once_.id = gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad *pad, GstPadProbeInfo *info, gpointer data) {
          auto &once = *static_cast<Once *>(data);
          return once.is_done.exchange(true) ? GST_PAD_PROBE_OK : once.act(pad, info, once.value);
        },
        &once_, nullptr);
    once_.pad = pad;
  }
  void forget_probe()
  {
    if (!once_.pad)
      return;
    once_.is_done = true;
    gst_pad_remove_probe(once_.pad, once_.id);
    gst_clear_object(&once_.pad);
  }
  void flow_error()
  {
    // Elements that fail say so on the bus; in visuotactilesink that is what the film goes on by.
    if (kind_ == Stage::Kind::playbin)
      return;
    is_excused_ = true;
    once([](GstPad *pad, GstPadProbeInfo *info, int) {
      GstElement *element = gst_pad_get_parent_element(pad);
      GST_ELEMENT_FLOW_ERROR(element, GST_FLOW_ERROR);
      gst_object_unref(element);
      gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
      GST_PAD_PROBE_INFO_DATA(info) = nullptr;
      GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_ERROR;
      return GST_PAD_PROBE_HANDLED;
    });
  }
  void gap()
  {
    once([](GstPad *pad, GstPadProbeInfo *info, int) {
      GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
      if (GST_BUFFER_PTS_IS_VALID(buffer))
        gst_pad_push_event(pad,
                           gst_event_new_gap(GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer)));
      return GST_PAD_PROBE_DROP;
    });
  }
  /// Nothing comes for a while.
  void starve()
  {
    once(
        [](GstPad *, GstPadProbeInfo *, int ms) {
          std::this_thread::sleep_for(milliseconds(ms));
          return GST_PAD_PROBE_OK;
        },
        pick(std::array<int, 3>{ 50, 300, 1500 }));
  }
  /// The tactile branch is taken out of a pipeline that plays; the picture goes on.
  void cut_branch()
  {
    if (!stage_->branch || is_cut_ || is_broken_)
      return;
    GstPad *sink = gst_element_get_static_pad(stage_->branch, "sink");
    extractor_ = gst_pad_get_peer(sink);
    gst_pad_unlink(extractor_, sink);
    gst_object_unref(sink);
    // From its end: what waits in a sink ends with it.
    for (GstElement *each : { stage_->tactors, stage_->branch }) {
      gst_bin_remove(GST_BIN(stage_->pipeline), each);
      gst_element_set_state(each, GST_STATE_NULL);
    }
    is_cut_ = true;
    witness().expect_silence("when the branch was taken away");
  }
  void mend_branch()
  {
    if (is_cut_ && !is_broken_ && boards_are_well())
      join_branch(true);
  }
  /// Before the pipeline goes to rest, so that it is whole when it plays again.
  void restore_branch()
  {
    if (is_cut_)
      join_branch(false);
  }
  void join_branch(bool sync)
  {
    gst_bin_add_many(GST_BIN(stage_->pipeline), stage_->branch, stage_->tactors, nullptr);
    gst_element_link(stage_->branch, stage_->tactors);
    if (sync) {
      gst_element_sync_state_with_parent(stage_->tactors);
      gst_element_sync_state_with_parent(stage_->branch);
    }
    GstPad *sink = gst_element_get_static_pad(stage_->branch, "sink");
    gst_pad_link(extractor_, sink);
    gst_object_unref(sink);
    gst_clear_object(&extractor_);
    is_cut_ = false;
  }
  void query()
  {
    gint64 value = 0;
    gst_element_query_position(stage_->pipeline, GST_FORMAT_TIME, &value);
    gst_element_query_duration(stage_->pipeline, GST_FORMAT_TIME, &value);
    GstQuery *latency = gst_query_new_latency();
    gst_element_query(stage_->pipeline, latency);
    gst_query_unref(latency);
    GstStructure *stats = nullptr;
    g_object_get(stage_->tactors, "stats", &stats, nullptr);
    guint64 issued = 0;
    guint64 late = 0;
    if (!gst_structure_get(stats, "issued", G_TYPE_UINT64, &issued, "late", G_TYPE_UINT64, &late,
                           nullptr)
        || late > issued)
      accuse("more commands were late than were issued");
    gst_structure_free(stats);
  }
  /// What two threads of an application may do at the same time.
  void two_at_once()
  {
    using Act = void (Chaos::*)();
    static constexpr std::array<Act, 6> kOthers{ &Chaos::query_often,   &Chaos::pull_and_plug,
                                                 &Chaos::latency_often, &Chaos::mute_often,
                                                 &Chaos::eos_inside,    &Chaos::seek_inside };
    const Act other = pick(kOthers);
    std::thread thread([&] { (this->*other)(); });
    switch (dice(stage_->is_seekable() ? 4 : 3)) {
    case 0:
      pause();
      break;
    case 1:
      if (!is_broken_)
        set_state(GST_STATE_PLAYING);
      break;
    case 2:
      set_state(GST_STATE_READY);
      break;
    default:
      seek();
      break;
    }
    thread.join();
    if (is_muted_)
      witness().expect_silence("when muted meanwhile");
    if (state_ < GST_STATE_PLAYING)
      witness().expect_silence("when not playing any more");
  }
  // Of the other thread: nothing of this object is changed there, and no dice are thrown.
  void query_often()
  {
    for (int i = 0; i < 20; i++)
      query();
  }
  void pull_and_plug()
  {
    is_excused_ = true;
    if (witness().mega.is_plugged) {
      witness().sockets.unplug(witness().mega);
      witness().sockets.plug(witness().mega);
    }
  }
  void latency_often()
  {
    for (int i = 0; i < 5; i++)
      gst_bin_recalculate_latency(GST_BIN(stage_->pipeline));
  }
  void mute_often()
  {
    for (int i = 0; i < 6; i++)
      g_object_set(stage_->tactors, "mute", static_cast<gboolean>(i % 2 == 0), nullptr);
    g_object_set(stage_->tactors, "mute", static_cast<gboolean>(is_muted_), nullptr);
  }
  void eos_inside()
  {
    if (can_end())
      gst_element_send_event(stage_->pipeline, gst_event_new_eos());
  }
  void seek_inside()
  {
    if (has_prerolled_ && stage_->is_seekable())
      gst_element_seek_simple(stage_->pipeline, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                              kFilmLength / 3);
  }
  void dispose()
  {
    leave_stage();
    repair_boards_without_stage();
    make_stage();
  }
  void repair_boards_without_stage()
  {
    witness().sockets.locked([] {
      witness().mega.refusal.reset();
      witness().mega.says_nothing = false;
    });
    if (witness().sockets.locked([] { return std::exchange(witness().mega.takes_nothing, false); })
        && witness().mega.is_plugged)
      witness().sockets.unplug(witness().mega);
    plug(witness().mega);
  }
  /// The other computer hangs, begins anew, or sends what is none of ours.
  void disturb_network()
  {
    if (!stage_->source)
      return;
    switch (dice(4)) {
    case 0:
      gst_element_set_state(stage_->source, GST_STATE_PAUSED);
      std::this_thread::sleep_for(milliseconds(dice(200)));
      gst_element_set_state(stage_->source, GST_STATE_PLAYING);
      break;
    case 1:
      gst_element_set_state(stage_->source, GST_STATE_NULL);
      gst_element_set_state(stage_->source, GST_STATE_PLAYING);
      break;
    default: {
      // Packets of noise, lost ones, twice the same.
      GstElement *out = gst_bin_get_by_name(GST_BIN(stage_->source), "out");
      GstPad *pad = gst_element_get_static_pad(out, "sink");
      const int mode = dice(3);
      gst_pad_add_probe(
          pad, GST_PAD_PROBE_TYPE_BUFFER,
          [](GstPad *pad, GstPadProbeInfo *info, gpointer data) {
            gst_pad_remove_probe(pad, GST_PAD_PROBE_INFO_ID(info));
            if (GPOINTER_TO_INT(data) == 0)
              return GST_PAD_PROBE_DROP;
            GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
            if (GPOINTER_TO_INT(data) == 1) {
              buffer = gst_buffer_make_writable(buffer);
              GstMapInfo map;
              if (gst_buffer_map(buffer, &map, GST_MAP_WRITE)) {
                for (gsize i = 12; i < map.size; i++)
                  map.data[i] = static_cast<guint8>(map.data[i] * 31 + i);
                gst_buffer_unmap(buffer, &map);
              }
              GST_PAD_PROBE_INFO_DATA(info) = buffer;
              return GST_PAD_PROBE_OK;
            }
            gst_pad_push(pad, gst_buffer_ref(buffer));
            return GST_PAD_PROBE_OK;
          },
          GINT_TO_POINTER(mode == 2 ? 0 : mode), nullptr);
      gst_object_unref(pad);
      gst_object_unref(out);
      is_excused_ = is_excused_ || mode == 1;
      break;
    }
    }
  }

  // ---- after each step

  /// Running time of the chair; nothing if it has no clock now.
  bool running_time(gint64 &running)
  {
    GstClock *clock = gst_element_get_clock(stage_->tactors);
    if (!clock)
      return false;
    GstBaseSink *sink = GST_BASE_SINK(stage_->tactors);
    running = static_cast<gint64>(gst_clock_get_time(clock))
              - static_cast<gint64>(gst_element_get_base_time(stage_->tactors))
              - static_cast<gint64>(gst_base_sink_get_latency(sink))
              - gst_base_sink_get_ts_offset(sink);
    gst_object_unref(clock);
    return true;
  }

  void check()
  {
    hear();
    if (state_ < GST_STATE_PLAYING)
      witness().expect_silence(std::string("in ") + name(state_));
    if (is_muted_)
      witness().expect_silence("while muted");
    if (has_ended_ && kind_ != Stage::Kind::playbin && !is_broken_)
      witness().expect_silence("after the end");
    std::string reason;
    // Threads need their time; what does not come about is ended by the watchdog, which has the reason.
    const auto hold = [&](auto condition) {
      while (!condition()) {
        {
          std::lock_guard lock(mutex_);
          waiting_for_ = reason;
        }
        std::this_thread::sleep_for(milliseconds(2));
        hear();
      }
      std::lock_guard lock(mutex_);
      waiting_for_.clear();
    };
    hold([&] {
      gboolean sync = TRUE;
      g_object_get(stage_->tactors, "sync", &sync, nullptr);
      gint64 running = 0;
      if (!sync || !running_time(running))
        return true;
      return witness().agrees_with_film(running, reason);
    });
    hold([&] { return witness().boards_agree(reason); });
  }

public:
  /// The elements that are not in their pipeline's state, from any thread and without a lock: whatever hangs may have it.
  void print_states()
  {
    g_autoptr(GstIterator) all = gst_bin_iterate_recurse(GST_BIN(stage_->pipeline));
    GValue item = G_VALUE_INIT;
    while (gst_iterator_next(all, &item) == GST_ITERATOR_OK) {
      GstElement *element = GST_ELEMENT(g_value_get_object(&item));
      std::fprintf(stderr, "state of %s: %s, next %s, pending %s, %s\n", GST_OBJECT_NAME(element),
                   name(GST_STATE(element)), name(GST_STATE_NEXT(element)),
                   name(GST_STATE_PENDING(element)),
                   gst_element_state_change_return_get_name(GST_STATE_RETURN(element)));
      g_value_reset(&item);
    }
  }

  /// What check() waits for, from any thread.
  std::string waiting_for()
  {
    std::lock_guard lock(mutex_);
    return waiting_for_;
  }

private:
  const Stage::Kind kind_;
  const std::string film_;
  std::mt19937_64 random_;
  Watchdog &watchdog_;
  std::unique_ptr<Stage> stage_;
  GstBus *bus_ = nullptr;
  struct Once
  {
    GstPad *pad = nullptr; ///< with the probe
    gulong id = 0;
    GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int) = nullptr;
    int value = 0;
    std::atomic<bool> is_done{ false };
  } once_;
  std::atomic<bool> has_prerolled_{ false }; ///< since READY: what is not linked yet takes no seek
  GstPad *extractor_ = nullptr;              ///< what the branch that is cut came from
  GstState state_ = GST_STATE_NULL;
  bool is_settled_ = false; ///< and since the last flush
  bool is_muted_ = false;
  bool is_broken_ = false; ///< an error came: only READY helps
  bool has_ended_ = false;
  std::atomic<bool> is_excused_{ false }; ///< something was done that may end in an error
  bool is_cut_ = false;
  std::mutex mutex_;
  std::string waiting_for_;
};

const std::vector<std::pair<std::string, Stage::Kind>> kKinds{
  { "file", Stage::Kind::file },
  { "live", Stage::Kind::live },
  { "network", Stage::Kind::network },
  { "playbin", Stage::Kind::playbin },
};

} // namespace

int
main(int argc, char **argv)
{
  gint count = 50;
  gint64 seed = 1;
  gint runs = 1;
  gchar *kind = nullptr;
  gboolean verbose = FALSE;
  const GOptionEntry entries[] = {
    { "steps", 0, 0, G_OPTION_ARG_INT, &count, "Steps of a run (50)", "N" },
    { "seed", 0, 0, G_OPTION_ARG_INT64, &seed, "Seed of the first run (1)", "N" },
    { "runs", 0, 0, G_OPTION_ARG_INT, &runs, "Runs of each kind, each its own seed (1)", "N" },
    { "kind", 0, 0, G_OPTION_ARG_STRING, &kind, "file, live, network or playbin (all)", "KIND" },
    { "verbose", 'v', 0, G_OPTION_ARG_NONE, &verbose, "Print each step as it is taken", nullptr },
    {}
  };
  GOptionContext *context = g_option_context_new("- does at random what can be done to a film");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  GError *error = nullptr;
  const bool parsed = g_option_context_parse(context, &argc, &argv, &error);
  g_option_context_free(context);
  const bool known
      = !kind || std::ranges::any_of(kKinds, [&](const auto &each) { return each.first == kind; });
  if (!parsed || !known || count < 1 || runs < 1) {
    std::fprintf(stderr, "chaos: %s; see chaos --help\n",
                 error   ? error->message
                 : known ? "expected at least one step and one run"
                         : "expected --kind=file, live, network or playbin");
    return 2;
  }

  g_log_set_writer_func(on_glib_log, nullptr, nullptr);
  keep_gstreamer_log();
  GST_ELEMENT_REGISTER(tactorsink, nullptr);
  witness().accuse = accuse;
  witness().set_mappings(kMappings);

  char film[] = "/tmp/chaos-XXXXXX.mkv";
  const int fd = mkstemps(film, 4);
  if (fd < 0) {
    std::perror("chaos");
    return 2;
  }
  close(fd);
  make_film(film);

  Chaos *running = nullptr;
  {
    Watchdog watchdog(kPatience, [&] {
      const std::string waiting = running ? running->waiting_for() : "";
      steps.print(waiting.empty() ? "a step does not end" : "stays so: " + waiting);
      if (running)
        running->print_states();
      print_gstreamer_log();
    });
    for (const auto &[text, each] : kKinds) {
      if (kind && text != kind)
        continue;
      for (int run = 0; run < runs; run++) {
        const auto own = static_cast<std::uint64_t>(seed + run);
        steps.begin(own, text, verbose);
        const guint64 maps = witness().maps();
        const guint64 vibrations = witness().vibrations();
        const guint64 flushes = witness().flushes();
        {
          Chaos chaos(each, film, own, watchdog);
          running = &chaos;
          chaos.run(count);
          running = nullptr;
        }
        std::printf("%s, seed %" G_GUINT64_FORMAT ": %d steps, %" G_GUINT64_FORMAT
                    " maps, %" G_GUINT64_FORMAT " vibrations, %" G_GUINT64_FORMAT " flushes\n",
                    text.c_str(), own, count, witness().maps() - maps,
                    witness().vibrations() - vibrations, witness().flushes() - flushes);
        std::fflush(stdout);
      }
    }
  }
  unlink(film);
  g_free(kind);
  return 0;
}
