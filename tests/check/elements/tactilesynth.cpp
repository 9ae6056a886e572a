// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/calibration.h"

#include "support/contains.h"
#include "support/ones.h"
#include "support/playing.h"
#include "support/spectrum.h"
#include "support/temporary_file.h"
#include "support/tolerance.h"
#include "support/unwrap.h"
#include "tactor/command_trace.h"

#include <gst/audio/audio.h>
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace {

constexpr GstClockTime kFrame = 40 * GST_MSECOND;
constexpr int kRate = 48000;

/// Half of the time in which an amplitude changes.
constexpr GstClockTime kHalfRamp = 6 * GST_MSECOND;

/// No rise time, limits or soft start: what a map has is what sounds.
constexpr const char *kPlain
    = "tactilesynth rise-time=0 max-on-time=0 max-duty=0 max-active=0 ramp-in=0 ";

std::string
map_caps(int rows, int columns)
{
  return "application/x-tactile-map,rows=" + std::to_string(rows)
         + ",columns=" + std::to_string(columns) + ",framerate=25/1";
}

std::string
sound_caps(int channels, const std::string &more = "")
{
  return "audio/x-raw,channels=" + std::to_string(channels) + more;
}

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

void
fail_unless_within(GstClockTime value, GstClockTime expected, GstClockTime tolerance)
{
  fail_unless(value + tolerance >= expected && value <= expected + tolerance,
              "%" GST_TIME_FORMAT ", expected %" GST_TIME_FORMAT, GST_TIME_ARGS(value),
              GST_TIME_ARGS(expected));
}

} // namespace

GST_START_TEST(test_carriers)
{
  Harness synth(kPlain + std::string("frequency=40,100"), 1, 2, sound_caps(2));
  synth.repeat({ 1, 0.5 }, 40);
  synth.end();
  for (std::size_t channel = 0; channel < 2; channel++) {
    std::vector<float> own = channel_of(synth.samples, 2, channel);
    own.erase(own.begin(), own.begin() + kRate / 4);
    own.resize(kRate);
    const std::vector<double> spectrum = spectrum_of(own); // bins of 1 Hz
    fail_unless_near(spectrum[40], channel == 0 ? 1 : 0, 1e-4);
    fail_unless_near(spectrum[100], channel == 0 ? 0 : 0.5, 1e-4);
  }
}
GST_END_TEST;

GST_START_TEST(test_envelope_is_at_the_frame)
{
  const Ones ones;
  for (const int rate : { 8000, 44100, 48000, 192000 }) {
    Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1, ",rate=" + std::to_string(rate)));
    synth.repeat({ 0 }, 10);
    synth.repeat({ 0.8F }, 10);
    synth.repeat({ 0 }, 10);
    synth.repeat({ 0.5F }, 1); // to the end
    synth.end();
    fail_unless_equals_uint64(*synth.first, 0);
    // The sum of samples is the time of the vibration: from half way to half way.
    double sum = 0;
    for (const float sample : synth.samples)
      sum += sample;
    fail_unless_near(sum / rate, 0.8 * 0.4 + 0.5 * 0.04, 1e-4);
    const auto at = [&](double ms) {
      return synth.samples.at(static_cast<std::size_t>(std::lround(ms * rate / 1000)));
    };
    for (const double step : { 400, 800 }) {
      fail_unless_near(at(step - 6), step == 400 ? 0 : 0.8, 1e-3);
      fail_unless_near(at(step), 0.4, 0.05);
      fail_unless_near(at(step + 6), step == 400 ? 0.8 : 0, 1e-3);
    }
    fail_unless_equals_float(synth.samples.back(), 0);
    fail_unless(synth.next >= 1240 * GST_MSECOND + kHalfRamp);
    ck_assert_int_eq(synth.discontinuities, 1);
  }
}
GST_END_TEST;

