// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactilesubtitles with frames and subtitles. tests/tools/players.sh tests that players choose it.
#include "gst/fusion/later_maps.h"
#include "tracks/klv.h"

#include <string>
#include <vector>

#include "support/check_tests.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

namespace {

constexpr const gchar *kVideoCaps = "video/x-raw,format=I420,width=160,height=120,framerate=25/1";
constexpr gsize kFrameSize = 160 * 120 * 3 / 2;
constexpr GstClockTime kFrame = 40 * GST_MSECOND;

/// The element with a harness for the film and one for its subtitles.
class Subtitles
{
public:
  explicit Subtitles(const gchar *format = "utf8")
      : element_(gst_element_factory_make("tactilesubtitles", nullptr)),
        film(gst_harness_new_with_element(element_, "video_sink", "src")),
        text(gst_harness_new_with_element(element_, "text_sink", nullptr))
  {
    gst_harness_set_src_caps_str(film, kVideoCaps);
    gst_harness_set_src_caps(
        text, gst_caps_new_simple("text/x-raw", "format", G_TYPE_STRING, format, nullptr));
  }
  ~Subtitles()
  {
    gst_harness_teardown(text);
    gst_harness_teardown(film);
    gst_object_unref(element_);
  }
  Subtitles(const Subtitles &) = delete;
  Subtitles &operator=(const Subtitles &) = delete;

  /// Pushes a cue, times in ms.
  void push_cue(const std::string &words, GstClockTime begin, GstClockTime end)
  {
    GstBuffer *cue = gst_buffer_new_memdup(words.data(), words.size());
    GST_BUFFER_PTS(cue) = begin * GST_MSECOND;
    if (end > begin)
      GST_BUFFER_DURATION(cue) = (end - begin) * GST_MSECOND;
    fail_unless_equals_int(gst_harness_push(text, cue), GST_FLOW_OK);
  }

  /// Pushes a black frame at a time in ms and returns the output.
  GstBuffer *play_frame(GstClockTime time, GstClockTime duration = kFrame)
  {
    GstBuffer *frame = gst_buffer_new_allocate(nullptr, kFrameSize, nullptr);
    gst_buffer_memset(frame, 0, 0, kFrameSize);
    GST_BUFFER_PTS(frame) = time * GST_MSECOND;
    GST_BUFFER_DURATION(frame) = duration;
    fail_unless_equals_int(gst_harness_push(film, frame), GST_FLOW_OK);
    return gst_harness_pull(film);
  }

  /// The levels of that frame in percent, none without a map.
  std::vector<int> levels_at(GstClockTime time)
  {
    g_autoptr(GstBuffer) frame = play_frame(time);
    std::vector<int> percents;
    if (const GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame)) {
      gsize n = 0;
      const gfloat *levels = gst_tactile_meta_get_levels(meta, &n);
      for (gsize i = 0; i < n; i++)
        percents.push_back(static_cast<int>(levels[i] * 100 + 0.5F));
    }
    return percents;
  }

  /// Whether anything is drawn on that frame.
  bool draws_at(GstClockTime time)
  {
    g_autoptr(GstBuffer) frame = play_frame(time);
    std::vector<guint8> bytes(kFrameSize);
    gst_buffer_extract(frame, 0, bytes.data(), bytes.size());
    for (gsize i = 0; i < 160 * 120; i++)
      if (bytes[i] > 100)
        return true;
    return false;
  }

  /// Where the element posts its messages.
  GstBus *bus()
  {
    GstBus *bus = gst_bus_new();
    gst_element_set_bus(element_, bus);
    return bus;
  }

private:
  GstElement *element_;

public:
  GstHarness *film;
  GstHarness *text;
};

using Levels = std::vector<int>;

} // namespace

/// Each frame gets the map of the cue during which it begins, else a silent one. Nothing is drawn.
CHECK_TEST(test_track)
{
  Subtitles s;
  fail_unless(s.levels_at(0) == Levels{}); // nothing is known yet
  s.push_cue("10 20\n30 40\n", 40, 80);
  s.push_cue(" 50%  0\n  0  0\n", 80, 160);
  s.push_cue("1 2\n3 4", 240, 0); // one second without an end
  fail_unless(s.levels_at(40) == (Levels{ 10, 20, 30, 40 }));
  fail_unless(s.levels_at(80) == (Levels{ 50, 0, 0, 0 }));
  fail_if(s.draws_at(120));
  fail_unless(s.levels_at(160) == (Levels{ 0, 0, 0, 0 }));
  fail_unless(s.levels_at(240) == (Levels{ 1, 2, 3, 4 }));
  fail_unless(s.levels_at(1220) == (Levels{ 1, 2, 3, 4 }));
  fail_unless(s.levels_at(1240) == (Levels{ 0, 0, 0, 0 }));
}

