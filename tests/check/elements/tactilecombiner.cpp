// SPDX-License-Identifier: LGPL-2.1-or-later
#include <thread>
#include <vector>

#include "gst/fusion/sound_meta.h"

#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

namespace {

constexpr const gchar *kVideoCaps = "video/x-raw,format=GRAY8,width=8,height=8,framerate=25/1";
constexpr GstClockTime kFrame = 40 * GST_MSECOND;

/// The element with a harness for the film and one for the track.
class Combiner
{
public:
  explicit Combiner(bool with_track = true)
      : element_(gst_element_factory_make("tactilecombiner", nullptr)),
        video(gst_harness_new_with_element(element_, "sink", "src")),
        track(with_track ? gst_harness_new_with_element(element_, "tactile", nullptr) : nullptr)
  {
    gst_harness_set_src_caps_str(video, kVideoCaps);
    if (track != nullptr) {
      gst_harness_set_src_caps_str(track,
                                   "application/x-tactile-map,rows=1,columns=2,framerate=0/1");
      feeder_ = std::thread([this] { feed(); });
    }
  }
  ~Combiner()
  {
    if (track != nullptr) {
      gst_harness_push_event(track, gst_event_new_flush_start());
      g_async_queue_push(to_push_, this);
      feeder_.join();
      gst_harness_teardown(track);
    }
    gst_harness_teardown(video);
    gst_object_unref(element_);
    g_async_queue_unref(to_push_);
  }
  Combiner(const Combiner &) = delete;
  Combiner &operator=(const Combiner &) = delete;

  void set(const gchar *name, const gchar *value)
  {
    gst_util_set_object_arg(G_OBJECT(element_), name, value);
  }

  /// Pushes a map of the track, times in ms.
  void push_map(gfloat level, GstClockTime begin, GstClockTime end, bool is_sound = false)
  {
    const gfloat levels[] = { level, 0 };
    GstBuffer *map = gst_tactile_map_buffer_new(levels, 2);
    GST_BUFFER_PTS(map) = begin * GST_MSECOND;
    GST_BUFFER_DURATION(map) = end > begin ? (end - begin) * GST_MSECOND : GST_CLOCK_TIME_NONE;
    if (is_sound)
      GST_BUFFER_FLAG_SET(map, kSoundMap);
    g_async_queue_push(to_push_, map);
  }
  void end_track()
  {
    g_async_queue_push(to_push_, gst_event_new_eos());
  }
  void push_gap(GstClockTime begin, GstClockTime duration, GstGapFlags flags = {})
  {
    GstEvent *gap = gst_event_new_gap(begin, duration);
    gst_event_set_gap_flags(gap, flags);
    g_async_queue_push(to_push_, gap);
  }
  void push_raw(GstBuffer *map)
  {
    g_async_queue_push(to_push_, map);
  }

  /// Pushes frame `number`, with a map of its own if `own` is not negative.
  void push_frame(guint number, gfloat own = -1, guint rows = 1, guint columns = 2)
  {
    GstBuffer *frame = gst_buffer_new_allocate(nullptr, 64, nullptr);
    GST_BUFFER_PTS(frame) = number * kFrame;
    GST_BUFFER_DURATION(frame) = kFrame;
    if (own >= 0) {
      const std::vector<gfloat> levels(std::size_t{ rows } * columns, own);
      gst_buffer_add_tactile_meta(frame, rows, columns, levels.data(), levels.size());
    }
    fail_unless_equals_int(gst_harness_push(video, frame), GST_FLOW_OK);
  }

  /// The levels of the next frame, none if it has no map.
  std::vector<gfloat> pull()
  {
    GstBuffer *frame = gst_harness_pull(video);
    fail_unless(frame != nullptr);
    fail_unless_equals_uint64(GST_BUFFER_PTS(frame), next_++ * kFrame);
    std::vector<gfloat> levels;
    if (const GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame)) {
      gsize n = 0;
      const gfloat *all = gst_tactile_meta_get_levels(meta, &n);
      levels.assign(all, all + n);
    }
    added = sound_meta(frame, 1, 2);
    gst_buffer_unref(frame);
    return levels;
  }
  std::optional<tactile::TactileMap> added; ///< by the sound, to the frame that pull() took

private:
  /// The track's streaming thread, as the element blocks on a buffer until the film gets there.
  /// Ends at an item that is neither buffer nor event.
  void feed()
  {
    for (gpointer next = nullptr; (next = g_async_queue_pop(to_push_)) != this;)
      if (GST_IS_EVENT(next))
        gst_harness_push_event(track, GST_EVENT(next));
      else
        gst_harness_push(track, GST_BUFFER(next));
  }

  GstElement *element_;
  guint64 next_ = 0;
  GAsyncQueue *to_push_ = g_async_queue_new();
  std::thread feeder_;

public:
  GstHarness *video;
  GstHarness *track;
};

