// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Seeks at every pad within the chair's elements, in players.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/patient_clock.h"
#include "support/played_film.h"
#include "support/start_player.h"
#include "support/stream_watch.h"
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

constexpr const char *kPlaybins[] = { "playbin", "playbin3" };

/// Whether it is the chair's own element, or in one.
bool
is_of_chair(GstElement *element)
{
  g_autoptr(GstObject) object = GST_OBJECT(gst_object_ref(element));
  while (object != nullptr) {
    for (const char *type : { "GstVisuotactileDecoder", "GstVisuotactileSink", "GstSoundTactile" })
      if (g_str_equal(G_OBJECT_TYPE_NAME(object), type))
        return true;
    GstObject *parent = gst_object_get_parent(object);
    gst_object_unref(object);
    object = parent;
  }
  return false;
}

void
on_element(GstBin *, GstBin *, GstElement *element, StreamWatch *watch)
{
  if (is_of_chair(element))
    watch->add(element);
}

} // namespace

/// With the decoder and with the sink, in playbin and playbin3.
CHECK_LOOP_TEST(test_seeks, 0, 4)
{
  const bool decodes = __i__ / 2 != 0;
  const TemporaryFile film;
  make_film(film.path, 150);
  rank_decoder("visuotactiledecoder", decodes ? GST_RANK_PRIMARY + 1000 : GST_RANK_NONE);
  GstElement *player = gst_element_factory_make(kPlaybins[__i__ % 2], nullptr);
  GstElement *screen = gst_element_factory_make(decodes ? "fakesink" : "visuotactilesink", nullptr);
  StreamWatch watch;
  {
    const PatientClock clock(player);
    g_signal_connect(player, "deep-element-added", G_CALLBACK(on_element), &watch);
    if (!decodes)
      g_object_set(screen, "driver", "simulator", "video-sink",
                   gst_element_factory_make("fakesink", nullptr), nullptr);
    g_object_set(player, "uri", uri_of(film.path).c_str(), "video-sink", screen, "audio-sink",
                 gst_element_factory_make("fakesink", nullptr), "audio-filter",
                 gst_element_factory_make("soundtactile", nullptr), nullptr);
    start_player(player, GST_STATE_PAUSED);
    gst_element_get_state(player, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    std::vector<guint32> seeks;
    for (const GstClockTime to : { 3 * GST_SECOND, GST_SECOND, 2 * GST_SECOND, 4 * GST_SECOND }) {
      GstEvent *seek = gst_event_new_seek(
          1, GST_FORMAT_TIME,
          static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE),
          GST_SEEK_TYPE_SET, static_cast<gint64>(to), GST_SEEK_TYPE_NONE, 0);
      seeks.push_back(gst_event_get_seqnum(seek));
      fail_unless(gst_element_send_event(player, seek));
      gst_element_get_state(player, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    }
    gst_element_set_state(player, GST_STATE_PLAYING);
    wait_for_eos(player);
    gst_element_set_state(player, GST_STATE_NULL);
    std::size_t most = 0;
    for (const auto &[pad, passed] : watch.passed())
      most = std::max(most, check_seeks(pad, passed, seeks));
    ck_assert_uint_eq(most, seeks.size());
    fail_unless(watch.passed().size() > 10, "%zu pads", watch.passed().size());
  }
  gst_object_unref(player);
  rank_decoder("visuotactiledecoder", GST_RANK_NONE);
}

CHECK_MAIN(players_seeks)
