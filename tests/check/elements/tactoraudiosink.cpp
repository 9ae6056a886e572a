// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/contains.h"
#include "support/playing.h"
#include "support/spectrum.h"
#include "support/tolerance.h"

#include <gst/audio/audio.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "support/check_tests.h"

namespace {

/// Maps of 1 × 2 at 25 frames a second: silent, but in [begin, end).
class Film
{
public:
  Film(const std::string &properties, int begin, int end, int frames)
      : pipeline(make_pipeline("appsrc name=source format=time caps=application/x-tactile-map,"
                               "rows=1,columns=2,framerate=25/1 ! tactoraudiosink name=sink "
                               + properties)),
        sink(gst_bin_get_by_name(GST_BIN(pipeline), "sink"))
  {
    g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
    for (int i = 0; i < frames; i++) {
      const gfloat levels[] = { i >= begin && i < end ? 1.0F : 0.0F, 0 };
      GstBuffer *map = gst_tactile_map_buffer_new(levels, 2);
      GST_BUFFER_PTS(map) = static_cast<GstClockTime>(i) * 40 * GST_MSECOND;
      GST_BUFFER_DURATION(map) = 40 * GST_MSECOND;
      GstFlowReturn flow = GST_FLOW_ERROR;
      g_signal_emit_by_name(source, "push-buffer", map, &flow);
      gst_buffer_unref(map);
      fail_unless_equals_int(flow, GST_FLOW_OK);
    }
    GstFlowReturn flow = GST_FLOW_ERROR;
    g_signal_emit_by_name(source, "end-of-stream", &flow);
  }
  ~Film()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(sink);
    gst_object_unref(pipeline);
  }
  Film(const Film &) = delete;
  Film &operator=(const Film &) = delete;

  GstElement *pipeline;
  GstElement *sink;
};

struct Heard
{
  std::vector<float> samples;
  GstAudioInfo info;
  GstClockTime end = 0;
};

std::vector<float>
samples_of(const GstMapInfo &map, GstAudioFormat format)
{
  std::vector<float> samples;
  if (format == GST_AUDIO_FORMAT_F32) {
    const auto *values = reinterpret_cast<const float *>(map.data);
    samples.assign(values, values + map.size / sizeof(float));
  } else {
    fail_unless_equals_int(format, GST_AUDIO_FORMAT_S16);
    const auto *values = reinterpret_cast<const gint16 *>(map.data);
    std::transform(values, values + map.size / sizeof(gint16), std::back_inserter(samples),
                   [](gint16 value) { return static_cast<float>(value) / 32768; });
  }
  return samples;
}

/// What an appsink within the bin gets to the end.
Heard
hear(const Film &film)
{
  change_state(film.pipeline, GST_STATE_READY); // from then on it is in the bin
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(film.sink), "heard");
  Heard heard;
  gst_element_set_state(film.pipeline, GST_STATE_PLAYING);
  for (;;) {
    GstSample *sample = nullptr;
    g_signal_emit_by_name(sink, "pull-sample", &sample);
    if (sample == nullptr)
      return heard;
    fail_unless(gst_audio_info_from_caps(&heard.info, gst_sample_get_caps(sample)));
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    heard.end = GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_READ);
    const std::vector<float> more = samples_of(map, GST_AUDIO_INFO_FORMAT(&heard.info));
    heard.samples.insert(heard.samples.end(), more.begin(), more.end());
    gst_buffer_unmap(buffer, &map);
    gst_sample_unref(sample);
  }
}

double
peak_of(const Heard &heard, std::size_t channel)
{
  double peak = 0;
  for (std::size_t i = channel; i < heard.samples.size();
       i += static_cast<std::size_t>(GST_AUDIO_INFO_CHANNELS(&heard.info)))
    peak = std::max(peak, std::abs(static_cast<double>(heard.samples[i])));
  return peak;
}

constexpr const char *kHeard = "audio-sink=\"appsink name=heard sync=false\" ";

} // namespace

CHECK_TEST(test_channels)
{
  const struct
  {
    const char *properties;
    std::vector<double> peaks; ///< of the left cell
  } cards[] = {
    { "", { 1, 0 } },
    { "channels=1", { 1 } },
    { "channels=4", { 0, 0, 1, 0 } },
    { "channels=4 mapping=1,3", { 0, 1, 0, 0 } },
    { "channels=6", { 0, 0, 0, 1, 1, 0 } },
    { "channels=9", { 1, 0, 0, 0, 0, 0, 0, 0, 0 } },
    { "gain=0.25,1", { 0.25, 0 } },
  };
  for (const auto &card : cards) {
    const Film film(kHeard + std::string(card.properties), 5, 20, 25);
    const Heard heard = hear(film);
    ck_assert_int_eq(GST_AUDIO_INFO_CHANNELS(&heard.info), card.peaks.size());
    for (std::size_t i = 0; i < card.peaks.size(); i++)
      fail_unless_near(peak_of(heard, i), card.peaks[i], 1e-3);
  }
}

