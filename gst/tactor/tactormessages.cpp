// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactormessages.h"

#include "tactorsettings.h"

#include <algorithm>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

GstResourceError
resource_error(tactor::DriverError::Kind kind)
{
  using Kind = tactor::DriverError::Kind;
  switch (kind) {
  case Kind::not_found:
  case Kind::not_asked:
    return GST_RESOURCE_ERROR_NOT_FOUND;
  case Kind::busy:
    return GST_RESOURCE_ERROR_BUSY;
  case Kind::permission:
    return GST_RESOURCE_ERROR_NOT_AUTHORIZED;
  case Kind::settings:
    return GST_RESOURCE_ERROR_SETTINGS;
  default:
    return GST_RESOURCE_ERROR_OPEN_READ_WRITE;
  }
}

/// Transfer full.
void
post(GstElement *element, GstStructure *structure)
{
  gst_element_post_message(element, gst_message_new_element(GST_OBJECT(element), structure));
}

} // namespace

void
tactor_post_open_error(GstElement *element, const tactor::DriverError &error)
{
  gst_element_message_full(element, GST_MESSAGE_ERROR, GST_RESOURCE_ERROR,
                           resource_error(error.kind), g_strdup(error.text.c_str()), nullptr,
                           __FILE__, G_STRFUNC, __LINE__);
}

void
tactor_post_device_event(GstElement *element, const tactor::DriverEvent &event)
{
  using Kind = tactor::DriverEvent::Kind;
  switch (event.kind) {
  case Kind::opened:
    // The text is also debug text, which gst-launch-1.0 prints.
    GST_ELEMENT_INFO(element, RESOURCE, SETTINGS, ("%s", event.text.c_str()),
                     ("%s", event.text.c_str()));
    break;
  case Kind::warning:
    GST_ELEMENT_WARNING(element, RESOURCE, SETTINGS, ("%s", event.text.c_str()), (nullptr));
    break;
  case Kind::not_stopped:
    // Printed, too, as nobody may read messages any more: the pipeline goes to NULL, or the process
    // ends.
    g_printerr("tactorsink: %s\n", event.text.c_str());
    GST_ELEMENT_WARNING(element, RESOURCE, CLOSE, ("%s", event.text.c_str()), (nullptr));
    post(element, gst_structure_new("tactor-device-not-stopped", "reason", G_TYPE_STRING,
                                    event.text.c_str(), nullptr));
    break;
  case Kind::lost:
    GST_ELEMENT_WARNING(element, RESOURCE, NOT_FOUND,
                        ("The tactor board is gone; the film plays on."),
                        ("%s", event.text.c_str()));
    post(element, gst_structure_new("tactor-device-lost", "reason", G_TYPE_STRING,
                                    event.text.c_str(), nullptr));
    break;
  case Kind::refused:
    GST_ELEMENT_WARNING(element, RESOURCE, SETTINGS, ("%s", event.text.c_str()), (nullptr));
    post(element, gst_structure_new("tactor-device-refused", "reason", G_TYPE_STRING,
                                    event.text.c_str(), nullptr));
    break;
  case Kind::returned:
    GST_ELEMENT_INFO(element, RESOURCE, SETTINGS, ("%s", event.text.c_str()),
                     ("%s", event.text.c_str()));
    post(element, gst_structure_new_empty("tactor-device-found"));
    break;
  }
}

void
tactor_post_line_load(GstElement *element, const TactorLineLoad &load, bool is_too_large)
{
  constexpr double kMillisecond = GST_MSECOND;
  const auto update = static_cast<double>(load.update.count());
  const auto at_once = static_cast<double>(load.at_once.count());
  g_autofree gchar *numbers
      = g_strdup_printf("an update of %" G_GSIZE_FORMAT
                        " tactors is %d bytes, %.1f ms on the line, %.1f times a second at most",
                        load.tactors, load.bytes, update / kMillisecond, GST_SECOND / update);
  if (!is_too_large) {
    GST_ELEMENT_INFO(element, RESOURCE, SETTINGS,
                     ("The chair has many motors for its serial line."),
                     ("%s; those that max-active lets change at once take %.1f ms, which does",
                      numbers, at_once / kMillisecond));
    return;
  }
  GST_ELEMENT_WARNING(
      element, RESOURCE, SETTINGS,
      ("The chair is too large for its serial line: soft starts and quick changes have fewer "
       "steps."),
      ("%s; those that max-active lets change at once take %.1f ms. Set max-active to "
       "%" G_GSIZE_FORMAT
       ", name fewer tactors in mapping, or take two boards, each with a tactorsink",
       numbers, at_once / kMillisecond, std::max<std::size_t>(load.most_active, 1)));
  post(element, gst_structure_new(
                    "tactor-line-slow", "tactors", G_TYPE_UINT, static_cast<guint>(load.tactors),
                    "bytes", G_TYPE_UINT, static_cast<guint>(load.bytes), "update", G_TYPE_UINT64,
                    static_cast<guint64>(load.update.count()), "at-once", G_TYPE_UINT64,
                    static_cast<guint64>(load.at_once.count()), nullptr));
}

