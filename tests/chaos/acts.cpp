// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What applications and users do, and what happens to boards.
#include "chaos.h"
#include "report.h"

#include <utility>

using std::chrono::milliseconds;

void
Chaos::play()
{
  if (is_broken_)
    return;
  set_state(GST_STATE_PLAYING);
  // Usually waits for preroll. A live pipeline does not preroll.
  if (dice(4) && !is_cut_ && !has_ended_)
    await([this] {
      GstState state = GST_STATE_NULL;
      return gst_element_get_state(stage_->pipeline, &state, nullptr, 0) != GST_STATE_CHANGE_ASYNC
             || has_ended_ || stage_->is_at_end();
    });
}

void
Chaos::pause()
{
  if (state_ >= GST_STATE_PAUSED && !is_broken_)
    set_state(GST_STATE_PAUSED);
}

void
Chaos::ready()
{
  set_state(GST_STATE_READY);
}

void
Chaos::null()
{
  set_state(GST_STATE_NULL);
}

void
Chaos::seek()
{
  if (!has_prerolled_ || is_broken_)
    return;
  // Changes the rate by seeking: if GST_SEEK_FLAG_INSTANT_RATE_CHANGE meets a flush, GStreamer 1.22
  // asserts in gst_segment_position_from_running_time_full.
  static constexpr std::array<double, 7> kRates{ 1, 1, 0.25, 0.5, 2, 4, -1 };
  const double rate = pick(kRates);
  // A non-flushing seek waits for the streaming thread, which is blocked while paused.
  GstState now = GST_STATE_NULL;
  const bool plays
      = gst_element_get_state(stage_->pipeline, &now, nullptr, 0) == GST_STATE_CHANGE_SUCCESS
        && now == GST_STATE_PLAYING && !has_ended_ && !is_cut_;
  const bool flush = dice(4) > 0 || !plays;
  const auto kind = pick(std::array<GstSeekFlags, 3>{ GST_SEEK_FLAG_ACCURATE,
                                                      GST_SEEK_FLAG_KEY_UNIT, GST_SEEK_FLAG_NONE });
  const gint64 place = dice(20) == 0 ? 0 : static_cast<gint64>(fraction() * kFilmLength);
  const auto flags
      = static_cast<GstSeekFlags>(kind | (flush ? GST_SEEK_FLAG_FLUSH : GST_SEEK_FLAG_NONE));
  g_autofree char *text = g_strdup_printf("  seek to %.3f s, rate %g, flags %d",
                                          static_cast<double>(place) / GST_SECOND, rate, flags);
  steps().add(text);
  const bool sought
      = gst_element_seek(stage_->pipeline, rate, GST_FORMAT_TIME, flags, GST_SEEK_TYPE_SET,
                         rate > 0 ? place : 0, GST_SEEK_TYPE_SET, rate > 0 ? -1 : place);
  is_settled_ = is_settled_ && !flush;
  if (sought && flush)
    has_ended_ = false;
}

void
Chaos::skip_frames()
{
  if (!is_settled_ || is_broken_ || has_ended_ || state_ != GST_STATE_PAUSED)
    return;
  // GstBaseSink (1.22) loses its state for a step until the next frame. After the last frame it
  // waits forever.
  GstState now = GST_STATE_NULL;
  if (gst_element_get_state(stage_->pipeline, &now, nullptr, 0) != GST_STATE_CHANGE_SUCCESS
      || now != GST_STATE_PAUSED || stage_->is_at_end())
    return;
  gst_element_send_event(stage_->pipeline,
                         gst_event_new_step(GST_FORMAT_BUFFERS, 1, 1.0, TRUE, FALSE));
}

