// SPDX-License-Identifier: LGPL-2.1-or-later
#include <array>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "gst/fusion/later_maps.h"
#include "gst/fusion/sound_meta.h"

#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include "support/check_tests.h"

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
      if (feeder_.joinable())
        stop_feeding();
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
  /// Returns when all that was pushed has been taken or refused.
  void stop_feeding()
  {
    g_async_queue_push(to_push_, this);
    feeder_.join();
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
  void push_query()
  {
    g_async_queue_push(to_push_, gst_query_new_drain());
  }
  /// The next stream of the film or of the track, whose 0 is `base` in the pipeline.
  void begin_film(GstClockTime base)
  {
    g_autoptr(GstCaps) caps = gst_caps_from_string(kVideoCaps);
    for (GstEvent *event : beginning(caps, base))
      fail_unless(gst_harness_push_event(video, event));
  }
  void begin_track(GstClockTime base)
  {
    g_autoptr(GstCaps) caps
        = gst_caps_from_string("application/x-tactile-map,rows=1,columns=2,framerate=0/1");
    for (GstEvent *event : beginning(caps, base))
      g_async_queue_push(to_push_, event);
  }
  /// The next frame that is pulled is this one.
  void restart_times(guint number = 0)
  {
    next_ = number;
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
    later.clear();
    if (GstBufferList *maps = later_maps(frame))
      for (guint i = 0; i < gst_buffer_list_length(maps); i++) {
        gfloat level = 0;
        gst_buffer_extract(gst_buffer_list_get(maps, i), 0, &level, sizeof level);
        later.emplace_back(GST_BUFFER_PTS(gst_buffer_list_get(maps, i)) / GST_MSECOND, level);
      }
    gst_buffer_unref(frame);
    return levels;
  }
  using Later = std::vector<std::pair<GstClockTime, gfloat>>;
  Later later; ///< ms after the frame's time, and the first cell, of the frame that pull() took
  std::optional<tactile::TactileMap> added; ///< by the sound, to the frame that pull() took

private:
  static std::vector<GstEvent *> beginning(GstCaps *caps, GstClockTime base)
  {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.base = base;
    return { gst_event_new_stream_start("next"), gst_event_new_caps(caps),
             gst_event_new_segment(&segment) };
  }

  /// The track's streaming thread, as the element blocks on a buffer until the film gets there.
  /// Ends at an item that is neither buffer nor event.
  void feed()
  {
    for (gpointer next = nullptr; (next = g_async_queue_pop(to_push_)) != this;)
      if (GST_IS_EVENT(next))
        gst_harness_push_event(track, GST_EVENT(next));
      else if (GST_IS_QUERY(next)) {
        gst_pad_peer_query(track->srcpad, GST_QUERY(next));
        gst_query_unref(GST_QUERY(next));
      } else
        flows.insert(gst_harness_push(track, GST_BUFFER(next)));
  }

  GstElement *element_;
  guint64 next_ = 0;
  GAsyncQueue *to_push_ = g_async_queue_new();
  std::thread feeder_;

public:
  GstHarness *video;
  GstHarness *track;
  std::set<GstFlowReturn> flows; ///< what answered the track's buffers; after stop_feeding()
};

void
wait_for_the_end(Combiner &c)
{
  GstEventType type = GST_EVENT_UNKNOWN;
  while (type != GST_EVENT_EOS) {
    g_autoptr(GstEvent) event = gst_harness_pull_event(c.video);
    fail_unless(event != nullptr, "the film does not end");
    type = GST_EVENT_TYPE(event);
  }
}

/// GstAggregator before 1.24 takes another stream only after a flush.
bool
gst_begins_again()
{
  guint major = 0, minor = 0, micro = 0, nano = 0;
  gst_version(&major, &minor, &micro, &nano);
  return minor >= 24;
}

#define ASSERT_LEVELS(combiner, ...)                                                               \
  do {                                                                                             \
    const std::vector<gfloat> expected = __VA_ARGS__;                                              \
    fail_unless((combiner).pull() == expected);                                                    \
  } while (0)

} // namespace

CHECK_TEST(test_map_at_the_frames_beginning)
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

