// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/klv.h"
#include "tracks/text_cue.h"

#include "support/contains.h"
#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

#include <optional>
#include <string>
#include <vector>

#include "support/check_tests.h"

using tactile::Cue;
using tactile::TactileMap;
using tactile::Time;

namespace {

constexpr const gchar *kMapCaps = "application/x-tactile-map,rows=2,columns=2,framerate=25/1";
constexpr const gchar *kTextCaps = "text/x-raw,format=utf8";
constexpr const gchar *kKlvCaps = "meta/x-klv,parsed=true";

TactileMap
make_map(int percent)
{
  TactileMap map(2, 2);
  map.levels = { 0, static_cast<float>(percent) / 100, 1, 0.25F };
  return map;
}

class Harness
{
public:
  Harness(const gchar *in, const gchar *out) : h(gst_harness_new("tactileconverter"))
  {
    if (out != nullptr)
      gst_harness_set_sink_caps_str(h, out == kMapCaps ? "application/x-tactile-map" : out);
    gst_harness_set_src_caps_str(h, in);
  }
  ~Harness()
  {
    gst_harness_teardown(h);
  }
  Harness(const Harness &) = delete;
  Harness &operator=(const Harness &) = delete;

  GstFlowReturn push(GstBuffer *buffer, GstClockTime pts, GstClockTime duration)
  {
    GST_BUFFER_PTS(buffer) = pts;
    GST_BUFFER_DURATION(buffer) = duration;
    return gst_harness_push(h, buffer);
  }
  GstFlowReturn push_map(const TactileMap &map, GstClockTime pts, GstClockTime duration)
  {
    return push(gst_tactile_map_buffer_new(map.levels.data(), map.levels.size()), pts, duration);
  }
  GstFlowReturn push_text(const std::string &text, GstClockTime pts, GstClockTime duration)
  {
    return push(text.empty() ? gst_buffer_new() : gst_buffer_new_memdup(text.data(), text.size()),
                pts, duration);
  }

  /// The next buffer as a cue, parsed as `caps`, or none.
  std::optional<Cue> pull(const gchar *caps)
  {
    GstBuffer *buffer = gst_harness_try_pull(h);
    if (buffer == nullptr)
      return std::nullopt;
    Cue cue;
    GstMapInfo info;
    gst_buffer_map(buffer, &info, GST_MAP_READ);
    if (caps == kTextCaps)
      cue.map = *tactile::read_text_cue({ reinterpret_cast<char *>(info.data), info.size },
                                        std::nullopt);
    else if (caps == kKlvCaps)
      cue = *tactile::read_klv({ info.data, info.size });
    else
      cue.map = read_map(buffer);
    gst_buffer_unmap(buffer, &info);
    cue.begin = Time(static_cast<Time::rep>(GST_BUFFER_PTS(buffer)));
    cue.end = cue.begin + Time(static_cast<Time::rep>(GST_BUFFER_DURATION(buffer)));
    gst_buffer_unref(buffer);
    return cue;
  }

  /// Names of the events since the last call. Gaps are followed by their time and duration in ms,
  /// caps of maps by their grid.
  std::string events()
  {
    std::string names;
    while (GstEvent *event = gst_harness_try_pull_event(h)) {
      names += names.empty() ? "" : " ";
      names += GST_EVENT_TYPE_NAME(event);
      if (GST_EVENT_TYPE(event) == GST_EVENT_GAP) {
        GstClockTime begin = 0;
        GstClockTime duration = 0;
        gst_event_parse_gap(event, &begin, &duration);
        names += ":" + std::to_string(begin / GST_MSECOND) + "+"
                 + std::to_string(duration / GST_MSECOND);
      } else if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
        GstCaps *caps = nullptr;
        guint rows = 0;
        guint columns = 0;
        gst_event_parse_caps(event, &caps);
        if (gst_tactile_map_caps_parse(caps, &rows, &columns, nullptr, nullptr))
          names += ":" + std::to_string(rows) + "x" + std::to_string(columns);
      }
      gst_event_unref(event);
    }
    return names;
  }

private:
  static TactileMap read_map(GstBuffer *buffer)
  {
    gfloat *levels = nullptr;
    gsize count = 0;
    TactileMap map(2, 2);
    fail_unless(gst_tactile_map_buffer_get_levels(buffer, 2, 2, &levels, &count));
    map.levels.assign(levels, levels + count);
    g_free(levels);
    return map;
  }

public:
  GstHarness *h;
};

