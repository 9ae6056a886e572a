// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/pipeline_sound.h"

#include <array>
#include <barrier>
#include <thread>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using Maps = std::shared_ptr<fusion::SoundMaps>;

// Elements of one pipeline meet, wherever they are in it; those of another one are elsewhere.
CHECK_TEST(test_one_pipeline)
{
  GstElement *pipelines[2];
  GstElement *parts[2];
  for (int i = 0; i < 2; i++) {
    pipelines[i] = gst_pipeline_new(nullptr);
    parts[i] = gst_bin_new("inner");
    gst_bin_add(GST_BIN(parts[i]), gst_bin_new("deep"));
    gst_bin_add(GST_BIN(pipelines[i]), parts[i]);
  }
  g_autoptr(GstElement) deep = gst_bin_get_by_name(GST_BIN(pipelines[0]), "deep");
  const Maps maps = sound_maps_of(deep);
  fail_unless(maps && maps == sound_maps_of(parts[0]) && maps == sound_maps_of(deep));
  fail_unless(maps != sound_maps_of(parts[1]));
  for (GstElement *pipeline : pipelines)
    gst_object_unref(pipeline);
}

// Two threads that ask at once get the same.
CHECK_TEST(test_at_once)
{
  constexpr int kRounds = 8000;
  std::vector<GstElement *> pipelines;
  std::array<std::vector<GstElement *>, 2> asking;
  std::array<std::vector<Maps>, 2> found;
  for (int i = 0; i < kRounds; i++) {
    pipelines.push_back(gst_bin_new(nullptr));
    for (auto &who : asking) {
      who.push_back(gst_bin_new(nullptr));
      gst_bin_add(GST_BIN(pipelines.back()), who.back());
    }
  }
  std::barrier start(2);
  const auto ask = [&](std::size_t who) {
    for (GstElement *element : asking[who]) {
      start.arrive_and_wait();
      found[who].push_back(sound_maps_of(element));
    }
  };
  std::thread other(ask, 1);
  ask(0);
  other.join();
  fail_unless(found[0] == found[1]);
  for (GstElement *pipeline : pipelines)
    gst_object_unref(pipeline);
}

CHECK_MAIN(pipeline_sound)
