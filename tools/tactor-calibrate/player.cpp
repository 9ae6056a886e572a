// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player.h"
#include "audio_file.h"

#include "film/command_line.h"
#include "film/device_list.h"
#include "film/or_throw.h"
#include "film/pipeline.h"
#include "translation.h"

#include <gst/app/app.h>
#include <gst/base/gstbasesink.h>
#include <gst/gst.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

namespace {

using tactor::Time;
using namespace std::chrono_literals;

constexpr guint kMostColumns = GST_TACTILE_MAX_SIDE;
constexpr Time kTail = 300ms;  ///< is recorded after the last frame
constexpr Time kPatience = 5s; ///< how late the source may be

/// A temporary file, removed with the object.
class TraceFile
{
public:
  TraceFile()
  {
    g_autoptr(GError) error = nullptr;
    const gint fd = g_file_open_tmp("tactor-calibrate-XXXXXX", &path_, &error);
    if (fd < 0)
      throw std::runtime_error(error->message);
    close(fd);
  }
  ~TraceFile()
  {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    g_free(path_);
  }
  TraceFile(const TraceFile &) = delete;
  TraceFile &operator=(const TraceFile &) = delete;

  const gchar *path() const
  {
    return path_;
  }

private:
  gchar *path_ = nullptr;
};

/// The element that plays on a sound card.
std::string
audio_line(const PlayerSettings &settings)
{
  std::string line = "tactoraudiosink name=tactors channels=" + std::to_string(settings.channels)
                     + " frequency=" + launch_value(settings.frequency);
  if (!settings.device.empty())
    line += " audio-sink=" + launch_value(audio_sink(settings.device));
  return line;
}

std::string
launch_line(const PlayerSettings &settings)
{
  std::string line = "appsrc name=frames format=time max-bytes=0 ! "
                     + (settings.driver == kAudio ? audio_line(settings)
                                                  : std::string("tactorsink name=tactors"));
  if (settings.source == "simulator")
    line += " appsrc name=microphone format=time max-bytes=0 ! " + recording_branch();
  else if (!settings.source.empty())
    line += " " + settings.source
            + " ! queue max-size-time=2000000000 max-size-bytes=0 max-size-buffers=0 ! "
            + recording_branch();
  return line;
}

/// Cell i is tactor i, whatever layout a device has.
std::string
mapping_of(std::size_t tactors)
{
  std::string mapping;
  for (std::size_t i = 0; i < tactors; i++)
    mapping += (i == 0 ? "" : ",") + std::to_string(i);
  return mapping;
}

void
push_frames(GstElement *source, const std::vector<Frame> &frames)
{
  const auto tactors = static_cast<guint>(frames.front().levels.size());
  const guint columns = std::min(tactors, kMostColumns);
  const guint rows = (tactors + columns - 1) / columns;
  if (rows > kMostColumns)
    throw std::runtime_error(
        in_text("expected 4096 tactors at most, got {}", std::to_string(tactors)));
  g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(rows, columns, 0, 1);
  gst_app_src_set_caps(GST_APP_SRC(source), caps);
  for (const Frame &frame : frames) {
    std::vector<float> levels = frame.levels;
    levels.resize(static_cast<std::size_t>(rows) * columns);
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = static_cast<GstClockTime>(frame.begin.count());
    GST_BUFFER_DURATION(map) = static_cast<GstClockTime>(frame.duration.count());
    gst_app_src_push_buffer(GST_APP_SRC(source), map);
  }
  gst_app_src_end_of_stream(GST_APP_SRC(source));
}

[[noreturn]] void
throw_message(GstMessage *message)
{
  g_autoptr(GError) error = nullptr;
  g_autofree gchar *debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  throw std::runtime_error(error->message);
}

[[noreturn]] void
throw_interrupted()
{
  throw std::runtime_error(_("interrupted; all motors are off"));
}

/// Takes the pipeline to PAUSED. A microphone is live: without this, running time would begin
/// before the board is open. Throws if there is none.
void
wait_for_board(GstElement *pipeline, GstElement *tactors, GstBus *bus,
               const std::atomic<bool> &interrupted)
{
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  while (gst_element_get_state(tactors, nullptr, nullptr, 50 * GST_MSECOND)
         == GST_STATE_CHANGE_ASYNC)
    if (interrupted)
      throw_interrupted();
  std::string told;
  while (g_autoptr(GstMessage) message = gst_bus_pop_filtered(
             bus, static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING
                                              | GST_MESSAGE_INFO))) {
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
      throw_message(message);
    g_autoptr(GError) said = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING)
      gst_message_parse_warning(message, &said, nullptr);
    else
      gst_message_parse_info(message, &said, nullptr);
    told = said->message;
  }
  is_simulated(tactors, told);
}