/// A cue without a frame does not block. Later cues still apply at their own times.
CHECK_TEST(test_late_cue)
{
  Subtitles s;
  s.push_cue("1", 0, 40);
  fail_unless(s.levels_at(200) == Levels{ 0 });
  s.push_cue("2", 40, 400);
  fail_unless(s.levels_at(240) == Levels{ 2 });
}

/// Subtitles that begin with words are drawn, including numbers. Frames get no map.
CHECK_TEST(test_words)
{
  Subtitles s("pango-markup");
  s.push_cue("Who is there?", 0, 400);
  fail_unless(s.draws_at(40));
  fail_unless(s.levels_at(80) == Levels{});
  fail_if(s.draws_at(440)); // makes it release the first cue
  s.push_cue("42", 800, 1200);
  fail_unless(s.draws_at(840));
  fail_unless(s.levels_at(880) == Levels{});
}

/// Words within a track are drawn.
CHECK_TEST(test_remark)
{
  Subtitles s;
  s.push_cue("1 2", 0, 40);
  fail_unless(s.levels_at(0) == (Levels{ 1, 2 }));
  s.push_cue("louder?", 40, 400);
  fail_unless(s.draws_at(80));
  fail_unless(s.levels_at(120) == (Levels{ 0, 0 }));
}

/// What tactile-track refuses is not drawn, and warned of once.
CHECK_TEST(test_fault)
{
  for (const char *fault : { "1 101", "1 2 3\n4", "1 O", "2nd impact", "1,2" }) {
    Subtitles s;
    g_autoptr(GstBus) bus = s.bus();
    s.push_cue("1 2", 0, 40);
    s.push_cue(fault, 40, 400);
    s.push_cue(fault, 400, 500);
    fail_unless(s.levels_at(0) == (Levels{ 1, 2 }));
    fail_if(s.draws_at(80), "%s is drawn", fault);
    fail_unless(s.levels_at(120) == (Levels{ 0, 0 }));
    g_autoptr(GstMessage) warning = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
    g_autoptr(GstMessage) second = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
    fail_unless(warning != nullptr && second == nullptr, "%s", fault);
  }
}

/// Gaps with packets, as from tactileklvdec, are cues with the packets' durations.
CHECK_TEST(test_packets)
{
  Subtitles s;
  tactile::TactileMap map(1, 2);
  map.levels = { 0.25F, 0.75F };
  const std::vector<std::uint8_t> bytes = tactile::write_klv(map, std::chrono::milliseconds(2000));
  g_autoptr(GstBuffer) packet = gst_buffer_new_memdup(bytes.data(), bytes.size());
  GST_BUFFER_PTS(packet) = 40 * GST_MSECOND;
  GstEvent *gap = gst_event_new_gap(40 * GST_MSECOND, GST_CLOCK_TIME_NONE);
  gst_structure_set(gst_event_writable_structure(gap), "tactile-packet", GST_TYPE_BUFFER, packet,
                    nullptr);
  fail_unless(gst_harness_push_event(s.text, gst_event_new_gap(0, GST_CLOCK_TIME_NONE)));
  fail_unless(s.levels_at(0) == Levels{}); // a gap without a packet
  fail_unless(gst_harness_push_event(s.text, gap));
  fail_unless(s.levels_at(40) == (Levels{ 25, 75 }));
  fail_unless(s.levels_at(2000) == (Levels{ 25, 75 }));
  fail_unless(s.levels_at(2040) == (Levels{ 0, 0 }));
}

/// Times are running times: the track's segment may differ from the film's.
CHECK_TEST(test_segments)
{
  Subtitles s;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.time = 10 * GST_SECOND;
  gst_harness_push_event(s.text, gst_event_new_segment(&segment));
  s.push_cue("9", 9000, 9900); // before the segment
  s.push_cue("1", 9960, 10040);
  s.push_cue("2", 10040, 10080);
  fail_unless(s.levels_at(0) == Levels{ 1 });
  fail_unless(s.levels_at(40) == Levels{ 2 });
  fail_unless(s.levels_at(80) == Levels{ 0 });
}

