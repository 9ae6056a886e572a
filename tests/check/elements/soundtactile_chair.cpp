// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What chairs get of soundtactile: from its pad, or by the meeting place of their pipeline.
#include "gst/fusion/pipeline_sound.h"
#include "sound/synthetic_sound.h"

#include "support/check_tests.h"
#include <gst/check/gstharness.h>

#include <glib/gstdio.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "support/playing.h"

// A chair gets each impact at its time and place, and is at zero in the end.
CHECK_TEST(test_chair)
{
  gchar *folder = g_dir_make_tmp("soundtactile-XXXXXX", nullptr);
  const std::string trace = std::string(folder) + "/commands.csv";
  const std::string launch
      = "tactilesoundtestsrc num-buffers=200 ! soundtactile name=s s.src ! queue ! fakesink "
        "s.tactile ! queue ! tactorsink driver=simulator sync=false trace-location="
        + trace;
  GstElement *pipeline = gst_parse_launch(launch.c_str(), nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus *bus = gst_element_get_bus(pipeline);
  GstMessage *message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS);
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);

  const sound::SoundEvent impact = sound::SyntheticSound({}).events().front();
  std::ifstream file(trace);
  std::string line;
  std::getline(file, line);
  std::array<double, 9> volts{};
  bool is_first = true;
  while (std::getline(file, line)) {
    long long issued = 0;
    long long due = 0;
    long long effect = 0;
    unsigned tactor = 0;
    double level = 0;
    fail_unless(
        std::sscanf(line.c_str(), "%lld,%lld,%lld,%u,%lf", &issued, &due, &effect, &tactor, &level)
        == 5);
    fail_unless(tactor < volts.size());
    volts[tactor] = level;
    if (!is_first)
      continue;
    is_first = false;
    fail_unless(std::abs(effect - impact.begin.count()) <= 20'000'000);
    fail_unless(tactor % 3 == static_cast<unsigned>(impact.across + 1));
  }
  fail_if(is_first);
  for (const double level : volts)
    fail_unless(level == 0);
  g_remove(trace.c_str());
  g_rmdir(folder);
  g_free(folder);
}

// Of two in one pipeline none speaks for the other: one is silent, the other has its impacts.
CHECK_TEST(test_two_sounds)
{
  GstElement *pipeline = make_pipeline(
      "tactilesoundtestsrc num-buffers=150 ! soundtactile ! fakesink "
      "tactilesoundtestsrc num-buffers=150 impacts=false ! soundtactile name=silent ! fakesink");
  const auto maps = sound_maps_of(pipeline);
  const int reader = 0;
  maps->want(&reader, fusion::find_profile("film"));
  change_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  const sound::SoundEvent impact = sound::SyntheticSound({}).events().front();
  const auto is_felt = [&] {
    const auto at = std::chrono::milliseconds(20);
    return !maps->between(impact.begin - at, impact.begin + at).empty();
  };
  fail_unless(is_felt());
  g_autoptr(GstElement) silent = gst_bin_get_by_name(GST_BIN(pipeline), "silent");
  gst_element_set_locked_state(silent, TRUE);
  change_state(silent, GST_STATE_NULL);
  fail_unless(maps->is_heard() && is_felt());
  change_state(pipeline, GST_STATE_NULL);
  fail_if(maps->is_heard());
  gst_object_unref(pipeline);
}

// A pad that is linked while the film plays has the maps from then on.
CHECK_TEST(test_linked_while_it_plays)
{
  constexpr gsize kBlock = 480;
  GstHarness *audio = gst_harness_new_with_padnames("soundtactile", "sink", "src");
  gst_harness_set_src_caps_str(audio, "audio/x-raw,format=F32LE,layout=interleaved,rate=48000,"
                                      "channels=1");
  const auto push = [&](guint number) {
    const std::vector<float> samples(kBlock);
    GstBuffer *buffer = gst_buffer_new_memdup(samples.data(), samples.size() * sizeof(float));
    GST_BUFFER_PTS(buffer) = number * 10 * GST_MSECOND;
    GST_BUFFER_DURATION(buffer) = 10 * GST_MSECOND;
    fail_unless_equals_int(gst_harness_push(audio, buffer), GST_FLOW_OK);
  };
  const auto maps = sound_maps_of(audio->element);
  push(0);
  fail_unless(maps->is_heard());
  GstHarness *tactile = gst_harness_new_with_element(audio->element, nullptr, "tactile");
  for (guint i = 1; i < 10; i++)
    push(i);
  fail_if(maps->is_heard());
  fail_unless(gst_harness_buffers_received(tactile) > 0);
  gst_harness_teardown(tactile);
  push(10);
  fail_unless(maps->is_heard());
  gst_harness_teardown(audio);
}

CHECK_MAIN(soundtactile_chair)