/// Sets the properties of tactorsink that tactoraudiosink does not share. Limits for motors and
/// skin hold; properties that would change or delay other commands are off.
void
set_tactorsink(GstElement *tactors, const PlayerSettings &settings, std::size_t count)
{
  const bool simulated = settings.source == "simulator";
  g_object_set(tactors, "driver", simulated ? "simulator" : settings.driver.c_str(), "sync",
               !simulated, nullptr);
  if (!simulated)
    g_object_set(tactors, "mapping", mapping_of(count).c_str(), nullptr);
  if (!settings.device.empty() && !simulated)
    g_object_set(tactors, "device", settings.device.c_str(), nullptr);
  if (!settings.compensate)
    g_object_set(tactors, "voltage-min", 0.0, "max-lead", guint64{ 0 }, nullptr);
  gst_util_set_object_arg(G_OBJECT(tactors), "compensation",
                          settings.compensate ? "exact" : "none");
}

void
set_tactoraudiosink(GstElement *tactors, const PlayerSettings &settings, std::size_t count)
{
  if (count > static_cast<std::size_t>(settings.channels))
    throw std::runtime_error(in_text("expected tactors of 0 to {}, which are the card's channels, "
                                     "got {}; --channels says how many there are",
                                     std::to_string(settings.channels - 1),
                                     std::to_string(count - 1)));
  g_object_set(tactors, "mapping", mapping_of(count).c_str(), nullptr);
  if (!settings.compensate)
    g_object_set(tactors, "rise-time", guint64{ 0 }, nullptr);
}

/// The latency that a sink adds to running time.
Time
latency_of(GstElement *sink)
{
  if (GST_IS_BASE_SINK(sink))
    return Time(static_cast<gint64>(gst_base_sink_get_latency(GST_BASE_SINK(sink))));
  Time longest{ 0 };
  GstIterator *sinks = gst_bin_iterate_sinks(GST_BIN(sink));
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(sinks, &item) == GST_ITERATOR_OK) {
    longest = std::max(longest, latency_of(GST_ELEMENT(g_value_get_object(&item))));
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(sinks);
  return longest;
}

bool
is_playing(GstElement *pipeline)
{
  GstState state = GST_STATE_NULL;
  gst_element_get_state(pipeline, &state, nullptr, 0);
  return state == GST_STATE_PLAYING;
}

bool
is_stats(GstMessage *message)
{
  const GstStructure *structure = gst_message_get_structure(message);
  return structure && gst_structure_has_name(structure, "tactor-stats");
}

} // namespace

Played
play(const std::vector<Frame> &frames, const PlayerSettings &settings,
     const std::atomic<bool> &interrupted)
{
  const bool simulated = settings.source == "simulator";
  const bool is_audio = settings.driver == kAudio;
  const Time end = frames.back().begin + frames.back().duration;
  const TraceFile trace_file;
  Played played;
  AudioCollector heard;
  {
    const Pipeline pipeline = make_pipeline(launch_line(settings));
    const Owned<GstElement> tactors = element(pipeline, "tactors");
    g_object_set(tactors.get(), "trace-location", trace_file.path(), "rate", 0.0, "voltage-max",
                 settings.volts_max, "ramp-in", guint64{ 0 }, nullptr);
    if (!settings.calibration.empty())
      g_object_set(tactors.get(), "calibration", settings.calibration.c_str(), nullptr);
    (is_audio ? set_tactoraudiosink : set_tactorsink)(tactors.get(), settings,
                                                      frames.front().levels.size());
    if (!settings.source.empty())
      heard.listen(element(pipeline, "heard").get());
    push_frames(element(pipeline, "frames").get(), frames);

    const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
    wait_for_board(pipeline.get(), tactors.get(), bus.get(), interrupted);
    gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
    const gint64 begin = g_get_monotonic_time();
    Time latency{ 0 };
    bool over = false;
    bool has_begun = false;
    while (!over) {
      if (interrupted)
        throw_interrupted();
      g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
          bus.get(), 50 * GST_MSECOND,
          static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS | GST_MESSAGE_ELEMENT));
      if (message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
        throw_message(message);
      // A sound card has no statistics.
      if (is_audio ? !has_begun && is_playing(pipeline.get()) : message && is_stats(message)) {
        has_begun = true;
        latency = simulated ? Time(0) : latency_of(tactors.get());
        if (simulated) {
          gst_element_set_state(tactors.get(), GST_STATE_PAUSED); // completes the trace
          push_recording(element(pipeline, "microphone").get(),
                         hear(or_throw(tactor::read_command_trace(trace_file.path())),
                              settings.motors, settings.sensor, end + kTail));
        }
      }
      over = message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
      if (has_begun && simulated)
        over |= gst_app_sink_is_eos(GST_APP_SINK(element(pipeline, "heard").get()));
      else if (has_begun && (!is_audio || !settings.source.empty())) // else EOS comes
        over |= settings.source.empty() || heard.until() >= end + latency + kTail;
      const Time waited = std::chrono::microseconds(g_get_monotonic_time() - begin);
      if (!over && !simulated && waited > end + latency + kTail + kPatience)
        throw std::runtime_error(
            in_text("the source '{}' stopped; expected sound until {} ms, got it until {} ms",
                    settings.source, std::to_string((end + latency) / 1ms),
                    std::to_string(heard.until() / 1ms)));
    }
    if (!settings.source.empty()) {
      played.recording = heard.take();
      // tactorsink's trace has running times without the pipeline's latency.
      played.recording.start -= latency;
    }
  }
  played.trace = or_throw(tactor::read_command_trace(trace_file.path()));
  return played;
}
