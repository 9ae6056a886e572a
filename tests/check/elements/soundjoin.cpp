// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What joins the sound's maps to the picture's: where the picture has a gap, and before the
// pipeline's zero.
#include "visuotactile/soundjoin.h"

#include "gst/fusion/pipeline_sound.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <memory>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include <gst/check/gstharness.h>

namespace {

using fusion::Time;

constexpr guint kRows = 3;
constexpr guint kColumns = 3;

Time
ms(int count)
{
  return std::chrono::milliseconds(count);
}

struct Felt
{
  GstClockTime begin;
  GstClockTime end;
  gfloat level; ///< the largest
};

/// The element, and a sound that is heard beside it.
class Join
{
public:
  /// Position 0 is at `zero` of the running time.
  explicit Join(Time zero = Time(0))
      : element_(gst_sound_join_new("sound")),
        harness_(gst_harness_new_with_element(element_, "sink", "src")),
        maps_(sound_maps_of(element_))
  {
    gst_harness_set_src_caps_str(harness_,
                                 "application/x-tactile-map,rows=3,columns=3,framerate=10/1");
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.offset = static_cast<guint64>(std::max(-zero, Time(0)).count());
    gst_harness_push_event(harness_, gst_event_new_segment(&segment));
  }
  ~Join()
  {
    maps_->hear(this, false);
    gst_harness_teardown(harness_);
  }
  Join(const Join &) = delete;
  Join &operator=(const Join &) = delete;

  /// In running time.
  void hear(Time begin, Time end)
  {
    maps_->hear(this, true);
    tactile::TactileMap map(1, 1);
    map.levels = { 0.8F };
    maps_->add(this, { begin, end, map });
  }
  void push_silent(int begin, int end)
  {
    const std::vector<gfloat> levels(kRows * kColumns);
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = static_cast<GstClockTime>(ms(begin).count());
    GST_BUFFER_DURATION(map) = static_cast<GstClockTime>(ms(end - begin).count());
    fail_unless_equals_int(gst_harness_push(harness_, map), GST_FLOW_OK);
  }
  void push_gap(int begin, int end, GstGapFlags flags = {})
  {
    GstEvent *gap = gst_event_new_gap(static_cast<GstClockTime>(ms(begin).count()),
                                      static_cast<GstClockTime>(ms(end - begin).count()));
    gst_event_set_gap_flags(gap, flags);
    fail_unless(gst_harness_push_event(harness_, gap));
  }
  /// What came after all of it has passed.
  std::vector<Felt> felt()
  {
    fail_unless(gst_harness_push_event(harness_, gst_event_new_eos()));
    std::vector<Felt> all;
    while (GstBuffer *map = gst_harness_try_pull(harness_)) {
      g_autofree gfloat *levels = nullptr;
      gsize count = 0;
      fail_unless(gst_tactile_map_buffer_get_levels(map, kRows, kColumns, &levels, &count));
      all.push_back({ GST_BUFFER_PTS(map), GST_BUFFER_PTS(map) + GST_BUFFER_DURATION(map),
                      *std::max_element(levels, levels + count) });
      gst_buffer_unref(map);
    }
    return all;
  }
  int gaps()
  {
    int count = 0;
    while (GstEvent *event = gst_harness_try_pull_event(harness_)) {
      count += GST_EVENT_TYPE(event) == GST_EVENT_GAP;
      gst_event_unref(event);
    }
    return count;
  }

private:
  GstElement *element_;
  GstHarness *harness_;
  std::shared_ptr<fusion::SoundMaps> maps_;
};

/// Maps without holes from `begin` to `end`, which are felt from `on` to `off` alone, in ms.
void
assert_felt(const std::vector<Felt> &felt, int begin, int end, int on, int off)
{
  const auto at = [](int time) {
    return static_cast<GstClockTime>(ms(time).count());
  };
  fail_if(felt.empty(), "nothing came");
  fail_unless_equals_clocktime(felt.front().begin, at(begin));
  fail_unless_equals_clocktime(felt.back().end, at(end));
  GstClockTime until = at(begin);
  GstClockTime sounds = 0;
  for (const Felt &map : felt) {
    fail_unless_equals_clocktime(map.begin, until);
    until = map.end;
    const bool is_on = map.level > 0;
    fail_unless(!is_on || (map.begin >= at(on) && map.end <= at(off)),
                "felt from %" GST_TIME_FORMAT " to %" GST_TIME_FORMAT, GST_TIME_ARGS(map.begin),
                GST_TIME_ARGS(map.end));
    sounds += is_on ? map.end - map.begin : 0;
  }
  fail_unless_equals_clocktime(sounds, at(off - on));
}

} // namespace

// A gap of the picture has sound, and is one where none is heard.
CHECK_TEST(test_gap)
{
  Join heard;
  heard.hear(ms(250), ms(300));
  heard.push_gap(200, 300);
  assert_felt(heard.felt(), 200, 300, 250, 300);
  fail_unless_equals_int(heard.gaps(), 0);

  Join unheard;
  unheard.push_gap(200, 300);
  fail_unless(unheard.felt().empty());
  fail_unless_equals_int(unheard.gaps(), 1);
}

// What was lost on the way is no silence of the picture: tactorsink keeps the map before it.
CHECK_TEST(test_lost_data_are_no_gap)
{
  Join join;
  join.hear(ms(250), ms(300));
  join.push_silent(100, 200);
  join.push_gap(200, 300, GST_GAP_FLAG_MISSING_DATA);
  const std::vector<Felt> felt = join.felt();
  fail_unless_equals_int(static_cast<int>(felt.size()), 1);
  fail_unless_equals_clocktime(felt.back().end, static_cast<GstClockTime>(ms(200).count()));
  fail_unless_equals_int(join.gaps(), 1);
}

// A pad's offset puts the film's first second before the pipeline's zero.
CHECK_TEST(test_before_zero)
{
  Join join(ms(-1000));
  join.hear(ms(-750), ms(-700));
  join.push_silent(200, 300);
  assert_felt(join.felt(), 200, 300, 250, 300);

  Join gap(ms(-1000));
  gap.hear(ms(-750), ms(-700));
  gap.push_gap(200, 300);
  assert_felt(gap.felt(), 200, 300, 250, 300);

  Join across(ms(-250));
  across.hear(ms(0), ms(50));
  across.push_silent(200, 300);
  assert_felt(across.felt(), 200, 300, 250, 300);
}

CHECK_MAIN(soundjoin)
