// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "support/synth_harness.h"

#include "support/contains.h"
#include "support/spectrum.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"
#include "tactor/command_trace.h"

#include "support/check_tests.h"

CHECK_TEST(test_carriers)
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

CHECK_TEST(test_envelope_is_at_the_frame)
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

CHECK_TEST(test_exact_times)
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

CHECK_TEST(test_no_clicks)
{
  Harness synth(kPlain, 1, 1, sound_caps(1));
  for (int i = 0; i < 12; i++)
    synth.repeat({ i % 2 == 0 ? 1.0F : 0.0F }, 1);
  synth.end();
  synth.samples.resize(kRate / 2);
  fail_unless_at_most(strongest_outside(synth.samples, kRate, -1, 260), -60);
  fail_unless(spectrum_of(synth.samples)[30] > 0.3); // bins of 2 Hz
}

CHECK_TEST(test_rise_time)
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

CHECK_TEST(test_latency)
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

CHECK_TEST(test_mute_and_intensity)
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

/// In the middle of a long map, too.
CHECK_LOOP_TEST(test_mute_acts_at_once, 0, 2)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  g_autoptr(GstElement) element = gst_harness_find_element(synth.h, "tactilesynth");
  g_object_set_data(G_OBJECT(element), "muted", GINT_TO_POINTER(__i__));
  gst_pad_add_probe(
      GST_PAD_PEER(synth.h->sinkpad), GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad *, GstPadProbeInfo *info, gpointer data) {
        if (GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info)) < GST_SECOND)
          return GST_PAD_PROBE_OK;
        if (g_object_get_data(G_OBJECT(data), "muted"))
          g_object_set(data, "mute", TRUE, nullptr);
        else
          g_object_set(data, "intensity", 0.0, nullptr);
        return GST_PAD_PROBE_OK;
      },
      element, nullptr);
  fail_unless_equals_int(synth.push({ 0.8F }, 0, 2 * GST_SECOND), GST_FLOW_OK);
  synth.end();
  fail_unless_near(synth.at(990 * GST_MSECOND), 0.8, 1e-6);
  fail_unless_near(synth.at(1060 * GST_MSECOND), 0, 1e-6); // a buffer and a ramp later
}

CHECK_TEST(test_limits)
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

/// The trace has the same changes at the same times as the sound, and what they are early for.
CHECK_TEST(test_trace)
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

CHECK_TEST(test_wrong_settings)
{
  assert_contains(refusal("tactilesynth frequency=0.5"),
                  { "frequency cannot be read: entry 1 is '0.5'; expected 1 to 1000" });
  // Another that is right does not hide it.
  assert_contains(refusal("tactilesynth gain=2 frequency=60"), { "gain cannot be read", "0 to 1" });
  assert_contains(refusal("tactilesynth waveform=sine,saw"), { "entry 2 is 'saw'", "triangle" });
  assert_contains(refusal("tactilesynth mapping=64"), { "mapping cannot be read", "0 to 63" });
  assert_contains(refusal("tactilesynth waveform=sample"), { "cannot read the loop ''" });
  assert_contains(refusal("tactilesynth waveform=sample sample=/dev/null"),
                  { "'/dev/null': expected a regular file, got a device" });
  // The file of the channel that plays one.
  assert_contains(refusal("tactilesynth waveform=sine,sample sample=,/nonexistent.wav"),
                  { "cannot read the loop '/nonexistent.wav': No such file" });
  assert_contains(refusal("tactilesynth sample=" + std::string(5000, ',')),
                  { "sample cannot be read: entry 4097" });
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

CHECK_TEST(test_wrong_map)
{
  Harness synth(kPlain, 2, 2, sound_caps(2));
  fail_unless_equals_int(synth.push({ 1, 1, 1 }, 0), GST_FLOW_ERROR);
  const std::optional<Said> said = synth.said(GST_MESSAGE_ERROR);
  fail_unless(said.has_value());
  assert_contains(said->details, { "expected 2 x 2 float32 levels, got 12 bytes" });
}

CHECK_TEST(test_nothing_before_the_end)
{
  Harness synth(kPlain, 1, 1, sound_caps(1));
  synth.end();
  fail_unless(synth.samples.empty());
  g_autoptr(GstEvent) event = synth.last_event(GST_EVENT_EOS);
  fail_unless(event != nullptr);
}

CHECK_MAIN(tactilesynth)