GST_START_TEST(test_exact_times)
{
  // Frames of a third of a second at 44.1 kHz, an hour after the begin of the stream.
  Harness synth(kPlain, 1, 1, sound_caps(1, ",rate=44100"));
  const GstClockTime hour = 3600 * GST_SECOND;
  for (guint i = 0; i < 300; i++)
    fail_unless_equals_int(synth.push({ 1 }, hour + i * GST_SECOND / 3, GST_SECOND / 3),
                           GST_FLOW_OK);
  synth.end();
  fail_unless_equals_uint64(*synth.first, hour - kHalfRamp);
  // take() has seen no hole, and the last sample is where the number of samples says.
  const GstClockTime length = gst_util_uint64_scale(synth.samples.size(), GST_SECOND, 44100);
  fail_unless_equals_uint64(synth.next, *synth.first + length);
  fail_unless_within(synth.next, hour + 100 * GST_SECOND + 2 * kHalfRamp, GST_MSECOND);
}
GST_END_TEST;

GST_START_TEST(test_no_clicks)
{
  Harness synth(kPlain, 1, 1, sound_caps(1));
  for (int i = 0; i < 12; i++)
    synth.repeat({ i % 2 == 0 ? 1.0F : 0.0F }, 1);
  synth.end();
  synth.samples.resize(kRate / 2);
  fail_unless_at_most(strongest_outside(synth.samples, kRate, -1, 260), -60);
  fail_unless(spectrum_of(synth.samples)[30] > 0.3); // bins of 2 Hz
}
GST_END_TEST;

GST_START_TEST(test_rise_time)
{
  const Ones ones;
  Harness synth("tactilesynth rise-time=100000000 ramp-in=0 " + ones.properties(), 1, 1,
                sound_caps(1));
  synth.repeat({ 0 }, 10);
  synth.repeat({ 0.8F }, 10);
  synth.end();
  fail_unless_within(synth.reaches(0.4F, 0), 300 * GST_MSECOND, GST_MSECOND);
  fail_unless_within(synth.reaches(0.4F, 400 * GST_MSECOND, true), 800 * GST_MSECOND, GST_MSECOND);
}
GST_END_TEST;

GST_START_TEST(test_latency)
{
  for (const bool live : { false, true }) {
    Harness synth("tactilesynth rise-time=50000000", 1, 1, sound_caps(1));
    gst_harness_set_upstream_latency(synth.h, 20 * GST_MSECOND);
    gst_harness_set_live(synth.h, live);
    fail_unless_equals_uint64(gst_harness_query_latency(synth.h),
                              live ? 70 * GST_MSECOND + kHalfRamp : 0);
    GstQuery *query = gst_query_new_latency();
    fail_unless(gst_pad_peer_query(synth.h->sinkpad, query));
    gboolean is_live = !live;
    GstClockTime least = 0;
    gst_query_parse_latency(query, &is_live, &least, nullptr);
    gst_query_unref(query);
    ck_assert_int_eq(is_live, live);
    if (live)
      fail_unless_equals_uint64(least, 70 * GST_MSECOND + kHalfRamp);
    // It keeps what it answers: a map makes known what is up to so much before its end.
    synth.repeat({ 1 }, 10);
    fail_unless_within(synth.next, 400 * GST_MSECOND - 50 * GST_MSECOND - kHalfRamp, GST_MSECOND);
  }
}
GST_END_TEST;

GST_START_TEST(test_channels)
{
  const Ones ones;
  // As many as there are cells, where downstream leaves it open.
  for (const int columns : { 1, 2, 3, 9, 33, 64 }) {
    const auto channels = static_cast<std::size_t>(columns);
    Harness synth(kPlain + ones.properties(), 1, columns, "audio/x-raw");
    std::vector<float> levels;
    for (std::size_t i = 0; i < channels; i++)
      levels.push_back(static_cast<float>(i + 1) / 64);
    synth.repeat(levels, 5);
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(synth.h->sinkpad);
    GstAudioInfo info;
    fail_unless(gst_audio_info_from_caps(&info, caps));
    ck_assert_int_eq(GST_AUDIO_INFO_CHANNELS(&info), columns);
    ck_assert_int_eq(GST_AUDIO_INFO_RATE(&info), kRate);
    fail_unless_equals_int(GST_AUDIO_INFO_IS_UNPOSITIONED(&info), columns > 2);
    fail_unless(!synth.said(GST_MESSAGE_INFO));
    for (std::size_t i = 0; i < channels; i++)
      fail_unless_near(synth.at(100 * GST_MSECOND, channels, i), levels[i], 1e-6);
  }
  // More than 64 cells share channels.
  Harness synth(kPlain + ones.properties(), 2, 64, "audio/x-raw");
  std::vector<float> levels(128, 0);
  levels[64 + 5] = 1;
  synth.repeat(levels, 5);
  for (std::size_t i = 0; i < 64; i++)
    fail_unless_near(synth.at(100 * GST_MSECOND, 64, i), i == 5 ? 1 : 0, 1e-6);
}
GST_END_TEST;

