// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorplanning.h"

#include "gst/fusion/sound_meta.h"

#include <string>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

TactorPlanning::TactorPlanning(GstElement *element) : element_(element)
{
}

void
TactorPlanning::start(const tactor::PlannerSettings &agreed, int tactors,
                      const tactor::Layout &layout, std::vector<tactor::MotorParameters> motors,
                      std::shared_ptr<tactor::DeviceAccount> account)
{
  agreed_ = agreed;
  tactors_ = tactors;
  layout_ = layout;
  planner_.emplace(tactors, agreed, std::move(motors));
  account_ = std::move(account);
  if (account_) {
    const Time now = std::chrono::steady_clock::now().time_since_epoch();
    planner_->resume(account_->uses(now), now);
  }
  stream_ = {};
  standing_ = {};
  checked_rows_ = checked_columns_ = 0;
  last_end_ = Time(0);
  warned_no_meta_ = warned_grid_ = warned_untimed_ = told_number_ = false;
}

bool
TactorPlanning::set_caps(const GstCaps *caps)
{
  return stream_.set_caps(caps);
}

TactorStream::Span
TactorPlanning::shown(GstBuffer *buffer, const GstSegment &segment, std::optional<Time> now)
{
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  const GstClockTime duration = GST_BUFFER_DURATION(buffer);
  if (stream_.is_untimed(segment, pts, duration) && !std::exchange(warned_untimed_, true))
    GST_ELEMENT_WARNING(element_, STREAM, FORMAT,
                        ("The frames have no time stamps: they are felt when they arrive."),
                        ("expected timestamps, which do-timestamp=true gives those of a live "
                         "source, or a framerate in the caps, got neither"));
  // The element that wrote the maps of video frames posts the warning about those.
  if (stream_.is_map() && segment.format == GST_FORMAT_TIME && standing_.stands(pts)
      && standing_.is_news())
    GST_ELEMENT_WARNING(
        element_, STREAM, FORMAT, ("The maps' times do not advance: only the last one is felt."),
        ("expected times that rise from map to map, got %" GST_TIME_FORMAT " for each",
         GST_TIME_ARGS(pts)));
  return stream_.shown(segment, pts, duration, last_end_, now);
}

std::optional<TactorPlanning::Plan>
TactorPlanning::plan_map(GstBuffer *buffer, TactorStream::Span shown,
                         tactor::PlannerSettings settings)
{
  TactorStream::Map map;
  const bool has_levels = stream_.read(buffer, map);
  if (!has_levels && stream_.is_map()) {
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT, ("A tactile map has the wrong size."),
                      ("expected %u x %u float32 levels (%u bytes), got %" G_GSIZE_FORMAT " bytes",
                       stream_.rows(), stream_.columns(), stream_.rows() * stream_.columns() * 4u,
                       gst_buffer_get_size(buffer)));
    return std::nullopt;
  }
  if (!has_levels && !std::exchange(warned_no_meta_, true))
    GST_ELEMENT_WARNING(
        element_, STREAM, FORMAT, ("The video frames carry no tactile map."),
        ("expected a GstTactileMeta on each frame; put saliencytactile before tactorsink, and "
         "behind what moves the picture and drops the map, such as videoflip and videocrop"));

  settings.volts_max = agreed_.volts_max;
  settings.max_lead = agreed_.max_lead;
  settings.line = agreed_.line;
  if (account_)
    account_->set_limits(settings.limits);
  if (has_levels)
    check_grid(map.rows, map.columns, settings);
  if (has_levels && is_pooled(settings)) {
    tactor::pool(map.levels, static_cast<int>(map.rows), static_cast<int>(map.columns), layout_,
                 pooled_);
    map.levels = pooled_;
    // A cell may have several motors.
    settings.limits.max_active *= tactor::most_tactors_of_cell(layout_, static_cast<int>(map.rows),
                                                               static_cast<int>(map.columns));
  }
  planner_->set_settings(settings);
  // The sound's maps: an impact may be over before the next block.
  const bool at_once = stream_.is_map() && GST_BUFFER_FLAG_IS_SET(buffer, kSoundMap);
  Plan plan{ .commands = has_levels
                             ? planner_->plan(shown.start, shown.duration, map.levels, at_once)
                             : planner_->silence(shown.start),
             .end = shown.end() };
  GST_LOG_OBJECT(element_, "map at %" GST_STIME_FORMAT ": %" G_GSIZE_FORMAT " commands",
                 GST_STIME_ARGS(shown.start.count()), plan.commands.size());
  last_end_ = plan.end;
  check_number(planner_->settings());
  return plan;
}

