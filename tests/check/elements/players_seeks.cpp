// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What a seek is made of, at every pad within the chair's elements, as gst-validate checks it:
// flushes and segments have its sequence number, it comes before its flush, and the first buffer
// after it is discontinuous.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <mutex>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/patient_clock.h"
#include "support/played_film.h"
#include "support/start_player.h"
#include "support/temporary_file.h"

namespace {

constexpr const char *kPlaybins[] = { "playbin", "playbin3" };

/// Keeps what passes the pads of a bin's elements and of all in it.
class Watch
{
public:
  /// One thing that passed a pad.
  struct Passed
  {
    std::string what;   ///< an event's name; "buffer"
    guint32 seqnum = 0; ///< of an event
    bool discont = false;
  };

  void add(GstElement *element)
  {
    GstIterator *pads = gst_element_iterate_pads(element);
    const auto found = [](const GValue *item, gpointer watch) {
      static_cast<Watch *>(watch)->add(GST_PAD(g_value_get_object(item)));
    };
    gst_iterator_foreach(pads, found, this);
    gst_iterator_free(pads);
  }

  std::map<std::string, std::vector<Passed>> passed()
  {
    const std::lock_guard lock(mutex_);
    return passed_;
  }

private:
  void add(GstPad *pad)
  {
    gst_pad_add_probe(pad,
                      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER
                                                   | GST_PAD_PROBE_TYPE_EVENT_BOTH
                                                   | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                      on_data, this, nullptr);
  }

  static GstPadProbeReturn on_data(GstPad *pad, GstPadProbeInfo *info, gpointer user)
  {
    auto *self = static_cast<Watch *>(user);
    g_autofree gchar *path = gst_object_get_path_string(GST_OBJECT(pad));
    Passed passed;
    if (info->type & GST_PAD_PROBE_TYPE_BUFFER) {
      passed.what = "buffer";
      passed.discont = GST_BUFFER_IS_DISCONT(GST_PAD_PROBE_INFO_BUFFER(info));
    } else {
      GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
      passed.what = gst_event_type_get_name(GST_EVENT_TYPE(event));
      passed.seqnum = gst_event_get_seqnum(event);
    }
    const std::lock_guard lock(self->mutex_);
    self->passed_[path].push_back(passed);
    return GST_PAD_PROBE_OK;
  }

  std::mutex mutex_;
  std::map<std::string, std::vector<Passed>> passed_;
};

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
on_element(GstBin *, GstBin *, GstElement *element, Watch *watch)
{
  if (is_of_chair(element))
    watch->add(element);
}

/// Checks a pad from the first seek on. Returns how often it had all that a seek is made of.
std::size_t
check(const std::string &pad, const std::vector<Watch::Passed> &passed,
      const std::vector<guint32> &seeks)
{
  std::size_t flushed = 0;  ///< seeks whose flush began
  std::size_t complete = 0; ///< and whose buffers came
  bool begins = false;
  for (const Watch::Passed &now : passed) {
    const bool starts = now.what == "flush-start";
    if (starts)
      flushed++;
    if (now.what == "seek")
      fail_unless(flushed < seeks.size() && now.seqnum == seeks[flushed],
                  "%s: a seek comes after its flush", pad.c_str());
    if (flushed == 0)
      continue;
    fail_unless(flushed <= seeks.size(), "%s: a flush that nobody asked for", pad.c_str());
    if (starts || now.what == "flush-stop" || now.what == "segment")
      fail_unless(now.seqnum == seeks[flushed - 1], "%s: %s has another number than the seek",
                  pad.c_str(), now.what.c_str());
    if (now.what == "flush-stop")
      begins = true;
    if (now.what == "buffer" && begins) {
      fail_unless(now.discont, "%s: no DISCONT after a seek", pad.c_str());
      begins = false;
      complete++;
    }
  }
  return complete;
}

} // namespace

/// With the decoder and with the sink, in playbin and playbin3.
GST_START_TEST(test_seeks)
{
  const bool decodes = __i__ / 2 != 0;
  const TemporaryFile film;
  make_film(film.path, 150);
  rank_decoder("visuotactiledecoder", decodes ? GST_RANK_PRIMARY + 1000 : GST_RANK_NONE);
  GstElement *player = gst_element_factory_make(kPlaybins[__i__ % 2], nullptr);
  GstElement *screen = gst_element_factory_make(decodes ? "fakesink" : "visuotactilesink", nullptr);
  Watch watch;
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
      most = std::max(most, check(pad, passed, seeks));
    ck_assert_uint_eq(most, seeks.size());
    fail_unless(watch.passed().size() > 10, "%zu pads", watch.passed().size());
  }
  gst_object_unref(player);
  rank_decoder("visuotactiledecoder", GST_RANK_NONE);
}
GST_END_TEST;

static Suite *
players_seeks_suite(void)
{
  Suite *suite = suite_create("players_seeks");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_loop_test(cases, test_seeks, 0, 4);
  return suite;
}

GST_CHECK_MAIN(players_seeks);