/// What channels play of a map of 3 × 3 whose cell i has the level (i + 1) / 10, in tenths.
static std::string
tenths(Harness &synth, std::size_t channels)
{
  std::vector<float> levels;
  for (int i = 0; i < 9; i++)
    levels.push_back(static_cast<float>(i + 1) / 10);
  synth.repeat(levels, 5);
  std::string text;
  for (std::size_t i = 0; i < channels; i++)
    text += std::to_string(std::lround(synth.at(100 * GST_MSECOND, channels, i) * 10)) + " ";
  return text;
}

GST_START_TEST(test_positions)
{
  const Ones ones;
  const struct
  {
    int channels;
    const char *mask;
    const char *expected;
  } cards[] = {
    { 1, "", "9 " },
    { 2, "", "8 9 " },                                         // left and right
    { 2, ",channel-mask=(bitmask)0x3", "8 9 " },               // the same
    { 3, ",channel-mask=(bitmask)0xb", "0 0 9 " },             // 2.1: LFE
    { 4, ",channel-mask=(bitmask)0x33", "0 0 8 9 " },          // DualSense: back left and right
    { 6, ",channel-mask=(bitmask)0x3f", "0 0 0 9 8 9 " },      // 5.1: LFE, back left and right
    { 8, ",channel-mask=(bitmask)0xc3f", "0 0 0 9 8 9 7 9 " }, // 7.1
    { 4, ",channel-mask=(bitmask)0x0", "7 8 9 9 " },
    { 12, "", "1 2 3 4 5 6 7 8 9 0 0 0 " },
  };
  for (const auto &card : cards) {
    Harness synth(kPlain + ones.properties(), 3, 3, sound_caps(card.channels, card.mask));
    assert_text(tenths(synth, static_cast<std::size_t>(card.channels)), card.expected);
    const std::optional<Said> said = synth.said(GST_MESSAGE_INFO);
    fail_unless(said.has_value());
    assert_text(said->text,
                card.channels == 1
                    ? "3 x 3 cells are felt on 1 channel."
                    : "3 x 3 cells are felt on " + std::to_string(card.channels) + " channels.");
    fail_unless(!synth.said(GST_MESSAGE_INFO)); // once
  }
}
GST_END_TEST;

GST_START_TEST(test_mapping)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties() + "mapping=1,-1,0,1,1,1,3,-1,-1", 3, 3, "audio/x-raw");
  assert_text(tenths(synth, 4), "3 6 0 7 ");
  fail_unless(!synth.said(GST_MESSAGE_WARNING));
  // One that does not fit is told, and not used.
  for (const char *mapping : { "1,0", "0,1,2,3,4,5,6,7,8" }) {
    Harness wrong(kPlain + ones.properties() + "mapping=" + mapping, 3, 3, sound_caps(2));
    assert_text(tenths(wrong, 2), "8 9 ");
    const std::optional<Said> said = wrong.said(GST_MESSAGE_WARNING);
    fail_unless(said.has_value());
    assert_contains(said->text, { "The mapping does not fit" });
    assert_contains(said->details, { "channel 0: 0,1,3,4,6,7; channel 1: 1,2,4,5,7,8" });
  }
}
GST_END_TEST;

GST_START_TEST(test_other_formats_are_refused)
{
  for (const char *caps : { "audio/x-raw,format=S16LE", "audio/x-raw,rate=4000",
                            "audio/x-raw,channels=65", "audio/x-raw,layout=non-interleaved" }) {
    Harness synth(kPlain, 1, 1, caps);
    fail_unless_equals_int(synth.push({ 1 }, 0), GST_FLOW_NOT_NEGOTIATED);
  }
}
GST_END_TEST;