void
Chaos::change_caps()
{
  static constexpr std::array<const char *, 4> kSizes{ "width=160,height=120",
                                                       "width=320,height=240", "width=64,height=64",
                                                       "width=33,height=17" };
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

void
Chaos::change_property()
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
    g_object_set(tactors, "max-lead", dice(181) * GST_MSECOND, nullptr);
    break;
  case 4: {
    const bool mirrored = dice(2);
    gst_util_set_object_arg(G_OBJECT(tactors), "mapping", mirrored ? "<2,1,0,5,4,3,8,7,6>" : "<>");
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
    // A longer latency than the queues hold would deadlock the sinks.
    g_object_set(tactors, "ts-offset",
                 gint64{ dice(200) - 100 } * GST_MSECOND / (stage_->is_seekable() ? 10 : 1),
                 nullptr);
    break;
  case 8:
    if (!stage_->is_seekable()) // for the same reason
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

void
Chaos::change_clock()
{
  GstClock *clock = nullptr;
  switch (dice(3)) {
  case 0:
    gst_pipeline_auto_clock(GST_PIPELINE(stage_->pipeline));
    break;
  case 1: // starts at an arbitrary time
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

void
Chaos::change_latency()
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

void
Chaos::query()
{
  gint64 value = 0;
  gst_element_query_position(stage_->pipeline, GST_FORMAT_TIME, &value);
  gst_element_query_duration(stage_->pipeline, GST_FORMAT_TIME, &value);
  GstQuery *latency = gst_query_new_latency();
  gst_element_query(stage_->pipeline, latency);
  gst_query_unref(latency);
  GstStructure *stats = nullptr;
  g_object_get(stage_->tactors, "actuation-stats", &stats, nullptr);
  guint64 issued = 0;
  guint64 late = 0;
  if (!gst_structure_get(stats, "issued", G_TYPE_UINT64, &issued, "late", G_TYPE_UINT64, &late,
                         nullptr)
      || late > issued)
    accuse("more commands were late than were issued");
  gst_structure_free(stats);
}

bool
Chaos::can_end() const
{
  return !is_broken_
         && (stage_->is_seekable() ? has_prerolled_.load() : state_ == GST_STATE_PLAYING);
}

void
Chaos::send_eos()
{
  if (can_end())
    gst_element_send_event(stage_->pipeline, gst_event_new_eos());
}

void
Chaos::post_error()
{
  let_begin();
  is_excused_ = true;
  GST_ELEMENT_ERROR(stage_->analysis && dice(2) ? stage_->analysis : stage_->tactors, STREAM,
                    FAILED, ("Chaos."), (nullptr));
  hear();
}

void
Chaos::dispose()
{
  leave_stage();
  repair_boards_without_stage();
  make_stage();
}

/* ---- boards ---- */

void
Chaos::change_device()
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
  // The other kind of board may be plugged in. Any outcome is allowed.
  is_excused_ = true;
}

void
Chaos::plug(MemoryBoard &board)
{
  if (!board.is_plugged)
    witness().sockets.plug(board);
}

void
Chaos::plug()
{
  plug(dice(3) ? witness().mega : witness().seat);
}

void
Chaos::unplug()
{
  is_excused_ = true;
  MemoryBoard &board = dice(3) ? witness().mega : witness().seat;
  if (board.is_plugged)
    witness().sockets.unplug(board);
}

void
Chaos::refuse()
{
  is_excused_ = true;
  static constexpr std::array<tactor::DriverError::Kind, 3> kKinds{
    tactor::DriverError::Kind::busy, tactor::DriverError::Kind::permission,
    tactor::DriverError::Kind::failed
  };
  const auto kind = pick(kKinds);
  witness().sockets.locked([=] { witness().mega.refusal = kind; });
}

void
Chaos::stall_board()
{
  is_excused_ = true;
  const bool writes = dice(2);
  witness().sockets.locked(
      [=] { (writes ? witness().mega.takes_nothing : witness().mega.says_nothing) = true; });
}

void
Chaos::repair_boards()
{
  // A stalled board still has its old levels, so it is unplugged.
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

void
Chaos::repair_boards_without_stage()
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

bool
Chaos::boards_are_well()
{
  return witness().sockets.locked([] {
    return witness().mega.is_plugged && !witness().mega.refusal && !witness().mega.takes_nothing
           && !witness().mega.says_nothing;
  });
}