namespace {

/// A track of 150 frames, in ms. Some cues are adjacent, others are followed by a break of one or
/// more frames.
struct TimedLevel
{
  GstClockTime begin;
  GstClockTime end;
  int percent;
};
constexpr TimedLevel kTrack[] = {
  { 200, 1000, 11 },
  { 1000, 1040, 12 },
  { 1040, 2000, 13 },
  { 2200, 2600, 14 },
  // Ends late, as from rounded times
  { 2600, 3401, 15 },
  { 3400, 4000, 16 },
  { 4000, 5800, 17 },
};
constexpr GstClockTime kFilmEnd = 6000;

int
percent_of_track_at(GstClockTime time)
{
  int percent = 0;
  for (const TimedLevel &cue : kTrack)
    if (cue.begin <= time && time < cue.end)
      percent = cue.percent;
  return percent;
}

/// Plays the film at a rate with its cues in this order, and counts the frames whose level is not
/// the track's.
int
frames_unlike_track(gdouble rate, const std::vector<std::size_t> &order)
{
  Subtitles s;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = rate;
  segment.stop = kFilmEnd * GST_MSECOND;
  segment.position = rate < 0 ? segment.stop : 0;
  gst_harness_push_event(s.film, gst_event_new_segment(&segment));
  gst_harness_push_event(s.text, gst_event_new_segment(&segment));
  for (const std::size_t i : order)
    s.push_cue(std::to_string(kTrack[i].percent), kTrack[i].begin, kTrack[i].end);

  int unlike = 0;
  for (GstClockTime passed = 0; passed < kFilmEnd; passed += 40) {
    const GstClockTime time = rate < 0 ? kFilmEnd - 40 - passed : passed;
    unlike += s.levels_at(time) == Levels{ percent_of_track_at(time) } ? 0 : 1;
  }
  return unlike;
}

} // namespace

/// At any rate, forwards and backwards, each frame has the track's level at its time.
CHECK_LOOP_TEST(test_rates, 0, 5)
{
  const gdouble rates[] = { 1, -1, -0.3, -1.5, -7 };
  const gdouble rate = rates[__i__];
  const std::vector<std::size_t> forwards = { 0, 1, 2, 3, 4, 5, 6 };
  const std::vector<std::size_t> backwards = { 6, 5, 4, 3, 2, 1, 0 };
  // Demuxers go back from key frame to key frame, and play forwards from each.
  const std::vector<std::size_t> in_groups = { 5, 6, 2, 3, 4, 0, 1 };
  if (rate > 0) {
    ck_assert_int_eq(frames_unlike_track(rate, forwards), 0);
    return;
  }
  ck_assert_int_eq(frames_unlike_track(rate, backwards), 0);
  ck_assert_int_eq(frames_unlike_track(rate, in_groups), 0);
}

