// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/klv.h"

#include "support/check_tests.h"
#include <gst/check/gstharness.h>

#include <vector>

using namespace std::chrono_literals;

namespace {

/// A packet of a transport stream, without a duration.
GstBuffer *
packet(const std::vector<std::uint8_t> &bytes, GstClockTime pts)
{
  GstBuffer *buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  GST_BUFFER_PTS(buffer) = pts;
  return buffer;
}

std::vector<std::uint8_t>
map_of(float level)
{
  tactile::TactileMap map(1, 2);
  map.levels = { level, 0 };
  return tactile::write_klv(map, 400ms);
}

/// The GAP events and the packets in them.
struct Gaps
{
  std::vector<GstClockTime> times;
  std::vector<gsize> packets; ///< bytes, 0 without a packet
};

Gaps
pull_gaps(GstHarness *h)
{
  Gaps gaps;
  while (GstEvent *event = gst_harness_try_pull_event(h)) {
    if (GST_EVENT_TYPE(event) == GST_EVENT_GAP) {
      GstClockTime begin = 0;
      gst_event_parse_gap(event, &begin, nullptr);
      gaps.times.push_back(begin);
      g_autoptr(GstBuffer) packet = nullptr;
      gst_structure_get(gst_event_get_structure(event), "tactile-packet", GST_TYPE_BUFFER, &packet,
                        nullptr);
      gaps.packets.push_back(packet ? gst_buffer_get_size(packet) : 0);
    }
    gst_event_unref(event);
  }
  return gaps;
}

} // namespace

// Players get gap events, so they have nothing to draw and do not wait. Elements that know them
// find the packets there.
CHECK_TEST(test_gaps_come_out)
{
  GstHarness *h = gst_harness_new("tactileklvdec");
  GstBus *bus = gst_bus_new();
  gst_element_set_bus(h->element, bus);
  gst_harness_set_src_caps_str(h, "meta/x-klv, parsed=true");
  const std::vector<std::uint8_t> others(40, 0xff);
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.5F), GST_SECOND)), GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_push(h, packet(others, 2 * GST_SECOND)), GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.5F), GST_CLOCK_TIME_NONE)),
                         GST_FLOW_OK); // without a time there is no gap
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(1), 3 * GST_SECOND)), GST_FLOW_OK);

  const Gaps gaps = pull_gaps(h);
  fail_unless(gaps.times
              == (std::vector<GstClockTime>{ GST_SECOND, 2 * GST_SECOND, 3 * GST_SECOND }));
  const gsize size = map_of(0).size();
  fail_unless(gaps.packets == (std::vector<gsize>{ size, 0, size }));
  fail_unless_equals_uint64(gst_harness_buffers_received(h), 0);
  fail_if(gst_bus_have_pending(bus), "unexpected message about other KLV");
  GstCaps *caps = gst_pad_get_current_caps(h->sinkpad);
  fail_unless(gst_structure_has_name(gst_caps_get_structure(caps, 0), "text/x-raw"));
  gst_caps_unref(caps);
  gst_element_set_bus(h->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(h);
}

// tactileconverter reads these subtitles like a track.
CHECK_TEST(test_track_is_read)
{
  GstHarness *h = gst_harness_new_parse("tactileklvdec ! tactileconverter");
  gst_harness_set_sink_caps_str(h, "application/x-tactile-map, rows=1, columns=2");
  gst_harness_set_src_caps_str(h, "meta/x-klv, parsed=true");
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.123F), GST_SECOND)), GST_FLOW_OK);
  GstBuffer *map = gst_harness_pull(h);
  fail_unless_equals_uint64(GST_BUFFER_PTS(map), GST_SECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(map), 400 * GST_MSECOND);
  const gfloat levels[] = { 0.123F, 0 };
  gst_check_buffer_data(map, levels, sizeof levels);
  gst_buffer_unref(map);
  gst_harness_teardown(h);
}

CHECK_TEST(test_conversion_to_text)
{
  GstHarness *h = gst_harness_new_parse("tactileklvdec ! tactileconverter");
  gst_harness_set_sink_caps_str(h, "text/x-raw, format=utf8");
  gst_harness_set_src_caps_str(h, "meta/x-klv, parsed=true");
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.75F), GST_SECOND)), GST_FLOW_OK);
  gst_harness_push_event(h, gst_event_new_eos());
  GstBuffer *cue = gst_harness_pull(h);
  fail_unless_equals_uint64(GST_BUFFER_PTS(cue), GST_SECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(cue), 400 * GST_MSECOND);
  gst_check_buffer_data(cue, " 75   0", 7);
  gst_buffer_unref(cue);
  gst_harness_teardown(h);
}

// Its default rank is enough for players and the discoverer to find it.
CHECK_TEST(test_is_found_by_caps)
{
  GstCaps *caps = gst_caps_from_string("meta/x-klv, parsed=true");
  GList *all = gst_element_factory_list_get_elements(GST_ELEMENT_FACTORY_TYPE_DECODABLE,
                                                     GST_RANK_MARGINAL);
  GList *found = gst_element_factory_list_filter(all, caps, GST_PAD_SINK, TRUE);
  bool is = false;
  for (GList *item = found; item; item = item->next)
    is |= g_str_equal(GST_OBJECT_NAME(item->data), "tactileklvdec");
  fail_unless(is);
  gst_plugin_feature_list_free(found);
  gst_plugin_feature_list_free(all);
  gst_caps_unref(caps);
}

CHECK_MAIN(tactileklvdec)