/// Converts maps at 25 frames a second. Each is repeated for the given number of frames.
std::vector<Cue>
convert_maps(const gchar *caps, const std::vector<std::pair<int, int>> &percent_and_frames)
{
  Harness converter(kMapCaps, caps);
  GstClockTime time = 0;
  std::vector<Cue> cues;
  for (const auto &[percent, frames] : percent_and_frames)
    for (int i = 0; i < frames; i++, time += 40 * GST_MSECOND)
      fail_unless_equals_int(converter.push_map(make_map(percent), time, 40 * GST_MSECOND),
                             GST_FLOW_OK);
  gst_harness_push_event(converter.h, gst_event_new_eos());
  while (const std::optional<Cue> cue = converter.pull(caps))
    cues.push_back(*cue);
  return cues;
}

#define ASSERT_EVENTS(converter, expected)                                                         \
  do {                                                                                             \
    const std::string came = (converter).events();                                                 \
    fail_unless_equals_string(came.c_str(), expected);                                             \
  } while (0)

} // namespace

CHECK_TEST(test_cues_on_change_and_every_second)
{
  using namespace std::chrono_literals;
  const std::vector<Cue> expected = { { 0s, 200ms, make_map(50) },
                                      { 200ms, 1200ms, make_map(75) },
                                      { 1200ms, 2200ms, make_map(75) },
                                      { 2200ms, 2600ms, make_map(75) },
                                      { 2600ms, 2640ms, make_map(0) } };
  const std::vector<std::pair<int, int>> film = { { 50, 5 }, { 75, 60 }, { 0, 1 } };
  fail_unless(convert_maps(kTextCaps, film) == expected);
  fail_unless(convert_maps(kKlvCaps, film) == expected);
}

CHECK_TEST(test_changes_within_a_percent)
{
  using namespace std::chrono_literals;
  Harness converter(kMapCaps, kTextCaps);
  for (guint i = 0; i < 4; i++) {
    TactileMap map = make_map(50);
    map.levels[1] += i % 2 == 0 ? 0.004F : -0.004F;
    converter.push_map(map, i * 40 * GST_MSECOND, 40 * GST_MSECOND);
  }
  gst_harness_push_event(converter.h, gst_event_new_eos());
  const Cue cue{ 0s, 160ms, make_map(50) };
  fail_unless(converter.pull(kTextCaps) == cue);
  fail_if(converter.pull(kTextCaps).has_value());
}

CHECK_TEST(test_round_trip)
{
  for (const gchar *between : { kTextCaps, kKlvCaps }) {
    Harness there(kMapCaps, between);
    Harness back(between, kMapCaps);
    const GstClockTime frame = GST_SECOND / 30; // a third of a nanosecond too short
    for (guint i = 0; i < 90; i++)
      there.push_map(make_map(static_cast<int>(i / 7 % 101)), i * GST_SECOND / 30, frame);
    gst_harness_push_event(there.h, gst_event_new_eos());
    while (GstBuffer *buffer = gst_harness_try_pull(there.h))
      fail_unless_equals_int(gst_harness_push(back.h, buffer), GST_FLOW_OK);
    // Each frame's map is that of the cue during which it begins, and there are no gaps.
    std::optional<Cue> cue = back.pull(kMapCaps);
    for (guint i = 0; i < 90; i++) {
      const Time time(static_cast<Time::rep>(i * GST_SECOND / 30));
      while (cue && cue->end <= time)
        cue = back.pull(kMapCaps);
      fail_unless(cue && cue->begin <= time, "frame %u is in a gap", i);
      fail_unless(cue->map == make_map(static_cast<int>(i / 7 % 101)), "frame %u", i);
    }
    ASSERT_EVENTS(back, "stream-start caps:2x2 segment");
  }
}

CHECK_TEST(test_frequencies)
{
  constexpr const gchar *kCue = "  0  50\n100  25\n120 Hz";
  Harness to_map(kTextCaps, kMapCaps);
  fail_unless_equals_int(to_map.push_text(kCue, 0, GST_SECOND), GST_FLOW_OK);
  GstBuffer *map = gst_harness_pull(to_map.h);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(map), 120);
  for (const gchar *caps : { kTextCaps, kKlvCaps }) {
    Harness back(kMapCaps, caps);
    fail_unless_equals_int(back.push(gst_buffer_copy(map), 0, GST_SECOND), GST_FLOW_OK);
    gst_harness_push_event(back.h, gst_event_new_eos());
    GstBuffer *cue = gst_harness_pull(back.h);
    GstMapInfo info;
    gst_buffer_map(cue, &info, GST_MAP_READ);
    if (caps == kTextCaps)
      fail_unless(std::string(reinterpret_cast<char *>(info.data), info.size) == kCue);
    else
      fail_unless_equals_float(tactile::read_klv({ info.data, info.size })->map.frequency, 120);
    gst_buffer_unmap(cue, &info);
    gst_buffer_unref(cue);
  }
  gst_buffer_unref(map);
}