CHECK_TEST(test_silent_at_the_end)
{
  // The last map vibrates. All that follows is its ramp.
  const Film film(kHeard, 5, 25, 25);
  const Heard heard = hear(film);
  fail_unless(peak_of(heard, 0) > 0.9);
  fail_unless_equals_float(heard.samples.back(), 0);
  fail_unless(heard.end >= GST_SECOND + 6 * GST_MSECOND
              && heard.end <= GST_SECOND + 20 * GST_MSECOND);
  wait_for_eos(film.pipeline);
}

CHECK_TEST(test_converts)
{
  // A card of 16 bits and another rate hears the carrier at its time, from 0.2 to 0.8 s: nothing is
  // resampled.
  constexpr int kRate = 44100;
  const Film film("rise-time=0 ramp-in=0 audio-sink=\"appsink name=heard sync=false "
                  "caps=audio/x-raw,format=S16LE,rate=44100\"",
                  5, 20, 25);
  const Heard heard = hear(film);
  ck_assert_int_eq(GST_AUDIO_INFO_FORMAT(&heard.info), GST_AUDIO_FORMAT_S16LE);
  ck_assert_int_eq(GST_AUDIO_INFO_RATE(&heard.info), kRate);
  const std::vector<float> left = channel_of(heard.samples, 2, 0);
  const auto between = [&](double begin, double end) {
    return std::span(left).subspan(static_cast<std::size_t>(std::lround(begin * kRate)),
                                   static_cast<std::size_t>(std::lround((end - begin) * kRate)));
  };
  const auto strongest = [&](double begin, double end) {
    double peak = 0;
    for (const float sample : between(begin, end))
      peak = std::max(peak, std::abs(static_cast<double>(sample)));
    return peak;
  };
  constexpr double kDither = 2.0 / 32768;
  fail_unless_at_most(strongest(0, 0.194), kDither);
  fail_unless(strongest(0.2, 0.22) > 0.9);
  fail_unless_near(spectrum_of(between(0.25, 0.75))[30], 1, 1e-3); // bins of 2 Hz
  fail_unless_at_most(strongest_outside(between(0.25, 0.75), kRate, 50, 70), -80);
  fail_unless(strongest(0.78, 0.8) > 0.9);
  fail_unless_at_most(strongest(0.8061, 1), kDither);
}

CHECK_TEST(test_properties_are_those_of_tactilesynth)
{
  GstElement *bin = gst_element_factory_make("tactoraudiosink", nullptr);
  g_autoptr(GstElement) synth = gst_bin_get_by_name(GST_BIN(bin), "synth");
  guint count = 0;
  g_autofree GParamSpec **specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(synth), &count);
  guint own = 0;
  for (guint i = 0; i < count; i++) {
    if (specs[i]->owner_type != G_OBJECT_TYPE(synth))
      continue;
    own++;
    GParamSpec *forwarded = g_object_class_find_property(G_OBJECT_GET_CLASS(bin), specs[i]->name);
    fail_unless(forwarded != nullptr && forwarded->value_type == specs[i]->value_type);
  }
  fail_unless(own >= 15);
  g_object_set(bin, "frequency", "33", "intensity", 0.25, "mute", TRUE, "rise-time",
               G_GUINT64_CONSTANT(7), nullptr);
  g_autofree gchar *frequency = nullptr;
  gdouble intensity = 0;
  guint64 rise_time = 0;
  g_object_get(synth, "frequency", &frequency, "intensity", &intensity, "rise-time", &rise_time,
               nullptr);
  assert_text(frequency, "33");
  fail_unless_equals_float(intensity, 0.25);
  fail_unless_equals_uint64(rise_time, 7);
  gboolean mute = FALSE;
  g_object_get(bin, "mute", &mute, nullptr);
  fail_unless(mute);
  gst_object_unref(bin);
}

CHECK_TEST(test_sink_is_replaced)
{
  Film film(kHeard, 5, 20, 25);
  hear(film);
  gst_element_set_state(film.pipeline, GST_STATE_NULL);
  g_object_set(film.sink, "audio-sink", gst_element_factory_make("fakesink", "another"), nullptr);
  change_state(film.pipeline, GST_STATE_READY);
  g_autoptr(GstElement) before = gst_bin_get_by_name(GST_BIN(film.sink), "heard");
  g_autoptr(GstElement) after = gst_bin_get_by_name(GST_BIN(film.sink), "another");
  fail_unless(before == nullptr && after != nullptr);
  GstElement *got = nullptr;
  g_object_get(film.sink, "audio-sink", &got, nullptr);
  fail_unless(got == after);
  gst_object_unref(got);
}

