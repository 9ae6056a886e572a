// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chaos.h"

#include "report.h"

#include <gst/base/gstbasesink.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <vector>

using std::chrono::milliseconds;

namespace {

const char *
name(GstState state)
{
  return gst_element_state_get_name(state);
}

} // namespace

Chaos::Chaos(Stage::Kind kind, const std::string &film, std::uint64_t seed,
             const std::vector<std::string> &only, Watchdog &watchdog)
    : kind_(kind), film_(film), random_(seed), watchdog_(watchdog)
{
  for (const Step &each : all_steps())
    if ((only.empty() || std::ranges::count(only, each.name))
        && (Stage::is_seekable(kind) || !each.only_seekable))
      drawn_.push_back(&each);
  if (drawn_.empty())
    throw std::invalid_argument("a film of this kind takes none of these steps");
  witness().sockets.plug(witness().mega);
  make_stage();
}

Chaos::~Chaos()
{
  leave_stage();
  for (MemoryBoard *board : { &witness().mega, &witness().seat })
    if (board->is_plugged)
      witness().sockets.unplug(*board);
}

void
Chaos::run(int count)
{
  for (int i = 0; i < count; i++) {
    watchdog_.feed();
    step();
    watchdog_.feed();
    check();
  }
}

/* ---- the stage ---- */

void
Chaos::make_stage()
{
  stage_ = std::make_unique<Stage>(kind_, film_);
  witness().watch(stage_->tactors);
  g_object_set(stage_->tactors, "driver", "firmata", nullptr);
  bus_ = gst_element_get_bus(stage_->pipeline);
  state_ = GST_STATE_NULL;
  has_prerolled_ = is_excused_ = false;
  is_settled_ = is_muted_ = is_broken_ = has_ended_ = is_cut_ = false;
  set_state(GST_STATE_PLAYING);
}

void
Chaos::leave_stage()
{
  hear();
  forget_probe();
  restore_branch();
  gst_object_unref(bus_);
  stage_.reset();
  witness().expect_silence("after the pipeline was given up");
}

void
Chaos::hear()
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
      // Stop at an error, as applications do.
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

void
Chaos::let_begin()
{
  if (Stage::is_beside(kind_))
    await([this] {
      return gst_element_get_state(stage_->pipeline, nullptr, nullptr, 0) != GST_STATE_CHANGE_ASYNC
             || has_ended_;
    });
}

void
Chaos::set_state(GstState state)
{
  if (state <= GST_STATE_READY) {
    let_begin();
    forget_probe();
    restore_branch();
    has_prerolled_ = is_settled_ = false;
  }
  state_ = state;
  const GstStateChangeReturn ret = gst_element_set_state(stage_->pipeline, state);
  if (ret == GST_STATE_CHANGE_FAILURE) {
    hear();                                       // it may hold the reason
    if (!is_excused_ || state <= GST_STATE_READY) // a broken pipeline can always be stopped
      accuse(std::string("the pipeline does not become ") + name(state));
    is_broken_ = true;
  }
  if (state < GST_STATE_PLAYING)
    witness().expect_silence(std::string("when the pipeline has become ") + name(state));
  if (state <= GST_STATE_READY) {
    hear();
    is_broken_ = has_ended_ = false;
    // READY clears errors, and faults of boards remain until repaired.
    is_excused_ = !boards_are_well();
  }
}

/* ---- steps ---- */

const std::vector<Chaos::Step> &
Chaos::all_steps()
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
  return all;
}

bool
Chaos::is_step(const std::string &name)
{
  return std::ranges::any_of(all_steps(), [&](const Step &each) { return each.name == name; });
}

const Chaos::Step &
Chaos::draw()
{
  int total = 0;
  for (const Step *each : drawn_)
    total += each->weight;
  int left = dice(total);
  for (const Step *each : drawn_) {
    if (left < each->weight)
      return *each;
    left -= each->weight;
  }
  return *drawn_.back();
}

void
Chaos::step()
{
  // After an error, EOS or a long pause, draws mostly steps that resume the film.
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
  const Step &chosen = draw();
  note(chosen.name);
  (this->*chosen.act)();
  // Lets the film play for a random time, or not at all.
  const int pause = dice(3) == 0 ? 0 : dice(12) == 0 ? 1000 + dice(1000) : dice(150);
  std::this_thread::sleep_for(milliseconds(pause));
}

void
Chaos::note(const std::string &what)
{
  steps().add(what + "  [" + name(state_) + (is_broken_ ? ", broken" : "")
              + (has_ended_ ? ", ended" : "") + (is_cut_ ? ", cut" : "")
              + (is_muted_ ? ", muted" : "") + "]");
}

void
Chaos::recover()
{
  note("recover");
  restore_branch();
  repair_boards();
  set_state(dice(2) ? GST_STATE_READY : GST_STATE_NULL);
  is_excused_ = false;
  set_state(GST_STATE_PLAYING);
  std::this_thread::sleep_for(milliseconds(dice(1500)));
}

/* ---- after each step ---- */

bool
Chaos::running_time(gint64 &running)
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

void
Chaos::check()
{
  hear();
  if (state_ < GST_STATE_PLAYING)
    witness().expect_silence(std::string("in ") + name(state_));
  if (is_muted_)
    witness().expect_silence("while muted");
  if (has_ended_ && !Stage::is_beside(kind_) && !is_broken_)
    witness().expect_silence("after the end");
  std::string reason;
  // Other threads may need time. The watchdog ends the wait and reports waiting_for_.
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

void
Chaos::print_states()
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

std::string
Chaos::waiting_for()
{
  std::lock_guard lock(mutex_);
  return waiting_for_;
}
