// SPDX-License-Identifier: LGPL-2.1-or-later
#include "audio_file.h"

#include "files/regular_file.h"
#include "film/or_throw.h"
#include "film/pipeline.h"
#include "translation.h"

#include <gst/app/app.h>
#include <gst/audio/audio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>

namespace {

/// Samples per second; motors vibrate below 400 Hz.
constexpr int kRate = 8000;

void
set(const Pipeline &pipeline, const char *name, const char *property, const std::string &value)
{
  g_object_set(element(pipeline, name).get(), property, value.c_str(), nullptr);
}

/// Runs to the end of the stream. Throws the pipeline's error with `path`, or that the position did
/// not change within `patience`.
void
run(const Pipeline &pipeline, const std::string &path, GstClockTime patience = GST_CLOCK_TIME_NONE)
{
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline.get());
  g_autoptr(GstMessage) message = nullptr;
  for (gint64 before = -2; !message;) {
    message = gst_bus_timed_pop_filtered(
        bus, patience, static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS));
    gint64 at = -1;
    gst_element_query_position(pipeline.get(), GST_FORMAT_TIME, &at);
    if (!message && at == before)
      throw std::runtime_error(in_text("'{}': it cannot be read further; is it damaged?", path));
    before = at;
  }
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
    return;
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  throw std::runtime_error("'" + path + "': " + error->message);
}

/// decodebin's autoplug-select: locations that a file names, such as those of playlists and session
/// descriptions, are not opened.
gint
on_select(GstElement *, GstPad *, GstCaps *, GstElementFactory *factory, gpointer)
{
  constexpr gint kTry = 0; // of decodebin's GstAutoplugSelectResult, which is in no header
  constexpr gint kSkip = 2;
  const std::string_view kind
      = gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_KLASS);
  const auto is = [kind](std::string_view word) {
    return kind.find(word) != std::string_view::npos;
  };
  return is("Adaptive") || is("Network") ? kSkip : kTry;
}

GstFlowReturn
on_sample(GstAppSink *sink, gpointer collector)
{
  g_autoptr(GstSample) sample = gst_app_sink_pull_sample(sink);
  if (!sample)
    return GST_FLOW_EOS;
  return static_cast<AudioCollector *>(collector)->add(sample) ? GST_FLOW_OK : GST_FLOW_EOS;
}

} // namespace

std::string
recording_branch()
{
  // audiorate fills a source's gaps with silence, so that all samples keep their time. Rates beyond
  // those of recordings are a damaged file's: resampling them would take all memory.
  return "audioconvert ! audiorate ! audio/x-raw,rate=[1000,768000] ! audioresample ! "
         "audio/x-raw,format=F64LE,layout=interleaved,rate="
         + std::to_string(kRate) + " ! appsink name=heard sync=false async=false max-buffers=0";
}

void
AudioCollector::listen(GstElement *appsink)
{
  GstAppSinkCallbacks callbacks = {};
  callbacks.new_sample = on_sample;
  gst_app_sink_set_callbacks(GST_APP_SINK(appsink), &callbacks, this, nullptr);
}

bool
AudioCollector::add(GstSample *sample)
{
  GstAudioInfo info;
  GstBuffer *buffer = gst_sample_get_buffer(sample);
  GstMapInfo map;
  if (!gst_audio_info_from_caps(&info, gst_sample_get_caps(sample))
      || !gst_buffer_map(buffer, &map, GST_MAP_READ))
    return true;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto channels = static_cast<std::size_t>(GST_AUDIO_INFO_CHANNELS(&info));
  if (recording_.channels.empty()) {
    recording_.rate = GST_AUDIO_INFO_RATE(&info);
    recording_.full_scale = 1;
    recording_.channels.resize(channels);
    const GstClockTime running = gst_segment_to_running_time(
        gst_sample_get_segment(sample), GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    recording_.start
        = tactor::Time(GST_CLOCK_TIME_IS_VALID(running) ? static_cast<gint64>(running) : 0);
  }
  const std::span values(reinterpret_cast<const gdouble *>(map.data), map.size / sizeof(gdouble));
  if (recording_.size() * channels + values.size() > tactor::Recording::kMostValues)
    fault_ = "the recording is longer than the " + std::to_string(tactor::Recording::kMostValues)
             + " samples that can be read";
  else if (!std::ranges::all_of(values, [](gdouble value) { return std::isfinite(value); }))
    fault_ = "the sound has samples that are not finite; is it damaged?";
  for (std::size_t i = 0; fault_.empty() && i < values.size(); i++)
    recording_.channels[i % channels].push_back(values[i]);
  gst_buffer_unmap(buffer, &map);
  return fault_.empty();
}

tactor::Time
AudioCollector::until()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (recording_.size() == 0)
    return tactor::Time(0);
  return recording_.start
         + tactor::Time(
             std::llround(1e9 * static_cast<double>(recording_.size()) / recording_.rate));
}