GST_START_TEST(test_caps_change)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 10);
  // The grid: the film goes on.
  gst_harness_set_src_caps_str(synth.h, map_caps(1, 2).c_str());
  synth.repeat({ 0, 0.5F }, 10);
  fail_unless_near(synth.at(500 * GST_MSECOND), 0.5, 1e-6);
  ck_assert_int_eq(synth.discontinuities, 1);
  // The sound: twice the rate and channels, from where it was.
  const GstClockTime changed = synth.next;
  synth.samples.clear();
  synth.first.reset();
  gst_harness_set_sink_caps_str(synth.h, sound_caps(2, ",rate=96000").c_str());
  synth.repeat({ 0, 0.5F }, 10);
  fail_unless_within(*synth.first, changed, 100 * GST_USECOND);
  fail_unless_equals_uint64(synth.next - *synth.first,
                            gst_util_uint64_scale(synth.samples.size() / 2, GST_SECOND, 96000));
  fail_unless_near(synth.samples.back(), 0.5, 1e-6);
  fail_unless_near(synth.samples[synth.samples.size() - 2], 0.0, 1e-6);
}
GST_END_TEST;

GST_START_TEST(test_gaps)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.push(gst_event_new_gap(0, 200 * GST_MSECOND));
  fail_unless_equals_uint64(*synth.first, 0); // a sink prerolls
  synth.time = 200 * GST_MSECOND;
  synth.repeat({ 1 }, 5); // to 400 ms
  synth.push(gst_event_new_gap(synth.time, 200 * GST_MSECOND));
  synth.time += 200 * GST_MSECOND;
  synth.repeat({ 1 }, 5);          // 600 to 800 ms
  synth.time += 400 * GST_MSECOND; // no map, no gap: it holds
  synth.repeat({ 0.5F }, 5);       // 1200 to 1400 ms
  synth.time += 2 * GST_SECOND;    // too long
  synth.repeat({ 1 }, 5);          // from 3400 ms
  GstBuffer *silent = gst_buffer_new();
  GST_BUFFER_FLAG_SET(silent, GST_BUFFER_FLAG_GAP);
  GST_BUFFER_PTS(silent) = synth.time;
  GST_BUFFER_DURATION(silent) = kFrame;
  fail_unless_equals_int(gst_harness_push(synth.h, silent), GST_FLOW_OK);
  synth.end();
  const GstClockTime ms = GST_MSECOND;
  const std::pair<GstClockTime, GstClockTime> on[]
      = { { 200, 400 }, { 600, 1400 }, { 3400, 3600 } };
  for (const auto &[begin, end] : on) {
    fail_unless_within(synth.reaches(0.4F, (begin - 100) * ms), begin * ms, ms);
    fail_unless_within(synth.reaches(0.3F, begin * ms + 10 * ms, true), end * ms, 2 * ms);
  }
  fail_unless_near(synth.at(1100 * ms), 1, 1e-6);
  fail_unless_equals_float(synth.samples.back(), 0);
  ck_assert_int_eq(synth.discontinuities, 1);
}
GST_END_TEST;

GST_START_TEST(test_long_silence_is_a_gap)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 5);
  const std::size_t before = synth.samples.size();
  // Ten hours, and then thirty years, as a broken file may have.
  for (const GstClockTime later : { 36000 * GST_SECOND, 1000000000 * GST_SECOND }) {
    fail_unless_equals_int(synth.push({ 1 }, later), GST_FLOW_OK);
    fail_unless(synth.samples.size() < before + 2 * kRate);
    GstClockTime begin = 0;
    GstClockTime duration = 0;
    GstEvent *gap = synth.last_event(GST_EVENT_GAP);
    gst_event_parse_gap(gap, &begin, &duration);
    gst_event_unref(gap);
    fail_unless_within(begin + duration, later - kHalfRamp, GST_MSECOND);
    fail_unless(synth.next + kHalfRamp >= later);
  }
  ck_assert_int_eq(synth.discontinuities, 3);
  synth.push({ 1 }, 1000000000 * GST_SECOND + kFrame);
  fail_unless_near(synth.samples.back(), 1, 1e-6);
}
GST_END_TEST;