/// What begins or ends within a frame, also of a film at twice the speed.
CHECK_TEST(test_maps_within_a_frame)
{
  for (const char *mix : { "replace", "max", "gate" })
    for (const double rate : { 1.0, 2.0 }) {
      Combiner c;
      c.set("mix", mix);
      GstSegment segment;
      gst_segment_init(&segment, GST_FORMAT_TIME);
      segment.rate = rate;
      for (GstHarness *h : { c.video, c.track })
        fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
      c.push_map(0.5F, 0, 10);
      c.push_map(1, 24, 60);
      c.push_map(0.75F, 62, 64);
      c.end_track();
      const bool has_own = mix != std::string("replace");
      for (const guint i : { 0U, 1U, 2U })
        c.push_frame(i, has_own ? 0.25F : -1);
      const gfloat silent = has_own ? 0.25F : 0;
      const bool splits = mix != std::string("gate");
      const auto text = [](const Combiner::Later &maps) {
        std::string all;
        for (const auto &[after, level] : maps)
          all += std::to_string(after) + ":" + std::to_string(level) + " ";
        return all;
      };
      const std::array<Combiner::Later, 2> expected{
        { { { 10, silent }, { 24, 1 } }, { { 20, silent }, { 22, 0.75F }, { 24, silent } } }
      };
      for (const Combiner::Later &maps : expected) {
        c.pull();
        fail_unless(c.later == (splits ? maps : Combiner::Later{}), "%s %g: %s", mix, rate,
                    text(c.later).c_str());
      }
      c.pull();
      fail_unless(c.later.empty());
    }
}

/// A map of one frame is on one frame of a film that runs backward, however fast.
CHECK_TEST(test_reverse)
{
  for (const double rate : { -1.0, -2.0, -0.5 }) {
    Combiner c;
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.rate = rate;
    segment.stop = segment.position = 10 * kFrame;
    for (GstHarness *h : { c.video, c.track })
      fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
    c.push_map(0.5F, 200, 240);
    c.end_track();
    for (const guint i : { 6U, 5U, 4U, 3U }) {
      c.push_frame(i);
      c.restart_times(i);
      ASSERT_LEVELS(c, { i == 5 ? 0.5F : 0, 0 });
    }
  }
}

/// The sound's maps are one with the picture's.
CHECK_TEST(test_sound_within_a_frame)
{
  Combiner c;
  c.push_map(0.5F, 0, 10, true);
  c.push_map(1, 10, 60, true);
  c.end_track();
  c.push_frame(0);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  fail_unless(c.later.empty());

  Combiner silent_first;
  silent_first.push_map(0, 0, 20);
  silent_first.push_map(1, 20, 60, true);
  silent_first.end_track();
  silent_first.push_frame(0);
  ASSERT_LEVELS(silent_first, { 0, 0 });
  fail_unless(silent_first.later.empty());
}

/// The film's own maps within a frame are mixed with the track's.
CHECK_TEST(test_own_maps_within_a_frame)
{
  for (const char *mix : { "replace", "max", "sum" }) {
    Combiner c;
    c.set("mix", mix);
    c.push_map(0.25F, 0, 20);
    c.push_map(0, 20, 40);
    c.end_track();
    GstBuffer *frame = gst_buffer_new_allocate(nullptr, 64, nullptr);
    GST_BUFFER_PTS(frame) = 0;
    GST_BUFFER_DURATION(frame) = kFrame;
    const std::array<gfloat, 2> levels{};
    gst_buffer_add_tactile_meta(frame, 1, 2, levels.data(), 2);
    tactile::TactileMap own(1, 2);
    own.levels[0] = 0.5F;
    const std::array<LaterMap, 2> own_later{ LaterMap{ std::chrono::milliseconds(10), own },
                                             LaterMap{ std::chrono::milliseconds(30),
                                                       tactile::TactileMap(1, 2) } };
    set_later_maps(frame, own_later);
    fail_unless_equals_int(gst_harness_push(c.video, frame), GST_FLOW_OK);
    ASSERT_LEVELS(c, { 0.25F, 0 });
    const gfloat both = mix == std::string("sum") ? 0.75F : 0.5F;
    if (mix == std::string("replace"))
      fail_unless(c.later == (Combiner::Later{ { 20, 0 } }));
    else
      fail_unless(c.later == (Combiner::Later{ { 10, both }, { 20, 0.5F }, { 30, 0 } }));
  }
}

CHECK_TEST(test_frequency)
{
  Combiner c;
  const gfloat levels[] = { 0.5F, 0 };
  GstBuffer *map = gst_tactile_map_buffer_new(levels, 2);
  gst_buffer_set_tactile_frequency(map, 120);
  GST_BUFFER_PTS(map) = 0;
  GST_BUFFER_DURATION(map) = kFrame;
  c.push_raw(map);
  c.push_map(1, 40, 80);
  c.end_track();
  for (const gfloat expected : { 120.0F, 0.0F }) {
    c.push_frame(expected == 0 ? 1 : 0);
    GstBuffer *frame = gst_harness_pull(c.video);
    fail_unless_equals_float(gst_buffer_get_tactile_frequency(frame), expected);
    gst_buffer_unref(frame);
  }
}

