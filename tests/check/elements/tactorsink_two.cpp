// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Two devices that play one stream.
#include "support/two_devices.h"

#include "support/ones.h"

#include <gst/audio/audio.h>

#include <cmath>

#include "support/check_tests.h"

/// Two chairs with different motors.
CHECK_TEST(test_two_chairs)
{
  TwoDevices devices("driver=simulator", "driver=simulator");
  devices.expect_one_film();
}

namespace {

constexpr int kRate = 48000;
constexpr double kShakerRiseMs = 60;

/// What a sound card plays: each frame of two samples, and no buffer before its time.
class Card
{
public:
  explicit Card(GstElement *pipeline)
  {
    g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "card");
    g_signal_connect(sink, "new-sample", G_CALLBACK(take), this);
  }

  /// The running times at which a channel crosses half of full scale.
  std::vector<std::chrono::nanoseconds> changes(std::size_t channel) const
  {
    std::vector<std::chrono::nanoseconds> all;
    for (std::size_t i = 2 + channel; i < samples.size(); i += 2)
      if ((samples[i] > 0.5F) != (samples[i - 2] > 0.5F))
        all.emplace_back(first.count() + static_cast<gint64>(i / 2) * GST_SECOND / kRate);
    return all;
  }

  std::chrono::nanoseconds first{ -1 };
  std::vector<float> samples;

private:
  static GstFlowReturn take(GstElement *sink, Card *card)
  {
    g_autoptr(GstClock) clock = gst_element_get_clock(sink);
    const GstClockTime now = gst_clock_get_time(clock) - gst_element_get_base_time(sink);
    GstSample *sample = nullptr;
    g_signal_emit_by_name(sink, "pull-sample", &sample);
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    const GstClockTime time = gst_segment_to_running_time(gst_sample_get_segment(sample),
                                                          GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    fail_unless(now >= time + gst_base_sink_get_latency(GST_BASE_SINK(sink)));
    if (card->first.count() < 0)
      card->first = std::chrono::nanoseconds(time);
    // Without a hole.
    fail_unless_equals_uint64(gst_util_uint64_scale_round(time, kRate, GST_SECOND)
                                  - gst_util_uint64_scale_round(
                                      static_cast<guint64>(card->first.count()), kRate, GST_SECOND),
                              card->samples.size() / 2);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_READ);
    const auto *values = reinterpret_cast<const float *>(map.data);
    card->samples.insert(card->samples.end(), values, values + map.size / sizeof(float));
    gst_buffer_unmap(buffer, &map);
    gst_sample_unref(sample);
    return GST_FLOW_OK;
  }
};

} // namespace

/// A chair and a shaker at a sound card, each early by its own rise time.
CHECK_TEST(test_chair_and_shaker)
{
  const TemporaryFile trace;
  const Ones ones;
  g_autoptr(GstElement) pipeline = make_pipeline(
      two_devices::kSource
      + ("t. ! queue ! tactorsink name=chair driver=simulator rate=0 ramp-in=0 max-duty=0 "
         "trace-location="
         + trace.path)
      + " t. ! queue ! tactoraudiosink ramp-in=0 max-duty=0 rise-time="
      + std::to_string(std::llround(kShakerRiseMs * 1e6)) + " " + ones.properties()
      + "audio-sink=\"appsink name=card emit-signals=true sync=true "
        "caps=audio/x-raw,format=F32LE,rate=48000\"");
  g_autoptr(GstClock) clock = gst_test_clock_new();
  gst_pipeline_use_clock(GST_PIPELINE(pipeline), clock);
  change_state(pipeline, GST_STATE_READY); // from then on the card is in the bin
  Card card(pipeline);
  two_devices::push_film(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  two_devices::run_out(pipeline, GST_TEST_CLOCK(clock));
  ck_assert_uint_eq(two_devices::latency(pipeline, "chair"),
                    two_devices::latency(pipeline, "card"));
  gst_element_set_state(pipeline, GST_STATE_NULL);

  two_devices::expect_steps(trace.path, two_devices::kPaperRiseMs);
  for (const int channel : { 0, 1 }) {
    const std::vector<std::chrono::nanoseconds> changes
        = card.changes(static_cast<std::size_t>(channel));
    std::size_t i = 0;
    for (const two_devices::Step &step : two_devices::kSteps) {
      if (step.tactor != channel)
        continue;
      fail_unless(i < changes.size(), "channel %d does not change at map %d", channel, step.map);
      const double early_ms
          = std::chrono::duration<double, std::milli>(step.effect() - changes[i++]).count();
      // Known to a sample.
      fail_unless_near(early_ms, step.volts > 0 ? kShakerRiseMs : 0, 1000.0 / kRate);
    }
    ck_assert_uint_eq(i, changes.size());
  }
}

CHECK_MAIN(tactorsink_two)