GST_START_TEST(test_flush)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 10);
  synth.seek(1, 10 * GST_SECOND, 20 * GST_SECOND);
  fail_unless_equals_int(synth.push({ 0 }, 10 * GST_SECOND), GST_FLOW_OK);
  fail_unless_equals_uint64(*synth.first, 0);
  for (const float sample : synth.samples)
    fail_unless_equals_float(sample, 0); // nothing of before
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND + 40 * GST_MSECOND), GST_FLOW_OK);
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND + 80 * GST_MSECOND), GST_FLOW_OK);
  fail_unless_within(synth.reaches(0.5F, 0), 40 * GST_MSECOND, GST_MSECOND);
  ck_assert_int_eq(synth.discontinuities, 2);
  const GstSegment *segment = nullptr;
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
  gst_event_parse_segment(event, &segment);
  fail_unless_equals_uint64(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, GST_SECOND),
                            11 * GST_SECOND);
}
GST_END_TEST;

GST_START_TEST(test_rates)
{
  const Ones ones;
  for (const double rate : { 2.0, 0.5, -1.0, -2.0 }) {
    Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
    const GstClockTime stop = 12 * GST_SECOND;
    synth.seek(rate, 10 * GST_SECOND, stop);
    // In running time, the film's second half second vibrates.
    for (guint i = 0; i < 50; i++) {
      const GstClockTime pts = rate > 0 ? 10 * GST_SECOND + i * kFrame : stop - (i + 1) * kFrame;
      const bool on = i >= 25;
      fail_unless_equals_int(synth.push({ on ? 1.0F : 0.0F }, pts), GST_FLOW_OK);
    }
    const auto at = static_cast<GstClockTime>(GST_SECOND / std::abs(rate));
    fail_unless_within(synth.reaches(0.5F, 0), at, GST_MSECOND);
    // What a position query at an audio sink makes of a running time of 100 ms.
    const GstSegment *segment = nullptr;
    g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
    gst_event_parse_segment(event, &segment);
    fail_unless_equals_float(segment->rate, 1);
    const auto moved = static_cast<GstClockTime>(std::abs(rate) * 100 * GST_MSECOND);
    fail_unless_within(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, 100 * GST_MSECOND),
                       rate > 0 ? 10 * GST_SECOND + moved : stop - moved,
                       rate > 0 ? 0 : 30 * GST_MSECOND);
  }
}
GST_END_TEST;

GST_START_TEST(test_segment_without_flush)
{
  // The second file of a playlist: running time goes on.
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 25);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.base = GST_SECOND;
  synth.push(gst_event_new_segment(&segment));
  for (guint i = 0; i < 25; i++)
    fail_unless_equals_int(synth.push({ i < 5 ? 0.0F : 1.0F }, i * kFrame), GST_FLOW_OK);
  synth.end();
  fail_unless_within(synth.reaches(0.5F, 500 * GST_MSECOND, true), GST_SECOND, GST_MSECOND);
  fail_unless_within(synth.reaches(0.5F, 1100 * GST_MSECOND), 1200 * GST_MSECOND, GST_MSECOND);
  ck_assert_int_eq(synth.discontinuities, 1);
  const GstSegment *sent = nullptr;
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
  gst_event_parse_segment(event, &sent);
  fail_unless_within(gst_segment_to_stream_time(sent, GST_FORMAT_TIME, 1500 * GST_MSECOND),
                     500 * GST_MSECOND, 10 * GST_MSECOND);
}
GST_END_TEST;

GST_START_TEST(test_clipped_by_the_segment)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.seek(1, 10 * GST_SECOND, 11 * GST_SECOND);
  fail_unless_equals_int(synth.push({ 1 }, 9 * GST_SECOND), GST_FLOW_OK);
  fail_unless(synth.samples.empty());
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND), GST_FLOW_OK);
  const std::size_t there = synth.samples.size();
  fail_unless(there > 0);
  fail_unless_equals_int(synth.push({ 1 }, 11 * GST_SECOND), GST_FLOW_OK);
  ck_assert_int_eq(synth.samples.size(), there);
}
GST_END_TEST;

GST_START_TEST(test_mute_and_intensity)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 0.8F }, 10);
  gst_harness_set(synth.h, "tactilesynth", "intensity", 0.5, nullptr);
  synth.repeat({ 0.8F }, 10);
  gst_harness_set(synth.h, "tactilesynth", "mute", TRUE, nullptr);
  synth.repeat({ 0.8F }, 10);
  gst_harness_set(synth.h, "tactilesynth", "mute", FALSE, nullptr);
  synth.repeat({ 0.8F }, 10);
  const double expected[] = { 0.8, 0.4, 0, 0.4 };
  for (guint i = 0; i < 4; i++)
    fail_unless_near(synth.at((i * 400 + 300) * GST_MSECOND), expected[i], 1e-6);
}
GST_END_TEST;

