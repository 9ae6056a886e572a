// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A tactorsink on devices behind a server of the real protocols (support/haptic_server.py).
#pragma once

#include <chrono>

#include "support/haptic_server.h"

#include "support/contains.h"
#include "support/playing.h"

#include <gst/base/gstbasesink.h>
#include <gst/tactile/tactile.h>

/// A sink that does not wait for the clock, and its server.
struct ServerRig
{
  ServerRig(const char *driver, const char *device, std::vector<std::string> arguments)
      : server(std::move(arguments))
  {
    const std::string name = server.device(device);
    g_object_set(element, "driver", driver, "device", name.c_str(), "sync", FALSE, "async", FALSE,
                 "rate", 0.0, "compensation", 2, "ramp-in", guint64{ 0 }, "max-active", 0,
                 "max-on-time", guint64{ 0 }, "max-duty", 1.0, nullptr);
    sink_pad = gst_element_get_static_pad(element, "sink");
  }
  ~ServerRig()
  {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(sink_pad);
    gst_object_unref(element);
  }

  void start(guint rows, guint columns)
  {
    fail_if(gst_element_set_state(element, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_stream_start("film")));
    g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(rows, columns, 25, 1);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_caps(caps)));
    begin_segment();
  }
  void begin_segment()
  {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_segment(&segment)));
  }
  GstFlowReturn push(const std::vector<gfloat> &levels)
  {
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = frame++ * 40 * GST_MSECOND;
    GST_BUFFER_DURATION(map) = 40 * GST_MSECOND;
    return gst_pad_chain(sink_pad, map);
  }

  /// Plays maps until there is a message of this name, and returns its reason. No map may fail.
  /// Counts warnings.
  std::string play_until(const char *name)
  {
    constexpr auto kTypes = static_cast<GstMessageType>(GST_MESSAGE_ELEMENT | GST_MESSAGE_WARNING
                                                        | GST_MESSAGE_ERROR);
    for (guint i = 0;; i++) {
      ck_assert_int_eq(push({ 0.05F * static_cast<gfloat>(1 + i % 20) }), GST_FLOW_OK);
      while (g_autoptr(GstMessage) message
             = gst_bus_timed_pop_filtered(messages.bus, GST_MSECOND, kTypes)) {
        ck_assert_int_ne(GST_MESSAGE_TYPE(message), GST_MESSAGE_ERROR);
        warnings += GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING ? 1 : 0;
        if (!gst_message_has_name(message, name))
          continue;
        const gchar *reason
            = gst_structure_get_string(gst_message_get_structure(message), "reason");
        return reason ? reason : "";
      }
    }
  }
  /// Plays maps until the latency that the device tells has been within these for long.
  void play_until_latency(gint64 least_ms, gint64 most_ms)
  {
    gfloat level = 1;
    for (int so = 0; so < 300;) {
      ck_assert_int_eq(push({ level }), GST_FLOW_OK);
      level = 1 - level;
      g_usleep(1000);
      g_autoptr(GstStructure) stats = nullptr;
      g_object_get(element, "actuation-stats", &stats, nullptr);
      gint64 latency = 0;
      fail_unless(gst_structure_get_int64(stats, "latency", &latency));
      const gint64 ms = latency / gint64{ GST_MSECOND };
      so = ms >= least_ms && ms <= most_ms ? so + 1 : 0;
    }
  }
  /// How long the picture waits for the device, beyond rise times and a margin.
  std::chrono::nanoseconds room() const
  {
    const GstClockTime delay = gst_base_sink_get_render_delay(GST_BASE_SINK(element));
    return std::chrono::nanoseconds(delay) - std::chrono::milliseconds(180 + 10);
  }
  /// Takes the information messages, and returns how many have this text.
  guint infos(const char *text) const
  {
    guint count = 0;
    while (g_autoptr(GstMessage) message = gst_bus_pop_filtered(messages.bus, GST_MESSAGE_INFO))
      count += Said(message).text.find(text) != std::string::npos ? 1 : 0;
    return count;
  }

  HapticServer server;
  GstElement *element
      = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
  ElementBus messages{ element };
  GstPad *sink_pad = nullptr;
  guint frame = 0;
  guint warnings = 0;
};

/// Each server, and what it prints when a map of 1 x 1 is 1.
struct Case
{
  const char *driver;
  const char *device;
  const char *kind;
  const char *full;
  const char *zero;
};

inline const std::vector<Case> kCases{
  { "bhaptics", "sleeve-left", "bhaptics", "motors ForearmL 0=100 1=100 2=100 3=100 4=100 5=100",
    "motors ForearmL" },
  { "intiface", "Test Vibrator", "buttplug3", "motors 0 0=1 2=1", "motors 0" },
  { "intiface", "Test Vibrator", "buttplug4", "motors 0 0=20 2=20", "motors 0" },
};
