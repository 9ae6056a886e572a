// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/emulated_board.h"

#include "tactor/command_trace.h"
#include "tools/film/or_throw.h"

#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

#include <gst/gst.h>

namespace usb_test {

/// Random 3 × 3 tactile maps, a new one every 200 ms, played in real time by
/// `tactorsink driver=firmata` in this process. A guardian would outlive the emulated USB.
class MapStream
{
public:
  explicit MapStream(int blocks, const std::string &properties = "")
      : trace_path_("/tmp/film-" + std::to_string(getpid()) + ".csv")
  {
    GError *error = nullptr;
    pipeline_ = gst_parse_launch(("appsrc name=maps format=time caps=\"application/x-tactile-map,"
                                  "rows=(int)3,columns=(int)3,framerate=(fraction)30/1\" "
                                  "! tactorsink name=tactors driver=firmata guardian=false "
                                  "trace-location="
                                  + trace_path_ + " " + properties)
                                     .c_str(),
                                 &error);
    if (error)
      throw std::runtime_error(error->message); // GST_PLUGIN_PATH may be wrong
    bus_ = gst_element_get_bus(pipeline_);
    GstElement *maps = gst_bin_get_by_name(GST_BIN(pipeline_), "maps");
    std::mt19937 random(blocks);
    std::vector<float> levels(9);
    for (int frame = 0; frame < blocks * kFrames; frame++) {
      if (frame % kFrames == 0)
        for (float &level : levels)
          level = static_cast<float>(random() % 5) / 4;
      const std::size_t size = levels.size() * sizeof levels[0];
      GstBuffer *buffer = gst_buffer_new_memdup(levels.data(), size);
      GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(frame, GST_SECOND, 30);
      GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
      GstFlowReturn flow;
      g_signal_emit_by_name(maps, "push-buffer", buffer, &flow);
      gst_buffer_unref(buffer);
    }
    GstFlowReturn flow;
    g_signal_emit_by_name(maps, "end-of-stream", &flow);
    gst_object_unref(maps);
  }
  ~MapStream()
  {
    stop();
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
    unlink(trace_path_.c_str());
  }
  MapStream(const MapStream &) = delete;
  MapStream &operator=(const MapStream &) = delete;

  void play()
  {
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }

  /// The motors are off when it returns.
  void pause()
  {
    gst_element_set_state(pipeline_, GST_STATE_PAUSED);
  }

  /// FLUSH_START, as at the start of a seek.
  void flush()
  {
    GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline_), "tactors");
    GstPad *pad = gst_element_get_static_pad(sink, "sink");
    gst_pad_send_event(pad, gst_event_new_flush_start());
    gst_object_unref(pad);
    gst_object_unref(sink);
  }

  void stop()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
  }

  /// Whether there was no error and no warning so far.
  bool is_quiet()
  {
    const auto types = static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING);
    GstMessage *message = gst_bus_pop_filtered(bus_, types);
    if (message)
      gst_message_unref(message);
    return message == nullptr && errors.empty() && warnings.empty();
  }

  /// Waits for a message of this type and, if given, name. False if an error came first.
  bool wait_for(GstMessageType type, const char *name = nullptr)
  {
    for (;;) {
      GstMessage *message = gst_bus_timed_pop(bus_, GST_CLOCK_TIME_NONE);
      const bool is_it
          = GST_MESSAGE_TYPE(message) == type && (!name || gst_message_has_name(message, name));
      const bool is_error = GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR;
      if (is_error || GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
        GError *error = nullptr;
        char *debug = nullptr;
        if (is_error)
          gst_message_parse_error(message, &error, &debug);
        else
          gst_message_parse_warning(message, &error, &debug);
        (is_error ? errors : warnings)
            .push_back(std::string(error->message) + " " + (debug ? debug : ""));
        g_error_free(error);
        g_free(debug);
      }
      gst_message_unref(message);
      if (is_it || is_error)
        return is_it;
    }
  }

  /// The commands sent to the driver. Call it after the end.
  std::vector<tactor::IssuedCommand> trace() const
  {
    return or_throw(tactor::read_command_trace(trace_path_));
  }

  /// Running time 0 on the steady clock. Call it while playing.
  Clock::time_point start() const
  {
    GstQuery *query = gst_query_new_latency();
    GstClockTime latency = 0;
    if (gst_element_query(pipeline_, query))
      gst_query_parse_latency(query, nullptr, &latency, nullptr);
    gst_query_unref(query);
    return Clock::time_point(
        std::chrono::nanoseconds(gst_element_get_base_time(pipeline_) + latency));
  }

  std::vector<std::string> warnings;
  std::vector<std::string> errors;

private:
  static constexpr int kFrames = 6; ///< per block
  GstElement *pipeline_;
  GstBus *bus_;
  const std::string trace_path_;
};

/// The sequence of duties expected of each pin.
inline std::map<int, std::vector<int>>
planned_duties(const std::vector<tactor::IssuedCommand> &trace)
{
  constexpr double kFullScale = 3.0;
  constexpr int kFirstPin = 2; // a Mega has PWM on 2…13
  std::map<int, std::vector<int>> duties;
  for (const tactor::IssuedCommand &line : trace) {
    std::vector<int> &pin = duties[kFirstPin + line.command.tactor];
    const int duty = static_cast<int>(std::lround(line.command.volts / kFullScale * 255));
    if (duty != (pin.empty() ? 0 : pin.back()))
      pin.push_back(duty);
  }
  std::erase_if(duties, [](const auto &pin) { return pin.second.empty(); });
  return duties;
}

} // namespace usb_test
