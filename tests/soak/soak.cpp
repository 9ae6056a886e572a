// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Hours of film in minutes: tactorsink on a GstTestClock, and whole films as fast as the machine
// allows. Counts memory, threads and file handles, which must not grow. Every command must be on
// time.
//
// Usage: soak [--hours=N] [--clip=FILE]...
#include "support/tactorsink_rig.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <malloc.h>

#include "support/check_tests.h"

namespace {

double hours = 0.1; ///< of film, in each test
gchar **clips = nullptr;

/// Resources of the process that must not grow.
struct Usage
{
  double heap = 0;     ///< KiB, allocated
  double resident = 0; ///< KiB
  long handles = 0;
  long threads = 0;
};

long
entries(const char *folder)
{
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

Usage
usage()
{
  Usage now;
  now.heap = static_cast<double>(mallinfo2().uordblks) / 1024;
  std::ifstream rollup("/proc/self/smaps_rollup");
  for (std::string line; std::getline(rollup, line);)
    if (line.starts_with("Rss:"))
      now.resident = std::stod(line.substr(4));
  now.handles = entries("/proc/self/fd");
  now.threads = entries("/proc/self/task");
  return now;
}

/// Prints a line per sample, and checks at the end that nothing grew.
class Record
{
public:
  explicit Record(const char *what)
  {
    std::printf("%s\nfilm h   heap KiB   RSS KiB   handles   threads\n", what);
  }
  void look(double at)
  {
    const Usage now = usage();
    std::printf("%6.2f %10.1f %9.0f %9ld %9ld\n", at, now.heap, now.resident, now.handles,
                now.threads);
    std::fflush(stdout);
    looks_.emplace_back(at, now);
  }
  /// The first sample is the baseline: caches and pools are filled by then.
  void expect_constant(double kib_per_hour) const
  {
    const auto &[begin, first] = looks_.front();
    const auto &[end, last] = looks_.back();
    const double length = std::max(end - begin, 1e-9);
    // Buffers in flight come and go: the least of each half is what is kept.
    const auto least = [this](std::size_t from, std::size_t to) {
      double heap = looks_[from].second.heap;
      for (std::size_t i = from; i < to; i++)
        heap = std::min(heap, looks_[i].second.heap);
      return heap;
    };
    const std::size_t half = looks_.size() / 2;
    const double growth = least(half, looks_.size()) - least(0, std::max<std::size_t>(half, 1));
    std::printf("growth: heap %.2f KiB, RSS %.1f KiB in %.2f h of film\n", growth,
                last.resident - first.resident, length);
    // The size of GLib's thread pool varies: the maximum of the second half must not exceed that of
    // the first.
    long most = 0;
    for (std::size_t i = 0; i < looks_.size(); i++) {
      const Usage &now = looks_[i].second;
      ck_assert_int_eq(now.handles, first.handles);
      if (i <= looks_.size() / 2)
        most = std::max(most, now.threads);
      fail_unless(now.threads <= most, "%ld threads, earlier at most %ld", now.threads, most);
    }
    // The halves are half the length apart.
    fail_unless(growth < kib_per_hour * length / 2 + 32, "the heap grew by %g KiB in %g h", growth,
                length);
  }

private:
  std::vector<std::pair<double, Usage>> looks_;
};

constexpr int kLooks = 24; ///< samples per run

} // namespace

/// A new level every 200 ms: one command per block, issued at its exact due time, in the last hour
/// as in the first.
CHECK_TEST(test_hours_on_the_clock)
{
  constexpr int kFramesPerBlock = 5;
  const auto frames = static_cast<guint64>(hours * 3600 * 25);
  const guint64 piece = std::max<guint64>(frames / kLooks / kFramesPerBlock, 1) * kFramesPerBlock;
  SinkRig rig;
  g_object_set(rig.element, "trace-location", nullptr, nullptr);
  rig.start();
  Record record("tactorsink on a test clock");
  guint64 frame = 0;
  while (frame < frames) {
    rig.run_out([&] {
      for (guint64 i = 0; i < piece; i++, frame++)
        ck_assert_int_eq(
            rig.push(frame * kFrame, { frame / kFramesPerBlock % 2 == 0 ? 0.9f : 0.4f }),
            GST_FLOW_OK);
    });
    record.look(static_cast<double>(frame) / 25 / 3600);
  }
  rig.run_out([&] { rig.end(); });
  record.expect_constant(1);
  ck_assert_uint_eq(rig.stat("issued"), frame / kFramesPerBlock + 1); // plus the zero at the end
  for (const char *none : { "late", "coalesced", "dropped", "starved" })
    ck_assert_uint_eq(rig.stat(none), 0);
  GstStructure *stats = nullptr;
  g_object_get(rig.element, "actuation-stats", &stats, nullptr);
  gint64 most = -1;
  fail_unless(gst_structure_get_int64(stats, "error-max", &most));
  gst_structure_free(stats);
  ck_assert_int_eq(most, 0);
  std::printf("%" G_GUINT64_FORMAT " commands, issued - due at most %" G_GINT64_FORMAT " ns\n",
              frame / kFramesPerBlock + 1, most);
}

/// Analysis, extractor, queue and planner, as fast as possible.
CHECK_TEST(test_hours_of_film)
{
  constexpr int kRate = 10;
  const auto frames = static_cast<gint>(hours * 3600 * kRate);
  GstElement *pipeline = make_pipeline(
      "tactiletestsrc name=source pattern=dynamic-motion num-buffers=" + std::to_string(frames)
      + " ! video/x-raw,format=I420,width=64,height=48,framerate=10/1 ! saliencytactile "
        "! tactileextractor name=x x.src ! queue ! fakesink sync=false name=picture "
        "x.tactile ! queue ! tactorsink name=tactors driver=simulator sync=false");
  GstElement *tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
  GstBus *bus = gst_element_get_bus(pipeline);
  std::atomic<int> shown{ 0 };
  GstElement *picture = gst_bin_get_by_name(GST_BIN(pipeline), "picture");
  GstPad *pad = gst_element_get_static_pad(picture, "sink");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad *, GstPadProbeInfo *, gpointer count) {
        ++*static_cast<std::atomic<int> *>(count);
        return GST_PAD_PROBE_OK;
      },
      &shown, nullptr);
  gst_object_unref(pad);
  gst_object_unref(picture);
  Record record("film, analysis and chair");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  const int piece = std::max(frames / kLooks, 1);
  // No sample of the last piece: threads end at EOS.
  for (int next = piece; next <= frames - piece; next += piece) {
    while (shown < next) {
      GstMessage *message = gst_bus_timed_pop_filtered(bus, 2 * GST_MSECOND, GST_MESSAGE_ERROR);
      fail_unless(message == nullptr);
    }
    record.look(static_cast<double>(shown) / kRate / 3600);
  }
  wait_for_eos(pipeline);
  const guint64 issued = actuation_stat_of(tactors, "issued");
  fail_unless(issued > 0);
  ck_assert_uint_eq(actuation_stat_of(tactors, "dropped"), 0);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  record.expect_constant(32);
  std::printf("%" G_GUINT64_FORMAT " commands\n", issued);
  gst_object_unref(bus);
  gst_object_unref(tactors);
  gst_object_unref(pipeline);
}