CHECK_TEST(test_film_ends_first)
{
  Combiner c;
  c.push_map(0.5F, 0, 10'000);
  c.push_map(1, 10'000, 20'000);
  c.push_frame(0);
  ASSERT_LEVELS(c, { 0.5F, 0 });
  fail_unless(gst_harness_push_event(c.video, gst_event_new_eos()));
  wait_for_the_end(c);
}

/// A track of an hour, with serialized queries, does not wait for a film that has ended.
CHECK_TEST(test_longer_track)
{
  Combiner c;
  c.push_frame(0);
  for (guint64 i = 0; i < 3600; i++) {
    c.push_map(0.5F, i * 1000, (i + 1) * 1000);
    if (i % 10 == 5)
      c.push_query();
  }
  c.end_track();
  ASSERT_LEVELS(c, { 0.5F, 0 });
  fail_unless(gst_harness_push_event(c.video, gst_event_new_eos()));
  wait_for_the_end(c);
  c.stop_feeding();
  fail_unless(c.flows == std::set({ GST_FLOW_OK, GST_FLOW_EOS }));
}

/// A second film of the same combiner has its own track, whichever of both begins first.
CHECK_TEST(test_second_film)
{
  if (!gst_begins_again())
    return;
  for (const bool track_is_ahead : { false, true }) {
    Combiner c;
    c.push_map(0.5F, 0, 40);
    c.push_map(0.75F, 40, 80);
    if (track_is_ahead) {
      c.end_track();
      c.begin_track(10 * kFrame);
      c.push_map(1, 0, 40);
    }
    c.push_frame(0);
    ASSERT_LEVELS(c, { 0.5F, 0 });
    fail_unless(gst_harness_push_event(c.video, gst_event_new_eos()));
    wait_for_the_end(c);
    c.begin_film(10 * kFrame);
    if (!track_is_ahead) {
      c.begin_track(10 * kFrame);
      c.push_map(1, 0, 40);
    }
    c.end_track();
    c.push_frame(0);
    c.push_frame(1);
    c.restart_times();
    ASSERT_LEVELS(c, { 1, 0 });
    ASSERT_LEVELS(c, { 0, 0 });
  }
}

/// Sound and picture of different lengths, both ways, also from live sources.
CHECK_LOOP_TEST(test_lengths, 0, 4)
{
  constexpr const gchar *kSources[] = { "", "is-live=true" };
  const gchar *live = kSources[__i__ / 2];
  const bool sound_is_longer = __i__ % 2 == 0;
  g_autofree gchar *line = g_strdup_printf(
      "videotestsrc %s num-buffers=%d ! video/x-raw,width=32,height=24,framerate=30/1 "
      "! tactilecombiner name=c ! fakesink "
      "audiotestsrc %s wave=ticks num-buffers=%d ! soundtactile name=s s.src ! queue ! fakesink "
      "s.tactile ! queue max-size-buffers=4 ! c.tactile",
      live, sound_is_longer ? 10 : 40, live, sound_is_longer ? 100 : 10);
  g_autoptr(GError) error = nullptr;
  g_autoptr(GstElement) pipeline = gst_parse_launch(line, &error);
  fail_unless(error == nullptr, "%s", error != nullptr ? error->message : "");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless_equals_int(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}

CHECK_TEST(test_offset)
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

CHECK_TEST(test_gaps)
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

/// What was lost on the way does not end what is felt.
CHECK_TEST(test_map_holds_for_lost_data)
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

CHECK_TEST(test_map_without_duration_holds)
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

CHECK_TEST(test_frame_waits_for_the_track)
{
  Combiner c;
  c.push_map(0.5F, 0, 40);
  c.push_frame(0);
  ASSERT_LEVELS(c, { 0.5F, 0 }); // track known this far
  c.push_frame(1);               // but no further
  c.push_map(1, 40, 80);
  ASSERT_LEVELS(c, { 1, 0 });
}

CHECK_TEST(test_mix)
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

// The sum is at most 1; the gate gives the track's strength to the film's place.
CHECK_TEST(test_mix_of_sound)
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

// A frame tells what the sound added, and that it ended; a track that is no sound adds nothing.
CHECK_TEST(test_what_came_from_which)
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

CHECK_TEST(test_mix_of_grids)
{
  Combiner c;
  c.set("mix", "max");
  c.push_map(1, 0, 40);
  c.end_track();
  c.push_frame(0, 0.25F, 2, 4); // each cell of the track is two by two of the film's
  ASSERT_LEVELS(c, { 1, 1, 0.25F, 0.25F, 1, 1, 0.25F, 0.25F });
}

CHECK_TEST(test_without_a_track)
{
  Combiner none(false);
  none.push_frame(0, 0.5F);
  none.push_frame(1);
  ASSERT_LEVELS(none, { 0.5F, 0.5F });
  fail_unless(none.pull().empty());
}

CHECK_TEST(test_seek)
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

CHECK_TEST(test_wrong_size)
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

CHECK_MAIN(tactilecombiner)
