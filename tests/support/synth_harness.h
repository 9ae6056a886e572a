// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What tests of tactilesynth share: maps in, samples out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "support/ones.h"
#include "support/playing.h"
#include "support/tolerance.h"

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/audio/audio.h>
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

inline constexpr GstClockTime kFrame = 40 * GST_MSECOND;
inline constexpr int kRate = 48000;

/// Half of the time in which an amplitude changes.
inline constexpr GstClockTime kHalfRamp = 6 * GST_MSECOND;

/// No rise time, limits or soft start: what a map has is what sounds.
inline constexpr const char *kPlain
    = "tactilesynth rise-time=0 max-on-time=0 max-duty=0 max-active=0 ramp-in=0 ";

inline std::string
map_caps(int rows, int columns)
{
  return "application/x-tactile-map,rows=" + std::to_string(rows)
         + ",columns=" + std::to_string(columns) + ",framerate=25/1";
}

inline std::string
sound_caps(int channels, const std::string &more = "")
{
  return "audio/x-raw,channels=" + std::to_string(channels) + more;
}

/// tactilesynth, fed with maps; its samples as they come.
class Harness
{
public:
  Harness(const std::string &line, int rows, int columns, const std::string &out)
      : h(gst_harness_new_parse(line.c_str())), bus(gst_bus_new())
  {
    GstElement *synth = gst_harness_find_element(h, "tactilesynth");
    gst_element_set_bus(synth, bus);
    gst_object_unref(synth);
    gst_harness_set_sink_caps_str(h, out.c_str());
    gst_harness_set_src_caps_str(h, map_caps(rows, columns).c_str());
  }
  ~Harness()
  {
    gst_harness_teardown(h);
    gst_object_unref(bus);
  }
  Harness(const Harness &) = delete;
  Harness &operator=(const Harness &) = delete;

  GstFlowReturn push(const std::vector<float> &levels, GstClockTime pts,
                     GstClockTime duration = kFrame)
  {
    GstBuffer *buffer = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(buffer) = pts;
    GST_BUFFER_DURATION(buffer) = duration;
    const GstFlowReturn flow = gst_harness_push(h, buffer);
    take();
    return flow;
  }
  /// Pushes a map `times` times, from the end of the last one on.
  void repeat(const std::vector<float> &levels, int times)
  {
    for (int i = 0; i < times; i++, time += kFrame)
      fail_unless_equals_int(push(levels, time), GST_FLOW_OK);
  }
  void push(GstEvent *event)
  {
    fail_unless(gst_harness_push_event(h, event));
    take();
  }
  void end()
  {
    push(gst_event_new_eos());
  }
  void seek(double rate, GstClockTime start, GstClockTime stop)
  {
    push(gst_event_new_flush_start());
    push(gst_event_new_flush_stop(TRUE));
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.rate = rate;
    segment.start = segment.time = start;
    segment.stop = stop;
    push(gst_event_new_segment(&segment));
    samples.clear();
    first.reset();
    next = GST_CLOCK_TIME_NONE;
  }

  /// Takes what came. Without a discontinuity each buffer begins where the last one ended.
  void take()
  {
    while (GstBuffer *buffer = gst_harness_try_pull(h)) {
      if (GST_BUFFER_IS_DISCONT(buffer))
        discontinuities++;
      else
        fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), next);
      if (!first)
        first = GST_BUFFER_PTS(buffer);
      next = GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer);
      GstMapInfo map;
      gst_buffer_map(buffer, &map, GST_MAP_READ);
      const auto *values = reinterpret_cast<const float *>(map.data);
      samples.insert(samples.end(), values, values + map.size / sizeof(float));
      const bool silent = std::all_of(values, values + map.size / sizeof(float),
                                      [](float value) { return value == 0; });
      fail_unless_equals_int(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP), silent);
      gst_buffer_unmap(buffer, &map);
      gst_buffer_unref(buffer);
    }
  }

  /// One channel's sample at a time; samples are without gaps.
  float at(GstClockTime when, std::size_t channels = 1, std::size_t channel = 0) const
  {
    const auto index = gst_util_uint64_scale_round(when - *first, kRate, GST_SECOND);
    return samples.at(index * channels + channel);
  }
  /// The first time at which a channel is at `level` or above, or below if it `falls`.
  GstClockTime reaches(float level, GstClockTime from, bool falls = false) const
  {
    for (GstClockTime when = from;; when += 20 * GST_USECOND)
      if ((at(when) >= level) != falls)
        return when;
  }
  std::optional<Said> said(GstMessageType type) const
  {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, type);
    return message ? std::optional<Said>(message) : std::nullopt;
  }
  GstEvent *last_event(GstEventType type)
  {
    GstEvent *found = nullptr;
    while (GstEvent *event = gst_harness_try_pull_event(h)) {
      if (GST_EVENT_TYPE(event) == type)
        gst_event_replace(&found, event);
      gst_event_unref(event);
    }
    fail_unless(found != nullptr);
    return found;
  }

  GstHarness *h;
  GstBus *bus;
  std::vector<float> samples;
  std::optional<GstClockTime> first; ///< running time of the first sample
  GstClockTime next = GST_CLOCK_TIME_NONE;
  GstClockTime time = 0;
  int discontinuities = 0;
};

inline void
fail_unless_within(GstClockTime value, GstClockTime expected, GstClockTime tolerance)
{
  fail_unless(value + tolerance >= expected && value <= expected + tolerance,
              "%" GST_TIME_FORMAT ", expected %" GST_TIME_FORMAT, GST_TIME_ARGS(value),
              GST_TIME_ARGS(expected));
}

/// The error of an element that does not reach PAUSED.
inline std::string
refusal(const std::string &line)
{
  GstElement *element = make_pipeline(line);
  const ElementBus bus(element);
  fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED),
                         GST_STATE_CHANGE_FAILURE);
  const std::string text = bus.said(GST_MESSAGE_ERROR).text;
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
  return text;
}
