// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/klv.h"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include <string>
#include <vector>

using namespace std::chrono_literals;

namespace {

/// A packet of a transport stream: no duration.
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

/// Whether a decoder takes this element among others.
bool
is_found(GstRank rank)
{
  GstCaps *caps = gst_caps_from_string("meta/x-klv, parsed=true");
  GList *all = gst_element_factory_list_get_elements(GST_ELEMENT_FACTORY_TYPE_DECODABLE, rank);
  GList *found = gst_element_factory_list_filter(all, caps, GST_PAD_SINK, TRUE);
  bool is = false;
  for (GList *item = found; item; item = item->next)
    is |= g_str_equal(GST_OBJECT_NAME(item->data), "tactileklvdec");
  gst_plugin_feature_list_free(found);
  gst_plugin_feature_list_free(all);
  gst_caps_unref(caps);
  return is;
}

} // namespace

GST_START_TEST(test_text_comes_out)
{
  GstHarness *h = gst_harness_new("tactileklvdec");
  gst_harness_set_src_caps_str(h, "meta/x-klv, parsed=true");
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.75F), GST_SECOND)), GST_FLOW_OK);
  // Another's: nothing is made of it.
  fail_unless_equals_int(
      gst_harness_push(h, packet(std::vector<std::uint8_t>(40, 0xff), 2 * GST_SECOND)),
      GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_push(h, packet(map_of(0.5F), 3 * GST_SECOND)), GST_FLOW_OK);
  gst_harness_push_event(h, gst_event_new_eos());
  fail_unless_equals_uint64(gst_harness_buffers_received(h), 2);
  GstBuffer *cue = gst_harness_pull(h);
  fail_unless_equals_uint64(GST_BUFFER_PTS(cue), GST_SECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(cue), 400 * GST_MSECOND);
  GstMapInfo info;
  gst_buffer_map(cue, &info, GST_MAP_READ);
  fail_unless_equals_string(std::string(reinterpret_cast<char *>(info.data), info.size).c_str(),
                            " 75   0");
  gst_buffer_unmap(cue, &info);
  gst_buffer_unref(cue);
  GstCaps *caps = gst_pad_get_current_caps(h->sinkpad);
  fail_unless(gst_structure_has_name(gst_caps_get_structure(caps, 0), "text/x-raw"));
  gst_caps_unref(caps);
  gst_harness_teardown(h);
}
GST_END_TEST;

// KLV of others is not taken from whoever wants it, nor are numbers drawn by players that feel nothing.
GST_START_TEST(test_only_where_it_is_wanted)
{
  fail_unless(is_found(GST_RANK_NONE));
  fail_if(is_found(GST_RANK_MARGINAL));
}
GST_END_TEST;

static Suite *
tactileklvdec_suite(void)
{
  Suite *suite = suite_create("tactileklvdec");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_text_comes_out);
  tcase_add_test(tests, test_only_where_it_is_wanted);
  return suite;
}

GST_CHECK_MAIN(tactileklvdec)