tactor::Recording
AudioCollector::take()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!fault_.empty())
    throw std::runtime_error(fault_);
  if (recording_.size() == 0)
    throw std::runtime_error(_("no sound was recorded"));
  return std::move(recording_);
}

void
push_recording(GstElement *appsrc, const tactor::Recording &recording)
{
  const auto channels = static_cast<guint>(recording.channels.size());
  GstAudioInfo info;
  gst_audio_info_set_format(&info, GST_AUDIO_FORMAT_F32LE, static_cast<gint>(recording.rate),
                            static_cast<gint>(channels), nullptr);
  g_autoptr(GstCaps) caps = gst_audio_info_to_caps(&info);
  if (channels > 2) // without positions: channels are tactors
    gst_caps_set_simple(caps, "channel-mask", GST_TYPE_BITMASK, guint64{ 0 }, nullptr);
  gst_app_src_set_caps(GST_APP_SRC(appsrc), caps);
  GstBuffer *buffer
      = gst_buffer_new_allocate(nullptr, recording.size() * channels * sizeof(gfloat), nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  auto *values = reinterpret_cast<gfloat *>(map.data);
  for (std::size_t i = 0; i < recording.size(); i++)
    for (const std::vector<double> &channel : recording.channels)
      *values++ = static_cast<gfloat>(channel[i]);
  gst_buffer_unmap(buffer, &map);
  GST_BUFFER_PTS(buffer) = 0;
  GST_BUFFER_DURATION(buffer)
      = gst_util_uint64_scale(recording.size(), GST_SECOND, static_cast<guint64>(recording.rate));
  gst_app_src_push_buffer(GST_APP_SRC(appsrc), buffer);
  gst_app_src_end_of_stream(GST_APP_SRC(appsrc));
}

tactor::Recording
read_recording(const std::string &path, GstClockTime patience)
{
  if (path.ends_with(".csv") || path.ends_with(".txt"))
    return or_throw(tactor::read_csv_recording(path));
  // filesrc would wait for a pipe's writer.
  if (const auto expected = files::expect_regular(path); !expected)
    throw std::runtime_error("'" + path + "': " + expected.error().reason);
  AudioCollector heard;
  const Pipeline pipeline
      = make_pipeline("filesrc name=file ! decodebin name=decoder ! " + recording_branch());
  set(pipeline, "file", "location", path);
  g_signal_connect(element(pipeline, "decoder").get(), "autoplug-select", G_CALLBACK(on_select),
                   nullptr);
  heard.listen(element(pipeline, "heard").get());
  // decodebin may lose the error of a damaged file and wait forever.
  run(pipeline, path, patience);
  return heard.take();
}

void
write_recording(const tactor::Recording &recording, const std::string &path)
{
  tactor::Recording aligned = recording;
  const auto shift
      = std::lround(std::chrono::duration<double>(recording.start).count() * recording.rate);
  for (std::vector<double> &channel : aligned.channels) {
    if (shift > 0)
      channel.insert(channel.begin(), static_cast<std::size_t>(shift), 0.0);
    else
      channel.erase(channel.begin(), channel.begin() + std::min(-shift, std::ssize(channel)));
  }
  const std::string part = path + ".part";
  {
    const Pipeline pipeline
        = make_pipeline("appsrc name=sound format=time max-bytes=0 ! wavenc ! filesink name=file");
    set(pipeline, "file", "location", part);
    push_recording(element(pipeline, "sound").get(), aligned);
    run(pipeline, path);
  }
  std::filesystem::rename(part, path);
}