CHECK_TEST(test_gaps_of_a_track)
{
  Harness converter(kTextCaps, kMapCaps);
  converter.push_text("0 50\n100 25", GST_SECOND, 400 * GST_MSECOND);
  ASSERT_EVENTS(converter, "stream-start caps:2x2 segment gap:0+1000");
  converter.push_text("0 75\n100 25", 1400 * GST_MSECOND, 100 * GST_MSECOND); // adjacent
  ASSERT_EVENTS(converter, "");
  gst_harness_push_event(converter.h, gst_event_new_gap(1450 * GST_MSECOND, 150 * GST_MSECOND));
  ASSERT_EVENTS(converter, "gap:1500+100");
  converter.push_text("0 75\n100 25", 2 * GST_SECOND, GST_SECOND);
  ASSERT_EVENTS(converter, "gap:1600+400");
  const Cue first{ std::chrono::seconds(1), std::chrono::milliseconds(1400), make_map(50) };
  fail_unless(converter.pull(kMapCaps) == first);
  fail_unless(gst_harness_push_event(converter.h, gst_event_new_eos()));
  ASSERT_EVENTS(converter, "eos");
}

CHECK_TEST(test_gap_of_maps_ends_a_cue)
{
  using namespace std::chrono_literals;
  Harness converter(kMapCaps, kTextCaps);
  converter.push_map(make_map(50), 0, 100 * GST_MSECOND);
  gst_harness_push_event(converter.h, gst_event_new_gap(100 * GST_MSECOND, 200 * GST_MSECOND));
  const Cue cue{ 0s, 100ms, make_map(50) };
  fail_unless(converter.pull(kTextCaps) == cue);
  ASSERT_EVENTS(converter, "stream-start caps segment gap:100+200");
}

CHECK_TEST(test_text_variants)
{
  // A cue as containers and editors change it.
  for (const gchar *caps : { "text/x-raw,format=utf8", "text/x-raw,format=pango-markup" })
    for (const std::string &text :
         { std::string("  0  50\n100  25"), std::string("0% 50%\r\n100% 25%\r\n"),
           std::string("0 50\n100 25\0", 13) }) {
      Harness converter(caps, kMapCaps);
      converter.push_text(text, 0, GST_SECOND);
      const std::optional<Cue> cue = converter.pull(kMapCaps);
      fail_unless(cue && cue->map == make_map(50));
    }
  // Once the grid is known, a lost line break does no harm.
  Harness converter(kTextCaps, kMapCaps);
  converter.push_text("0 50\n100 25", 0, GST_SECOND);
  converter.push_text("0 75 100 25", GST_SECOND, GST_SECOND);
  converter.pull(kMapCaps);
  const std::optional<Cue> cue = converter.pull(kMapCaps);
  fail_unless(cue && cue->map == make_map(75));
}

CHECK_TEST(test_ordinary_subtitles)
{
  Harness converter(kTextCaps, kMapCaps);
  const ElementBus messages(converter.h->element);
  fail_unless_equals_int(converter.push_text("Who's there?", GST_SECOND, GST_SECOND), GST_FLOW_OK);
  const Said said = messages.said(GST_MESSAGE_WARNING);
  assert_contains(said.text + " " + said.details, { "'Who's'" });
  fail_unless_equals_int(converter.push_text("", 2 * GST_SECOND, GST_SECOND), GST_FLOW_OK);
  fail_if(messages.has(GST_MESSAGE_WARNING)); // only once
  fail_if(converter.pull(kMapCaps).has_value());
  converter.push_text("0 50\n100 25", 4 * GST_SECOND, GST_SECOND);
  ASSERT_EVENTS(converter, "stream-start caps:2x2 segment gap:0+4000");
}

CHECK_TEST(test_hostile_klv)
{
  Harness converter(kKlvCaps, kMapCaps);
  for (guint size = 1; size < 40; size++)
    fail_unless_equals_int(
        converter.push(gst_buffer_new_memdup(std::string(size, '\xff').data(), size), 0,
                       GST_CLOCK_TIME_NONE),
        GST_FLOW_OK);
  fail_if(converter.pull(kMapCaps).has_value());
}