GST_START_TEST(test_limits)
{
  const Ones ones;
  Harness synth("tactilesynth rise-time=0 max-on-time=500000000 max-active=1 " + ones.properties(),
                1, 2, "audio/x-raw,channels=2");
  synth.repeat({ 1, 0.5F }, 25);
  fail_unless_near(synth.at(50 * GST_MSECOND, 2, 0), 0.5, 0.05); // a soft start of 100 ms
  fail_unless_near(synth.at(400 * GST_MSECOND, 2, 0), 1, 1e-6);
  fail_unless_near(synth.at(400 * GST_MSECOND, 2, 1), 0, 1e-6);
  fail_unless_near(synth.at(550 * GST_MSECOND, 2, 0), 0, 1e-6);
}
GST_END_TEST;

GST_START_TEST(test_calibration)
{
  // Channel 1 vibrates twice as much at the same volts, so that it gets half as many. Channel 0
  // takes 80 ms and 20 ms on the way, channel 1 40 ms, and channel 2 was not measured.
  const Ones ones;
  tactor::Calibration calibration;
  calibration.perception_exponent = 1;
  const auto tactor = [](double strength, double rise) {
    tactor::TactorCalibration made;
    made.start_volts = made.hold_volts = 0.1;
    made.vibration = { { 1.5, strength / 2 }, { 3, strength } };
    made.table
        = tactor::RiseTimeTable{ .step_volts = 3, .size = 2, .milliseconds = { 0, rise, 0, 0 } };
    return made;
  };
  calibration.tactors[0] = tactor(1, 80);
  calibration.tactors[0].table->milliseconds = { 80, 80, 80, 80 };
  calibration.tactors[0].latency = std::chrono::milliseconds(20);
  calibration.tactors[1] = tactor(2, 40);
  calibration.tactors[1].table->milliseconds = { 40, 40, 40, 40 };
  const TemporaryFile file;
  unwrap(tactor::write_calibration(calibration, file.path));
  Harness synth("tactilesynth rise-time=10000000 ramp-in=0 calibration=" + file.path + " "
                    + ones.properties(),
                1, 3, "audio/x-raw");
  synth.repeat({ 0, 0, 0 }, 10);
  synth.repeat({ 1, 1, 1 }, 10);
  synth.repeat({ 0, 0, 0 }, 10);
  const double amplitude[] = { 1, 0.5, 1 };
  const GstClockTime begins[] = { 300, 360, 390 };
  for (std::size_t channel = 0; channel < 3; channel++) {
    fail_unless_near(synth.at(600 * GST_MSECOND, 3, channel), amplitude[channel], 1e-3);
    GstClockTime when = 0;
    while (synth.at(when, 3, channel) < amplitude[channel] / 2)
      when += 100 * GST_USECOND;
    fail_unless_within(when, begins[channel] * GST_MSECOND, GST_MSECOND);
  }
}
GST_END_TEST;

/// The error of an element that does not reach PAUSED.
static std::string
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

/// The trace has the same changes at the same times as the sound, and what they are early for.
GST_START_TEST(test_trace)
{
  const TemporaryFile file;
  const Ones ones;
  {
    Harness synth("tactilesynth rise-time=50000000 max-on-time=0 max-duty=0 ramp-in=0 "
                  "trace-location="
                      + file.path + " " + ones.properties(),
                  1, 2, sound_caps(2));
    synth.repeat({ 0, 0 }, 10);
    synth.repeat({ 0, 0.5 }, 10);
    synth.repeat({ 0, 0 }, 10);
    synth.end();
  }
  using std::chrono::milliseconds;
  const std::vector<tactor::IssuedCommand> trace = unwrap(tactor::read_command_trace(file.path));
  ck_assert_uint_eq(trace.size(), 2);
  const tactor::Command expected[] = {
    { .effect = milliseconds(400), .lead = milliseconds(50), .tactor = 1, .volts = 1.5 },
    { .effect = milliseconds(800), .lead = milliseconds(0), .tactor = 1, .volts = 0 },
  };
  for (std::size_t i = 0; i < 2; i++) {
    const tactor::Command &command = trace[i].command;
    fail_unless(command.effect == expected[i].effect && command.lead == expected[i].lead);
    fail_unless(trace[i].issued == expected[i].effect - expected[i].lead);
    ck_assert_int_eq(command.tactor, expected[i].tactor);
    fail_unless_near(command.volts, expected[i].volts, 1e-3);
  }
}
GST_END_TEST;

