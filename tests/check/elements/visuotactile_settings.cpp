// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The user's settings in visuotactilesink and visuotactiledecoder: when they are read, what they
// change, and what stays the player's.
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <utility>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/contains.h"
#include "support/playing.h"
#include "support/settings_home.h"
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

// Before GStreamer starts: a scan of the plugins reads the settings.
const SettingsHome home;

/// READY, with the settings.
GstElement *
open_sink(const std::string &settings, const std::string &properties = "")
{
  home.write(settings);
  GstElement *pipeline = make_pipeline("videotestsrc num-buffers=5 ! visuotactilesink name=sink "
                                       "video-sink=fakesink "
                                       + properties);
  change_state(pipeline, GST_STATE_READY);
  return pipeline;
}

void
close_sink(GstElement *pipeline)
{
  change_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

GstElement *
child(GstElement *pipeline, const char *name)
{
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  GObject *found = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(sink), name);
  fail_unless(found != nullptr);
  g_object_unref(found); // its bin holds a reference
  return GST_ELEMENT(found);
}

gdouble
intensity(GstElement *pipeline)
{
  gdouble value = -1;
  g_object_get(child(pipeline, "tactors"), "intensity", &value, nullptr);
  return value;
}

std::string
sound_of(GstElement *pipeline)
{
  g_auto(GValue) value = G_VALUE_INIT;
  g_object_get_property(G_OBJECT(child(pipeline, "sound")), "sound", &value);
  auto *klass = static_cast<GEnumClass *>(g_type_class_peek(G_VALUE_TYPE(&value)));
  return g_enum_get_value(klass, g_value_get_enum(&value))->value_nick;
}

/// Writes the settings, and waits until the tactors have been told of a property.
void
change(GstElement *pipeline, const std::string &settings, const char *property)
{
  std::promise<void> told;
  struct Once
  {
    std::promise<void> *told;
    bool done;
  } once = { &told, false };
  const auto on_notify = +[](GObject *, GParamSpec *, Once *once) {
    if (!std::exchange(once->done, true))
      once->told->set_value();
  };
  const std::string signal = std::string("notify::") + property;
  GstElement *tactors = child(pipeline, "tactors");
  const gulong id = g_signal_connect(tactors, signal.c_str(), G_CALLBACK(on_notify), &once);
  home.write(settings);
  told.get_future().wait();
  g_signal_handler_disconnect(tactors, id);
}

} // namespace

/* ---- visuotactilesink ---- */

CHECK_TEST(test_the_start_applies_them)
{
  GstElement *pipeline = open_sink(
      "[chair]\ndriver=simulator\ngrid=2x4\nintensity=0.5\nsensitivity=2\nsound=music\n");
  g_autofree gchar *driver = nullptr;
  guint rows = 0;
  guint columns = 0;
  gdouble sensitivity = 0;
  g_object_get(child(pipeline, "tactors"), "driver", &driver, nullptr);
  g_object_get(child(pipeline, "analysis"), "rows", &rows, "columns", &columns, "sensitivity",
               &sensitivity, nullptr);
  ck_assert_str_eq(driver, "simulator");
  ck_assert_uint_eq(rows, 2);
  ck_assert_uint_eq(columns, 4);
  fail_unless(intensity(pipeline) == 0.5);
  fail_unless(sensitivity == 2);
  fail_unless(sound_of(pipeline) == "music");
  close_sink(pipeline);
}

/// Shakers, which visuotactile-play alone plays on, are no error in a player.
CHECK_TEST(test_shakers_are_left_out)
{
  home.write("[chair]\ndriver=audio\ndevice=Card\nmapping=1,0\ngrid=1x2\nintensity=0.5\n");
  GstElement *sink = gst_element_factory_make("visuotactilesink", nullptr);
  const ElementBus bus(sink);
  change_state(sink, GST_STATE_READY);
  assert_contains(bus.said(GST_MESSAGE_WARNING).text, { "plays on no shakers" });
  g_autofree gchar *driver = nullptr;
  g_autofree gchar *device = nullptr;
  g_autofree gchar *mapping = nullptr;
  gdouble factor = 0;
  g_object_get(sink, "driver", &driver, "device", &device, "mapping", &mapping, "intensity",
               &factor, nullptr);
  ck_assert_str_eq(driver, "auto");
  fail_unless(device == nullptr || *device == '\0');
  ck_assert_str_eq(mapping, "");
  fail_unless(factor == 0.5);
  change_state(sink, GST_STATE_NULL);
  gst_object_unref(sink);
}