#define ASSERT_LEVELS(combiner, ...)                                                               \
  do {                                                                                             \
    const std::vector<gfloat> expected = __VA_ARGS__;                                              \
    fail_unless((combiner).pull() == expected);                                                    \
  } while (0)

} // namespace

GST_START_TEST(test_map_at_the_frames_beginning)
{
  Combiner c;
  c.push_map(0.5F, 0, 40);
  c.push_map(1, 79, 121); // begins during frame 1, ends during frame 3
  c.push_map(0.25F, 160, 161);
  c.end_track();
  for (guint i = 0; i < 6; i++)
    c.push_frame(i);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 0, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
  ASSERT_LEVELS(c, { 0.25F, 0 });
  ASSERT_LEVELS(c, { 0, 0 }); // the film is longer
}
GST_END_TEST;

GST_START_TEST(test_film_ends_first)
{
  Combiner c;
  c.push_map(0.5F, 0, 10'000);
  c.push_map(1, 10'000, 20'000);
  c.push_frame(0);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  fail_unless(gst_harness_push_event(c.video, gst_event_new_eos()));
  GstEvent *event = nullptr;
  do {
    gst_clear_event(&event);
    event = gst_harness_pull_event(c.video);
  } while (event != nullptr && GST_EVENT_TYPE(event) != GST_EVENT_EOS);
  fail_unless(event != nullptr);
  gst_event_unref(event);
}
GST_END_TEST;

GST_START_TEST(test_offset)
{
  for (const auto &[offset, first] : { std::pair{ "40000000", 1 }, { "-40000000", -1 } }) {
    Combiner c;
    c.set("offset", offset);
    c.push_map(0.25F, 0, 40);
    c.push_map(0.5F, 40, 80);
    c.push_map(1, 80, 120);
    c.end_track();
    const std::vector<gfloat> track = { 0.25F, 0.5F, 1 };
    for (int i = 0; i < 5; i++) {
      c.push_frame(static_cast<guint>(i));
      const int at = i - first;
      ASSERT_LEVELS(c, { at >= 0 && at < 3 ? track[static_cast<std::size_t>(at)] : 0, 0 });
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_gaps)
{
  Combiner c;
  c.push_map(0.5F, 0, 40);
  c.push_gap(kFrame, 2 * kFrame);
  c.push_map(1, 120, 160);
  c.end_track();
  for (guint i = 0; i < 4; i++)
    c.push_frame(i);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 0, 0 });
  ASSERT_LEVELS(c, { 0, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
}
GST_END_TEST;

/// What was lost on the way does not end what is felt.
GST_START_TEST(test_map_holds_for_lost_data)
{
  Combiner c;
  c.push_map(0.5F, 0, 40);
  c.push_gap(kFrame, kFrame, GST_GAP_FLAG_MISSING_DATA);
  c.push_gap(2 * kFrame, kFrame);
  c.push_map(1, 120, 160);
  c.end_track();
  for (guint i = 0; i < 4; i++)
    c.push_frame(i);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 0, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
}
GST_END_TEST;

GST_START_TEST(test_map_without_duration_holds)
{
  Combiner c;
  c.push_map(0.5F, 0, 0);
  c.push_map(1, 80, 0);
  c.end_track();
  for (guint i = 0; i < 4; i++)
    c.push_frame(i);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 0.5F, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
  ASSERT_LEVELS(c, { 1, 0 });
}
GST_END_TEST;

GST_START_TEST(test_frame_waits_for_the_track)
{
  Combiner c;
  c.push_map(0.5F, 0, 40);
  c.push_frame(0);
  ASSERT_LEVELS(c, { 0.5F, 0 }); // track known this far
  c.push_frame(1);               // but no further
  c.push_map(1, 40, 80);
  ASSERT_LEVELS(c, { 1, 0 });
}
GST_END_TEST;

GST_START_TEST(test_mix)
{
  for (const bool strongest : { false, true }) {
    Combiner c;
    c.set("mix", strongest ? "max" : "replace");
    c.push_map(1, 0, 40);
    c.end_track();
    c.push_frame(0, 0.5F);
    c.push_frame(1, 0.5F);
    if (strongest) {
      ASSERT_LEVELS(c, { 1, 0.5F });
      ASSERT_LEVELS(c, { 0.5F, 0.5F });
    } else {
      ASSERT_LEVELS(c, { 1, 0 });
      ASSERT_LEVELS(c, { 0, 0 });
    }
  }
}
GST_END_TEST;

// The sum is at most 1; the gate gives the track's strength to the film's place.
GST_START_TEST(test_mix_of_sound)
{
  const auto mixed = [](const char *mix, float felt) {
    Combiner c;
    c.set("mix", mix);
    c.push_map(felt, 0, 40);
    c.end_track();
    c.push_frame(0, 0.5F);
    return c.pull();
  };
  fail_unless(mixed("sum", 0.25F) == std::vector<float>({ 0.75F, 0.5F }));
  fail_unless(mixed("sum", 0.75F) == std::vector<float>({ 1, 0.5F }));
  fail_unless(mixed("gate", 0.25F) == std::vector<float>({ 0.25F, 0.25F }));
  fail_unless(mixed("gate", 0) == std::vector<float>({ 0, 0 }));
  fail_unless(mixed("accent", 0.25F) == std::vector<float>({ 0.5F, 0.5F }));
  fail_unless(mixed("accent", 1) == std::vector<float>({ 1, 1 }));
  fail_unless(mixed("stress", 1) == std::vector<float>({ 1, 1 }));
}
GST_END_TEST;

// A frame tells what the sound added, and that it ended; a track that is no sound adds nothing.
GST_START_TEST(test_what_came_from_which)
{
  Combiner c;
  c.set("mix", "accent");
  c.push_map(0.75F, 0, 40, true);
  c.push_map(0, 40, 80, true);
  c.push_map(1, 80, 120, false);
  c.end_track();
  c.push_frame(0, 0.5F);
  ASSERT_LEVELS(c, { 0.75F, 0.75F });
  fail_unless(c.added && c.added->levels == std::vector<float>({ 0.25F, 0.25F }));
  c.push_frame(1, 0.5F);
  ASSERT_LEVELS(c, { 0.5F, 0.5F });
  fail_unless(c.added && c.added->levels == std::vector<float>({ 0, 0 }));
  c.push_frame(2, 0.5F);
  ASSERT_LEVELS(c, { 1, 1 });
  fail_if(c.added.has_value());
}
GST_END_TEST;
GST_START_TEST(test_mix_of_grids)
{
  Combiner c;
  c.set("mix", "max");
  c.push_map(1, 0, 40);
  c.end_track();
  c.push_frame(0, 0.25F, 2, 4); // each cell of the track is two by two of the film's
  ASSERT_LEVELS(c, { 1, 1, 0.25F, 0.25F, 1, 1, 0.25F, 0.25F });
}
GST_END_TEST;

GST_START_TEST(test_without_a_track)
{
  Combiner none(false);
  none.push_frame(0, 0.5F);
  none.push_frame(1);
  ASSERT_LEVELS(none, { 0.5F, 0.5F });
  fail_unless(none.pull().empty());
}
GST_END_TEST;

GST_START_TEST(test_seek)
{
  Combiner c;
  c.push_map(1, 0, 40);
  c.push_frame(0);
  ASSERT_LEVELS(c, { 1, 0 });
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  for (GstHarness *h : { c.video, c.track })
    fail_unless(gst_harness_push_event(h, gst_event_new_flush_start()));
  for (GstHarness *h : { c.video, c.track }) {
    fail_unless(gst_harness_push_event(h, gst_event_new_flush_stop(TRUE)));
    fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  }
  c.push_map(0.25F, 40, 80);
  c.push_frame(1);
  ASSERT_LEVELS(c, { 0.25F, 0 });
}
GST_END_TEST;

GST_START_TEST(test_wrong_size)
{
  Combiner c;
  const ElementBus messages(c.video->element);
  GstBuffer *map = gst_buffer_new_allocate(nullptr, 7, nullptr);
  GST_BUFFER_PTS(map) = 0;
  c.push_raw(map);
  GstBuffer *frame = gst_buffer_new_allocate(nullptr, 64, nullptr);
  GST_BUFFER_PTS(frame) = 0;
  gst_harness_push(c.video, frame);
  g_autoptr(GstMessage) message
      = gst_bus_timed_pop_filtered(messages.bus, 10 * GST_SECOND, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
}
GST_END_TEST;

static Suite *
tactilecombiner_suite(void)
{
  Suite *suite = suite_create("tactilecombiner");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_map_at_the_frames_beginning);
  tcase_add_test(tests, test_film_ends_first);
  tcase_add_test(tests, test_offset);
  tcase_add_test(tests, test_gaps);
  tcase_add_test(tests, test_map_holds_for_lost_data);
  tcase_add_test(tests, test_map_without_duration_holds);
  tcase_add_test(tests, test_frame_waits_for_the_track);
  tcase_add_test(tests, test_mix);
  tcase_add_test(tests, test_mix_of_grids);
  tcase_add_test(tests, test_mix_of_sound);
  tcase_add_test(tests, test_what_came_from_which);
  tcase_add_test(tests, test_without_a_track);
  tcase_add_test(tests, test_seek);
  tcase_add_test(tests, test_wrong_size);
  return suite;
}

GST_CHECK_MAIN(tactilecombiner)