/// Loops by seeking to the start, as in an exhibition.
CHECK_TEST(test_looping_clips)
{
  for (gchar **clip = clips; clip && *clip; clip++) {
    GstElement *pipeline = make_pipeline(
        std::string("filesrc location=") + *clip
        + " ! decodebin ! videorate ! videoscale ! "
          "video/x-raw,width=160,height=90,framerate=10/1 ! saliencytactile ! "
          "tactileextractor name=x x.src ! queue ! fakesink sync=false x.tactile ! queue "
          "! tactorsink name=tactors driver=simulator sync=false");
    Record record(*clip);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    double played = 0;
    double looked = 0;
    while (played < hours) {
      wait_for_eos(pipeline);
      gint64 length = 0;
      fail_unless(gst_element_query_duration(pipeline, GST_FORMAT_TIME, &length) && length > 0);
      played += static_cast<double>(length) / GST_SECOND / 3600;
      if (played - looked >= hours / kLooks) {
        record.look(played);
        looked = played;
      }
      fail_unless(gst_element_seek_simple(pipeline, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, 0));
    }
    gst_element_set_state(pipeline, GST_STATE_NULL);
    record.expect_constant(256);
    gst_object_unref(pipeline);
  }
}

int
main(int argc, char **argv)
{
  const GOptionEntry entries[]
      = { { "hours", 0, 0, G_OPTION_ARG_DOUBLE, &hours, "Hours of film in each test (0.1)", "N" },
          { "clip", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &clips,
            "A film to be played again and again; may be repeated", "FILE" },
          {} };
  GOptionContext *context = g_option_context_new("- hours of film in minutes");
  g_option_context_add_main_entries(context, entries, nullptr);
  GError *error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error) || hours <= 0) {
    std::fprintf(stderr, "soak: %s\n", error ? error->message : "expected --hours above 0");
    g_clear_error(&error);
    g_option_context_free(context);
    return 2;
  }
  g_option_context_free(context);
  // Does not fork and has no time limit: usage is measured per process.
  g_setenv("CK_FORK", "no", TRUE);
  gst_check_init(&argc, &argv);
  const int failed = check_tests::run("soak", __FILE__);
  g_strfreev(clips);
  return failed;
}