void
tactor_post_lead_short(GstElement *element, Time lead, Time late)
{
  GST_WARNING_OBJECT(element,
                     "a command that needs a lead of %" GST_STIME_FORMAT
                     " was late by %" GST_STIME_FORMAT
                     ": is there a queue with max-size-bytes=0 max-size-buffers=0 and enough "
                     "max-size-time before each sink?",
                     GST_STIME_ARGS(lead.count()), GST_STIME_ARGS(late.count()));
  post(element, gst_structure_new("tactor-lead-short", "lead", G_TYPE_UINT64,
                                  static_cast<guint64>(lead.count()), "late", G_TYPE_UINT64,
                                  static_cast<guint64>(late.count()), nullptr));
}

void
tactor_post_stats(GstElement *element, GstStructure *stats)
{
  gst_structure_set_name(stats, "tactor-stats");
  post(element, stats);
}

GstStructure *
tactor_stats_new(const TactorActuation::Counters &counters, const tactor::DriverStatus &board,
                 Time latency, const tactor::LimitCounters &limited, tactor::Scheduling scheduling)
{
  GstStructure *stats = gst_structure_new(
      "application/x-tactor-stats", "board", G_TYPE_STRING, board.board.c_str(), "firmware",
      G_TYPE_STRING, board.firmware.c_str(), "scheduling", G_TYPE_STRING,
      tactor::to_string(scheduling).data(), "connected", G_TYPE_BOOLEAN,
      static_cast<gboolean>(board.is_there), "watchdog", G_TYPE_BOOLEAN,
      static_cast<gboolean>(board.has_watchdog), "guardian", G_TYPE_STRING, board.guardian.c_str(),
      "may-run", G_TYPE_BOOLEAN, static_cast<gboolean>(board.may_run), nullptr);
  const std::pair<const gchar *, guint64> counts[] = {
    { "issued", counters.issued },       { "late", counters.late },
    { "came-late", counters.came_late }, { "thread-late", counters.thread_late },
    { "coalesced", counters.coalesced }, { "dropped", counters.dropped },
    { "expired", counters.expired },     { "overtaken", board.overtaken },
    { "starved", counters.starved },     { "cut-on-time", limited.on_time },
    { "cut-duty", limited.duty },        { "cut-active", limited.number },
    { "cut-driver", board.cuts },        { "ramps", counters.ramps },
    { "reconnects", board.reconnects },  { "bytes", board.bytes },
  };
  const std::pair<const gchar *, Time> times[] = {
    { "error-min", counters.error.min() },
    { "error-mean", counters.error.mean() },
    { "error-p50", counters.error.percentile(0.5) },
    { "error-p99", counters.error.percentile(0.99) },
    { "error-max", counters.error.max() },
    { "thread-p99", counters.thread_error.percentile(0.99) },
    { "thread-max", counters.thread_error.max() },
    { "latency", latency },
  };
  for (const auto &[name, count] : counts)
    gst_structure_set(stats, name, G_TYPE_UINT64, count, nullptr);
  for (const auto &[name, time] : times)
    gst_structure_set(stats, name, G_TYPE_INT64, static_cast<gint64>(time.count()), nullptr);
  GValue pins = G_VALUE_INIT;
  g_value_init(&pins, GST_TYPE_ARRAY);
  tactor_ints_to_value(board.pins, &pins);
  gst_structure_take_value(stats, "pins", &pins);
  return stats;
}