/// A flush discards cues. A new stream starts without assumptions.
CHECK_TEST(test_flush_and_other_subtitles)
{
  Subtitles s;
  s.push_cue("1", 0, 40);
  s.push_cue("2", 40, 4000);
  fail_unless(s.levels_at(0) == Levels{ 1 });
  gst_harness_push_event(s.text, gst_event_new_flush_start());
  gst_harness_push_event(s.text, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(s.text, gst_event_new_segment(&segment));
  fail_unless(s.levels_at(40) == Levels{ 0 });
  gst_harness_push_event(s.text, gst_event_new_stream_start("others"));
  fail_unless(s.levels_at(80) == Levels{});
  s.push_cue("Hello", 80, 800);
  fail_unless(s.levels_at(120) == Levels{});
}

namespace {

/// Of a transport stream whose clock began 740 ms before its first picture, played from the
/// beginning or from a position that the player shows.
void
begin_at(GstHarness *harness, const gchar *stream, GstClockTime ms)
{
  if (stream)
    gst_harness_push_event(harness, gst_event_new_stream_start(stream));
  else {
    gst_harness_push_event(harness, gst_event_new_flush_start());
    gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  }
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.time = segment.position = ms * GST_MSECOND;
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
}

} // namespace

/// A track beside a film counts from the film's 0:00, also after a seek, by which players send it
/// to the time that they show, 740 ms from there.
CHECK_TEST(test_track_beside_a_clocked_film)
{
  Subtitles s;
  begin_at(s.film, "film:1/00000041", 740);
  begin_at(s.text, "track", 0);
  s.push_cue("10", 1000, 1400);
  s.push_cue("20", 5000, 5400);
  fail_unless(s.levels_at(740) == Levels{ 0 });
  fail_unless(s.levels_at(1700) == Levels{ 0 });
  fail_unless(s.levels_at(1740) == Levels{ 10 });
  fail_unless(s.levels_at(2100) == Levels{ 10 });
  fail_unless(s.levels_at(2140) == Levels{ 0 });

  begin_at(s.text, nullptr, 5000);
  begin_at(s.film, nullptr, 5000);
  s.push_cue("20", 5000, 5400);
  fail_unless(s.levels_at(5040) == Levels{ 0 }); // 4.3 s of the film
  fail_unless(s.levels_at(5700) == Levels{ 0 });
  fail_unless(s.levels_at(5740) == Levels{ 20 });
  fail_unless(s.levels_at(6100) == Levels{ 20 });
  fail_unless(s.levels_at(6140) == Levels{ 0 });

  // A cue that has begun where the track begins, within a frame.
  begin_at(s.text, nullptr, 5000);
  begin_at(s.film, nullptr, 5000);
  s.push_cue("20", 4900, 5400);
  g_autoptr(GstBuffer) before = s.play_frame(5720);
  fail_unless(later_maps(before) == nullptr);
  fail_unless(s.levels_at(5760) == Levels{ 20 });
}

/// One in its file has the times of its frames.
CHECK_TEST(test_track_in_a_clocked_film)
{
  Subtitles s;
  begin_at(s.film, "film:1/00000041", 740);
  begin_at(s.text, "film:1/00000050", 740);
  s.push_cue("10", 1740, 2140);
  fail_unless(s.levels_at(1700) == Levels{ 0 });
  fail_unless(s.levels_at(1740) == Levels{ 10 });
  begin_at(s.text, nullptr, 5000);
  begin_at(s.film, nullptr, 5000);
  s.push_cue("20", 5000, 5400);
  fail_unless(s.levels_at(5000) == Levels{ 20 });
}

/// The chair gets what begins or ends within a frame at its own time.
CHECK_TEST(test_cues_within_a_frame)
{
  Subtitles subtitles;
  subtitles.push_cue("50 0", 90, 110);
  subtitles.push_cue("75 0", 112, 130);
  g_autoptr(GstBuffer) frame = subtitles.play_frame(80);
  GstBufferList *later = later_maps(frame);
  fail_unless(later != nullptr);
  std::string felt;
  for (guint i = 0; i < gst_buffer_list_length(later); i++) {
    gfloat level = 0;
    gst_buffer_extract(gst_buffer_list_get(later, i), 0, &level, sizeof level);
    felt += std::to_string(GST_BUFFER_PTS(gst_buffer_list_get(later, i)) / GST_MSECOND) + ":"
            + std::to_string(static_cast<int>(level * 100 + 0.5F)) + " ";
  }
  ck_assert_str_eq(felt.c_str(), "10:50 30:0 32:75 ");
  g_autoptr(GstBuffer) next = subtitles.play_frame(120);
  fail_unless_equals_int(gst_buffer_list_length(later_maps(next)), 1);
}

/// By the frame rate.
CHECK_TEST(test_frame_without_a_duration)
{
  Subtitles subtitles;
  subtitles.push_cue("50", 10, 30);
  g_autoptr(GstBuffer) frame = subtitles.play_frame(0, GST_CLOCK_TIME_NONE);
  fail_unless_equals_int(gst_buffer_list_length(later_maps(frame)), 2);
}

/// A still picture has a thousand maps, and no motor stays on after them. Among cues that overlap
/// the track's later one counts.
CHECK_TEST(test_many_cues_within_a_frame)
{
  Subtitles subtitles;
  subtitles.push_cue("9", 0, 360'000'000);
  for (GstClockTime i = 1; i <= 2000; i++)
    subtitles.push_cue("50", 2 * i, 2 * i + 1);
  g_autoptr(GstBuffer) frame = subtitles.play_frame(0, 3 * GST_SECOND);
  const std::vector<LaterMap> later = read_later_maps(frame);
  fail_unless_equals_int(later.size(), 1000);
  for (std::size_t i = 0; i < later.size(); i++) {
    fail_unless(later[i].after == std::chrono::milliseconds(2 + i));
    const float level = i == 999 ? 0 : i % 2 == 0 ? 0.5F : 0.09F;
    fail_unless_equals_float(later[i].map.levels[0], level);
  }
  fail_unless(subtitles.levels_at(3000) == Levels{ 50 });
  fail_unless(subtitles.levels_at(4001) == Levels{ 9 });
}

CHECK_MAIN(tactilesubtitles)