CHECK_TEST(test_durations)
{
  using namespace std::chrono_literals;
  // Transport streams lose the buffer's duration, but the packet has its own.
  Harness klv(kKlvCaps, kMapCaps);
  const std::vector<std::uint8_t> bytes = tactile::write_klv(make_map(50), 300ms);
  klv.push(gst_buffer_new_memdup(bytes.data(), bytes.size()), GST_SECOND, GST_CLOCK_TIME_NONE);
  const Cue expected{ 1s, 1300ms, make_map(50) };
  fail_unless(klv.pull(kMapCaps) == expected);
  // Streams of maps may lack durations, too.
  Harness maps(kMapCaps, kTextCaps);
  maps.push_map(make_map(50), 0, GST_CLOCK_TIME_NONE);
  gst_harness_push_event(maps.h, gst_event_new_eos());
  const Cue frame{ 0s, 40ms, make_map(50) };
  fail_unless(maps.pull(kTextCaps) == frame);
}

CHECK_TEST(test_negotiation)
{
  const auto out = [](const gchar *in, const gchar *takes) {
    Harness converter(in, takes);
    if (in == kMapCaps)
      converter.push_map(make_map(50), 0, GST_SECOND);
    else
      converter.push_text("0 50\n100 25", 0, GST_SECOND);
    gst_harness_push_event(converter.h, gst_event_new_eos());
    GstCaps *caps = gst_pad_get_current_caps(converter.h->sinkpad);
    const std::string name = gst_structure_get_name(gst_caps_get_structure(caps, 0));
    gst_caps_unref(caps);
    return name;
  };
  fail_unless(out(kMapCaps, nullptr) == "text/x-raw");
  fail_unless(out(kMapCaps, "application/x-tactile-map; text/x-raw") == "text/x-raw");
  fail_unless(out(kMapCaps, "application/x-tactile-map; meta/x-klv") == "meta/x-klv");
  fail_unless(out(kMapCaps, "application/x-tactile-map") == "application/x-tactile-map");
  fail_unless(out(kTextCaps, nullptr) == "application/x-tactile-map");
  fail_unless(out(kTextCaps, "meta/x-klv,parsed=true") == "meta/x-klv");
  fail_unless(out(kTextCaps, "text/x-raw") == "text/x-raw");
}

CHECK_TEST(test_maps_pass)
{
  Harness converter(kMapCaps, "application/x-tactile-map");
  TactileMap map = make_map(50);
  map.levels[1] = 0.123456F; // not rounded
  converter.push_map(map, 5 * GST_SECOND, 40 * GST_MSECOND);
  const std::optional<Cue> cue = converter.pull(kMapCaps);
  fail_unless(cue && cue->map == map);
  ASSERT_EVENTS(converter, "stream-start caps:2x2 segment");
}

CHECK_TEST(test_seek)
{
  Harness converter(kMapCaps, kTextCaps);
  converter.push_map(make_map(50), 0, 40 * GST_MSECOND);
  gst_harness_push_event(converter.h, gst_event_new_flush_start());
  gst_harness_push_event(converter.h, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = 10 * GST_SECOND;
  gst_harness_push_event(converter.h, gst_event_new_segment(&segment));
  converter.push_map(make_map(75), 10 * GST_SECOND, 40 * GST_MSECOND);
  gst_harness_push_event(converter.h, gst_event_new_eos());
  const std::optional<Cue> cue = converter.pull(kTextCaps);
  fail_unless(cue && cue->begin == std::chrono::seconds(10)); // nothing from before the seek
  fail_if(converter.pull(kTextCaps).has_value());
}

CHECK_TEST(test_latency)
{
  for (const bool to_text : { true, false }) {
    Harness converter(to_text ? kMapCaps : kTextCaps, to_text ? kTextCaps : kMapCaps);
    gst_harness_set_upstream_latency(converter.h, 70 * GST_MSECOND);
    fail_unless_equals_uint64(gst_harness_query_latency(converter.h),
                              (to_text ? GST_SECOND : 0) + 70 * GST_MSECOND);
  }
}

CHECK_TEST(test_empty_track)
{
  Harness converter(kTextCaps, "application/x-tactile-map,rows=4,columns=6");
  fail_unless(gst_harness_push_event(converter.h, gst_event_new_eos()));
  ASSERT_EVENTS(converter, "stream-start caps:4x6 segment eos");
}

CHECK_MAIN(tactileconverter)
