// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What visuotactile-follow learns of a film's file, and a film that changes while it looks.
#include "visuotactile-follow/film_probe.h"

#include <condition_variable>
#include <mutex>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

/// The URI of a film of a second with sound, which it writes.
std::string
make_film(const std::string &path)
{
  const Pipeline pipeline
      = make_pipeline("videotestsrc num-buffers=30 ! video/x-raw,format=I420,width=160,height=120,"
                      "framerate=30/1 ! jpegenc ! matroskamux name=mux ! filesink location="
                      + path
                      + " audiotestsrc samplesperbuffer=1470 num-buffers=30 ! "
                        "audio/x-raw,format=S16LE,rate=44100,channels=1 ! mux.");
  const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus.get(), GST_CLOCK_TIME_NONE,
      static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
  g_autofree gchar *uri = gst_filename_to_uri(path.c_str(), nullptr);
  return uri;
}

/// Waits, without the main loop, for pads of the bin that reads films for GstDiscoverer.
class Pads
{
public:
  Pads()
      : signal_(g_signal_lookup("pad-added", GST_TYPE_ELEMENT)),
        hook_(g_signal_add_emission_hook(signal_, 0, on_pad, this, nullptr))
  {
  }
  ~Pads()
  {
    g_signal_remove_emission_hook(signal_, hook_);
  }
  Pads(const Pads &) = delete;
  Pads &operator=(const Pads &) = delete;

  void wait_for(int pads)
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return pads_ >= pads; });
  }

private:
  static gboolean on_pad(GSignalInvocationHint *, guint, const GValue *values, gpointer self)
  {
    g_autofree gchar *name = gst_object_get_name(GST_OBJECT(g_value_get_object(values)));
    if (g_strcmp0(name, "discoverer-uri") == 0) // elements that are being made have no name
      static_cast<Pads *>(self)->add();
    return TRUE;
  }

  void add()
  {
    const std::lock_guard lock(mutex_);
    pads_++;
    changed_.notify_all();
  }

  guint signal_;
  gulong hook_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int pads_ = 0;
};

} // namespace

CHECK_TEST(test_result)
{
  const TemporaryFile film("", ".mkv");
  const FilmProbe probe(make_film(film.path));
  while (!probe.result())
    g_main_context_iteration(nullptr, TRUE);
  fail_unless(probe.result()->has_picture && probe.result()->has_sound);
  fail_unless(!probe.result()->may_have_track);
  ck_assert_int_eq(probe.result()->duration.value().count() / 1'000'000, 1000);
}

/// The main loop has not heard of them yet when the program ends or another film begins.
CHECK_TEST(test_ends_while_it_looks)
{
  const TemporaryFile film("", ".mkv");
  const std::string uri = make_film(film.path);
  for (const int pads : { 0, 1, 2 }) {
    Pads seen;
    const FilmProbe probe(uri);
    seen.wait_for(pads);
  }
  while (g_main_context_iteration(nullptr, FALSE) != FALSE) // nothing of theirs is left
    ;
}

CHECK_MAIN_TIMEOUT(film_probe, 60)