CHECK_TEST(test_unusable_sink)
{
  GstElement *bin = gst_element_factory_make("tactoraudiosink", nullptr);
  g_object_set(bin, "audio-sink", gst_element_factory_make("filesrc", "no-sink"), nullptr);
  const ElementBus bus(bin);
  fail_unless_equals_int(gst_element_set_state(bin, GST_STATE_READY), GST_STATE_CHANGE_FAILURE);
  const Said said = bus.said(GST_MESSAGE_ERROR);
  assert_contains(said.text, { "The audio sink cannot be used." });
  assert_contains(said.details, { "no-sink is in another bin or takes no sound" });
  // Another one can, and the usual one.
  g_object_set(bin, "audio-sink", gst_element_factory_make("fakesink", nullptr), nullptr);
  fail_unless_equals_int(gst_element_set_state(bin, GST_STATE_READY), GST_STATE_CHANGE_SUCCESS);
  gst_element_set_state(bin, GST_STATE_NULL);
  g_object_set(bin, "audio-sink", nullptr, nullptr);
  g_autoptr(GstElement) usual = nullptr;
  g_object_get(bin, "audio-sink", &usual, nullptr);
  ck_assert_str_eq(G_OBJECT_TYPE_NAME(usual), "GstAutoAudioSink");
  gst_object_unref(bin);
}

CHECK_TEST(test_latency_of_a_live_source)
{
  // A live source: the picture's sink and this one are delayed by what the lead takes.
  g_autoptr(GstElement) pipeline = make_pipeline(
      "tactiletestsrc is-live=true num-buffers=20 ! video/x-raw,framerate=25/1 ! saliencytactile ! "
      "tactileextractor name=x  x.src ! queue max-size-time=0 ! fakesink name=picture sync=true "
      "x.tactile ! queue ! tactoraudiosink rise-time=100000000 audio-sink=\"fakesink sync=true "
      "name=heard\"");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  g_autoptr(GstElement) picture = gst_bin_get_by_name(GST_BIN(pipeline), "picture");
  g_autoptr(GstElement) heard = gst_bin_get_by_name(GST_BIN(pipeline), "heard");
  for (GstElement *sink : { picture, heard })
    fail_unless(gst_base_sink_get_latency(GST_BASE_SINK(sink)) >= 106 * GST_MSECOND);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}

CHECK_TEST(test_seeks)
{
  // A film is sought while it plays, and paused: the sink prerolls each time and ends.
  g_autoptr(GstElement) pipeline = make_pipeline(
      "tactiletestsrc num-buffers=100 ! video/x-raw,framerate=25/1 ! saliencytactile ! "
      "tactileextractor name=x  x.src ! queue max-size-time=400000000 max-size-bytes=0 "
      "max-size-buffers=0 ! fakesink sync=true "
      "x.tactile ! queue ! tactoraudiosink audio-sink=\"appsink name=heard sync=true\"");
  change_state(pipeline, GST_STATE_PAUSED);
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "heard");
  for (const GstClockTime to : { 2 * GST_SECOND, GST_SECOND, 3 * GST_SECOND }) {
    seek_exactly(pipeline, 1, to, 4 * GST_SECOND);
    change_state(pipeline, GST_STATE_PAUSED);
    // The sound in the sink is that of the film's new time.
    g_autoptr(GstSample) sample = nullptr;
    g_signal_emit_by_name(sink, "pull-preroll", &sample);
    fail_unless(sample != nullptr);
    fail_unless_equals_uint64(
        gst_segment_to_stream_time(gst_sample_get_segment(sample), GST_FORMAT_TIME,
                                   GST_BUFFER_PTS(gst_sample_get_buffer(sample))),
        to);
    change_state(pipeline, GST_STATE_PLAYING);
    change_state(pipeline, GST_STATE_PAUSED);
  }
  // The rest, once: a second and the last ramp.
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstClockTime played = 0;
  GstClockTime next = 0;
  for (;;) {
    g_autoptr(GstSample) sample = nullptr;
    g_signal_emit_by_name(sink, "pull-sample", &sample);
    if (sample == nullptr)
      break;
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), next);
    next = GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer);
    played += GST_BUFFER_DURATION(buffer);
  }
  fail_unless(played >= GST_SECOND && played <= GST_SECOND + 20 * GST_MSECOND, "%" GST_TIME_FORMAT,
              GST_TIME_ARGS(played));
  wait_for_eos(pipeline);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}

CHECK_MAIN(tactoraudiosink)