GST_START_TEST(test_wrong_settings)
{
  assert_contains(refusal("tactilesynth frequency=0.5"),
                  { "frequency cannot be read: entry 1 is '0.5'; expected 1 to 1000" });
  // Another that is right does not hide it.
  assert_contains(refusal("tactilesynth gain=2 frequency=60"), { "gain cannot be read", "0 to 1" });
  assert_contains(refusal("tactilesynth waveform=sine,saw"), { "entry 2 is 'saw'", "triangle" });
  assert_contains(refusal("tactilesynth mapping=64"), { "mapping cannot be read", "0 to 63" });
  assert_contains(refusal("tactilesynth waveform=sample"), { "cannot read the loop ''" });
  assert_contains(refusal("tactilesynth waveform=sample sample=/dev/null"),
                  { "'/dev/null': expected a RIFF WAVE file" });
  assert_contains(refusal("tactilesynth calibration=/nonexistent"), { "/nonexistent" });
  // Set right afterwards, it starts.
  GstElement *element = make_pipeline("tactilesynth frequency=x");
  g_object_set(element, "frequency", "50,60.5", nullptr);
  g_autofree gchar *frequency = nullptr;
  g_object_get(element, "frequency", &frequency, nullptr);
  assert_text(frequency, "50,60.5");
  fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED),
                         GST_STATE_CHANGE_SUCCESS);
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
}
GST_END_TEST;

GST_START_TEST(test_wrong_map)
{
  Harness synth(kPlain, 2, 2, sound_caps(2));
  fail_unless_equals_int(synth.push({ 1, 1, 1 }, 0), GST_FLOW_ERROR);
  const std::optional<Said> said = synth.said(GST_MESSAGE_ERROR);
  fail_unless(said.has_value());
  assert_contains(said->details, { "expected 2 x 2 float32 levels, got 12 bytes" });
}
GST_END_TEST;

GST_START_TEST(test_nothing_before_the_end)
{
  Harness synth(kPlain, 1, 1, sound_caps(1));
  synth.end();
  fail_unless(synth.samples.empty());
  g_autoptr(GstEvent) event = synth.last_event(GST_EVENT_EOS);
  fail_unless(event != nullptr);
}
GST_END_TEST;

static Suite *
tactilesynth_suite(void)
{
  Suite *suite = suite_create("tactilesynth");
  TCase *tcase = tcase_create("general");

  suite_add_tcase(suite, tcase);
  tcase_add_test(tcase, test_carriers);
  tcase_add_test(tcase, test_envelope_is_at_the_frame);
  tcase_add_test(tcase, test_exact_times);
  tcase_add_test(tcase, test_no_clicks);
  tcase_add_test(tcase, test_rise_time);
  tcase_add_test(tcase, test_latency);
  tcase_add_test(tcase, test_channels);
  tcase_add_test(tcase, test_positions);
  tcase_add_test(tcase, test_mapping);
  tcase_add_test(tcase, test_other_formats_are_refused);
  tcase_add_test(tcase, test_caps_change);
  tcase_add_test(tcase, test_gaps);
  tcase_add_test(tcase, test_long_silence_is_a_gap);
  tcase_add_test(tcase, test_flush);
  tcase_add_test(tcase, test_rates);
  tcase_add_test(tcase, test_segment_without_flush);
  tcase_add_test(tcase, test_clipped_by_the_segment);
  tcase_add_test(tcase, test_mute_and_intensity);
  tcase_add_test(tcase, test_limits);
  tcase_add_test(tcase, test_calibration);
  tcase_add_test(tcase, test_trace);
  tcase_add_test(tcase, test_wrong_settings);
  tcase_add_test(tcase, test_wrong_map);
  tcase_add_test(tcase, test_nothing_before_the_end);
  return suite;
}

GST_CHECK_MAIN(tactilesynth);