/// playsink sets the video sink's ts-offset when it connects picture and sound.
CHECK_TEST(test_delay_stays_in_playbin)
{
  home.write("[chair]\ndriver=simulator\ndelay=100\n");
  const TemporaryFile film("", ".mkv");
  play_to_the_end(make_pipeline("videotestsrc num-buffers=5 ! jpegenc ! matroskamux name=mux ! "
                                "filesink location="
                                + film.path + " audiotestsrc num-buffers=10 ! mux."));
  GstElement *pipeline = make_pipeline("playbin name=player");
  GstElement *sink = gst_element_factory_make("visuotactilesink", "sink");
  GstElement *shown = gst_element_factory_make("fakesink", nullptr);
  g_object_set(sink, "video-sink", shown, nullptr);
  g_object_set(pipeline, "uri", ("file://" + film.path).c_str(), "video-sink", sink, "audio-sink",
               gst_element_factory_make("fakesink", nullptr), nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  gdouble delay = 0;
  g_object_get(child(pipeline, "tactors"), "delay", &delay, nullptr);
  fail_unless(delay == 100);
  close_sink(pipeline);
}

CHECK_TEST(test_what_the_player_set_stays)
{
  GstElement *pipeline = open_sink("[chair]\ngrid=2x4\nintensity=0.5\n",
                                   "driver=simulator columns=7 intensity=0.25");
  guint rows = 0;
  guint columns = 0;
  g_object_get(child(pipeline, "analysis"), "rows", &rows, "columns", &columns, nullptr);
  ck_assert_uint_eq(rows, 2);
  ck_assert_uint_eq(columns, 7);
  fail_unless(intensity(pipeline) == 0.25);
  // Also later: once mute has been applied, so has what precedes it.
  change(pipeline, "[chair]\nintensity=0.75\nmute=true\n", "mute");
  fail_unless(intensity(pipeline) == 0.25);
  close_sink(pipeline);
}

CHECK_TEST(test_changes_apply_while_it_plays)
{
  GstElement *pipeline = open_sink("[chair]\ndriver=simulator\nintensity=0.5\n");
  change(pipeline, "[chair]\ndriver=simulator\ngrid=5x5\nintensity=0.75\n", "intensity");
  fail_unless(intensity(pipeline) == 0.75);
  fail_unless(sound_of(pipeline) == "film"); // the default
  guint rows = 0;
  g_object_get(child(pipeline, "analysis"), "rows", &rows, nullptr);
  ck_assert_uint_eq(rows, 3); // not live
  // A key that is gone gives the default back.
  change(pipeline, "[chair]\ndriver=simulator\n", "intensity");
  fail_unless(intensity(pipeline) == 1);
  close_sink(pipeline);
}

/// The usual value would be felt at full strength.
CHECK_TEST(test_refused_values_change_nothing)
{
  GstElement *pipeline = open_sink("[chair]\ndriver=simulator\nintensity=0.5\n");
  change(pipeline, "[chair]\ndriver=simulator\nintensity=loud\nmute=true\n", "mute");
  fail_unless(intensity(pipeline) == 0.5);
  close_sink(pipeline);
}

CHECK_TEST(test_off_only_shows)
{
  home.write("[chair]\nenabled=false\n");
  GstElement *pipeline
      = make_pipeline("videotestsrc num-buffers=5 ! visuotactilesink name=sink "
                      "driver=simulator video-sink=\"fakesink name=screen sync=false\"");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  ck_assert_int_eq(GST_STATE(child(pipeline, "analysis")), GST_STATE_NULL);
  ck_assert_int_eq(GST_STATE(child(pipeline, "tactors")), GST_STATE_NULL);
  {
    g_autoptr(GstElement) screen = gst_bin_get_by_name(GST_BIN(pipeline), "screen");
    g_autoptr(GstStructure) stats = nullptr;
    g_object_get(screen, "stats", &stats, nullptr);
    guint64 shown = 0;
    gst_structure_get_uint64(stats, "rendered", &shown);
    ck_assert_uint_eq(shown, 5);
  }
  change_state(pipeline, GST_STATE_NULL);

  // On again: felt. The source counts anew.
  home.write("[chair]\nenabled=true\n");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  ck_assert_int_eq(GST_STATE(child(pipeline, "analysis")), GST_STATE_PLAYING);
  ck_assert_uint_eq(stat_of(child(pipeline, "analysis"), "analyzed"), 5);
  close_sink(pipeline);
}

static GstClockTime
latency_of(const std::string &sink)
{
  GstElement *pipeline = make_pipeline("videotestsrc is-live=true ! " + sink);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
  g_autoptr(GstQuery) query = gst_query_new_latency();
  fail_unless(gst_element_query(pipeline, query));
  GstClockTime min = 0;
  gst_query_parse_latency(query, nullptr, &min, nullptr);
  close_sink(pipeline);
  return min;
}

CHECK_TEST(test_off_is_not_late)
{
  const std::string chair = "visuotactilesink driver=simulator video-sink=fakesink";
  const GstClockTime plain = latency_of("fakesink");
  home.write("[chair]\nenabled=true\n");
  fail_unless(latency_of(chair) > plain);
  home.write("[chair]\nenabled=false\n");
  ck_assert_uint_eq(latency_of(chair), plain);
}

CHECK_TEST(test_wrong_ones_are_told)
{
  home.write("[chair]\nintensity=9\nmute=true\n");
  GstElement *sink = gst_element_factory_make("visuotactilesink", nullptr);
  g_object_set(sink, "driver", "simulator", nullptr);
  const ElementBus bus(sink);
  change_state(sink, GST_STATE_READY);
  const Said said = bus.said(GST_MESSAGE_WARNING);
  fail_unless(said.domain == GST_LIBRARY_ERROR);
  ck_assert_int_eq(said.code, GST_LIBRARY_ERROR_SETTINGS);
  assert_contains(said.text, { "[chair] intensity: expected a number from 0 to 1, got '9'" });
  gboolean mute = FALSE;
  g_object_get(sink, "mute", &mute, nullptr);
  fail_unless(mute);
  change_state(sink, GST_STATE_NULL);
  gst_object_unref(sink);
}

/* ---- visuotactiledecoder ---- */

static bool
opens(const char *settings)
{
  home.write(settings);
  GstElement *decoder = gst_element_factory_make("visuotactiledecoder", nullptr);
  gst_child_proxy_set(GST_CHILD_PROXY(decoder), "tactors::driver", "simulator", nullptr);
  const ElementBus bus(decoder);
  const bool opened = gst_element_set_state(decoder, GST_STATE_READY) != GST_STATE_CHANGE_FAILURE;
  fail_if(bus.has(GST_MESSAGE_ERROR)); // it would end the film
  gst_element_set_state(decoder, GST_STATE_NULL);
  gst_object_unref(decoder);
  return opened;
}

CHECK_TEST(test_the_decoder_is_for_programs_that_are_on)
{
  const std::string own = g_get_prgname();
  fail_unless(opens(""));
  fail_unless(opens("[chair]\nenabled=true\n"));
  fail_unless(opens(("[" + own + "]\nenabled=true\n").c_str()));
  fail_unless(opens(("[" + own + "]\nenabled=true\n[totem]\nenabled=true\n").c_str()));
  fail_if(opens("[chair]\nenabled=false\n"));
  fail_if(opens(("[chair]\nenabled=true\n[" + own + "]\nenabled=false\n").c_str()));
  fail_if(opens("[totem]\nenabled=true\n"));
}

CHECK_MAIN(visuotactile_settings)
