// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactileoverlay on pictures that are rotated or flipped after it: on the screen the map looks as
// if drawn there.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/check_tests.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

namespace {

constexpr int kWidth = 90;
constexpr int kHeight = 60;
constexpr const gchar *kCaps = "video/x-raw,format=GRAY8,width=90,height=60,framerate=30/1";
constexpr std::array<const gchar *, 8> kTags
    = { "rotate-0",      "rotate-90",      "rotate-180",      "rotate-270",
        "flip-rotate-0", "flip-rotate-90", "flip-rotate-180", "flip-rotate-270" };

/// Where a frame comes to tactileoverlay it gets 2 × 3 levels: videoflip drops or turns a map.
GstPadProbeReturn
add_levels(GstPad *, GstPadProbeInfo *info, gpointer)
{
  constexpr std::array<gfloat, 6> kLevels{ 0, 0.2F, 1, 0.4F, 0.8F, 0.1F };
  GstBuffer *frame = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  gst_buffer_add_tactile_meta(frame, 2, 3, kLevels.data(), kLevels.size());
  GST_PAD_PROBE_INFO_DATA(info) = frame;
  return GST_PAD_PROBE_OK;
}

/// The picture after these elements, without the padding of its rows.
std::vector<int>
picture_after(const std::string &line, const gchar *tag)
{
  GstHarness *h = gst_harness_new_parse(line.c_str());
  g_autoptr(GstElement) overlay = gst_bin_get_by_name(GST_BIN(h->element), "draw");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(overlay, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, add_levels, nullptr, nullptr);
  gst_harness_set_src_caps_str(h, kCaps);
  gst_harness_push_event(
      h, gst_event_new_tag(gst_tag_list_new(GST_TAG_IMAGE_ORIENTATION, tag, nullptr)));
  const int stride = GST_ROUND_UP_4(kWidth);
  GstBuffer *frame
      = gst_buffer_new_allocate(nullptr, static_cast<gsize>(stride) * kHeight, nullptr);
  GstMapInfo map;
  fail_unless(gst_buffer_map(frame, &map, GST_MAP_WRITE));
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < stride; x++)
      map.data[y * stride + x] = static_cast<guint8>(40 + x + y);
  gst_buffer_unmap(frame, &map);

  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, frame);
  fail_unless(out != nullptr);
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(h->sinkpad);
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  int width = 0;
  int height = 0;
  fail_unless(gst_structure_get(structure, "width", G_TYPE_INT, &width, "height", G_TYPE_INT,
                                &height, nullptr));
  std::vector<int> pixels{ width, height };
  fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      pixels.push_back(map.data[y * GST_ROUND_UP_4(width) + x]);
  gst_buffer_unmap(out, &map);
  gst_harness_teardown(h);
  return pixels;
}

/// The largest difference of two pictures. Interpolation from the other end rounds differently.
int
difference(const std::vector<int> &one, const std::vector<int> &other)
{
  ck_assert_uint_eq(one.size(), other.size());
  ck_assert_int_eq(one[0], other[0]);
  int most = 0;
  for (std::size_t i = 0; i < one.size(); i++)
    most = std::max(most, std::abs(one[i] - other[i]));
  return most;
}

} // namespace

/// Drawing on the stored picture, then rotating it, equals drawing on the rotated picture.
CHECK_LOOP_TEST(test_drawn_and_turned, 0, kTags.size())
{
  const gchar *tag = kTags[static_cast<std::size_t>(__i__)];
  const std::string draw = "tactileoverlay name=draw style=heatmap opacity=1 ";
  const std::string turn = "videoflip video-direction=auto";
  const std::vector<int> expected
      = picture_after(turn + " ! " + draw + "video-direction=identity", tag);
  const std::vector<int> drawn_first = picture_after(draw + " ! " + turn, tag);
  fail_unless(difference(drawn_first, expected) <= 2, "%s: %d", tag,
              difference(drawn_first, expected));
  const bool turned = __i__ > 0;
  const std::vector<int> untold = picture_after(draw + "video-direction=identity ! " + turn, tag);
  fail_unless((difference(untold, expected) > 20) == turned);
}

CHECK_MAIN(tactileoverlay_orientation)