bool
TactorPlanning::is_shown(GstClockTime pts, GstClockTime duration, const GstSegment &segment) const
{
  return stream_.is_shown(segment, pts, duration);
}

TactorPlanning::Plan
TactorPlanning::plan_gap(GstClockTime pts, GstClockTime duration, const GstSegment &segment)
{
  const TactorStream::Span gap
      = stream_.shown(segment, pts, GST_CLOCK_TIME_IS_VALID(duration) ? duration : 0, last_end_);
  last_end_ = gap.end();
  return { .commands = planner_->silence(gap.start), .end = gap.end() };
}

TactorPlanning::Plan
TactorPlanning::plan_rest()
{
  return { .commands = planner_->silence(last_end_), .end = last_end_ };
}

void
TactorPlanning::silenced(Time since)
{
  planner_->silenced(since);
}

void
TactorPlanning::flushed(Time at, bool resets_time)
{
  standing_.restart();
  if (resets_time)
    planner_->reset(at);
  else
    planner_->silenced(at);
  last_end_ = Time(0);
}

tactor::LimitCounters
TactorPlanning::limited() const
{
  return planner_->limited();
}

/// Whether the layout says which tactors a cell has, rather than the mapping.
bool
TactorPlanning::is_pooled(const tactor::PlannerSettings &settings) const
{
  return layout_.tactors() > 0 && settings.mapping.empty();
}

/// Posts once an info message if max-active keeps motors of a layout off.
void
TactorPlanning::check_number(const tactor::PlannerSettings &settings)
{
  if (!is_pooled(settings) || planner_->limited().number == 0 || std::exchange(told_number_, true))
    return;
  GST_ELEMENT_INFO(element_, STREAM, FORMAT,
                   ("Some motors stay off: more would vibrate at once than max-active allows."),
                   ("max-active lets %d of the device's %d motors vibrate at once, those of its "
                    "strongest cells; "
                    "set it to as many cells as may be felt at once, or 0",
                    settings.limits.max_active, layout_.tactors()));
}

/// Posts once an info message if cells share a tactor, and a warning if cells have none.
void
TactorPlanning::check_grid(guint rows, guint columns, const tactor::PlannerSettings &settings)
{
  if (checked_rows_ == rows && checked_columns_ == columns
      && planner_->settings().mapping == settings.mapping)
    return;
  checked_rows_ = rows;
  checked_columns_ = columns;
  GST_INFO_OBJECT(element_, "grid of %u x %u, the board has %d tactors", rows, columns, tactors_);
  if (is_pooled(settings)) {
    if (tactor::pools(layout_, static_cast<int>(rows), static_cast<int>(columns))
        && !std::exchange(warned_grid_, true))
      GST_ELEMENT_INFO(element_, STREAM, FORMAT,
                       ("Cells of the film share motors; of those the strongest is felt."),
                       ("the film's map has %u x %u cells, the device %d x %d motors; rows and "
                        "columns of saliencytactile set the map",
                        rows, columns, layout_.rows, layout_.columns));
    return;
  }
  const std::string problem = tactor::CommandPlanner::validate_mapping(
      settings.mapping, static_cast<int>(rows * columns), tactors_);
  if (problem.empty() || std::exchange(warned_grid_, true))
    return;
  GST_ELEMENT_WARNING(element_, STREAM, FORMAT, ("Some cells of the film have no tactor."),
                      ("%s; set rows and columns of saliencytactile to the chair's grid, or "
                       "mapping of tactorsink",
                       problem.c_str()));
}
