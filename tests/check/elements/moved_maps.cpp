// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Elements that move the picture move its tactile map along, or drop it. Each cell of the frame
// that goes in is as bright as its level is high, so the picture that comes out says what its map
// is.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gst/fusion/later_maps.h"
#include "gst/fusion/sound_meta.h"

#include "support/check_tests.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

namespace {

constexpr int kSide = 96;
constexpr guint kRows = 2;
constexpr guint kColumns = 3;
constexpr std::array<gfloat, 6> kLevels{ 0, 0.25F, 0.5F, 0.75F, 1, 0.125F };
constexpr const char *kCaps = "video/x-raw,format=I420,width=96,height=96,framerate=25/1,"
                              "pixel-aspect-ratio=1/1,interlace-mode=progressive";

GstBuffer *
frame()
{
  GstBuffer *frame = gst_buffer_new_allocate(nullptr, kSide * kSide * 3 / 2, nullptr);
  gst_buffer_memset(frame, 0, 128, -1);
  std::vector<guint8> luma;
  for (int y = 0; y < kSide; y++)
    for (int x = 0; x < kSide; x++) {
      const std::size_t cell
          = static_cast<std::size_t>(y / 48) * kColumns + static_cast<std::size_t>(x / 32);
      luma.push_back(static_cast<guint8>(std::lround(16 + 219 * kLevels.at(cell))));
    }
  gst_buffer_fill(frame, 0, luma.data(), luma.size());
  GST_BUFFER_PTS(frame) = 0;
  GST_BUFFER_DURATION(frame) = 40 * GST_MSECOND;
  return frame;
}

/// The mean brightness of each cell of a picture. Borders have to be as wide as cells.
std::vector<gfloat>
seen(GstHarness *h, GstBuffer *picture)
{
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(h->sinkpad);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  GstVideoFrame mapped;
  fail_unless(gst_video_frame_map(&mapped, &info, picture, GST_MAP_READ));
  std::vector<gfloat> means(std::size_t{ kRows } * kColumns);
  const auto width = static_cast<std::size_t>(GST_VIDEO_FRAME_WIDTH(&mapped));
  const auto height = static_cast<std::size_t>(GST_VIDEO_FRAME_HEIGHT(&mapped));
  const auto *luma = static_cast<const guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&mapped, 0));
  for (std::size_t y = 0; y < height; y++)
    for (std::size_t x = 0; x < width; x++) {
      const guint8 value
          = luma[y * static_cast<std::size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&mapped, 0)) + x];
      means[y * kRows / height * kColumns + x * kColumns / width]
          += std::max(0.0F, (static_cast<gfloat>(value) - 16) / 219)
             / static_cast<gfloat>(width * height / means.size());
    }
  gst_video_frame_unmap(&mapped);
  return means;
}

std::string
text(const std::vector<gfloat> &levels)
{
  std::string all;
  for (const gfloat level : levels)
    all += (all.empty() ? "" : " ") + std::to_string(level);
  return all;
}

bool
moves_maps()
{
  guint major = 0, minor = 0, micro = 0, nano = 0;
  gst_version(&major, &minor, &micro, &nano);
  return minor >= 28;
}

void
assert_felt_as_seen(GstHarness *h, GstBuffer *picture, const char *name)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(picture);
  if (meta == nullptr) {
    fail_if(moves_maps(), "%s: the map is gone", name);
    fail_if(has_sound_meta(picture));
    fail_unless(later_maps(picture) == nullptr);
    fail_if(gst_buffer_get_saliency_meta(picture) != nullptr);
    return;
  }
  ck_assert_uint_eq(meta->rows, kRows);
  ck_assert_uint_eq(meta->columns, kColumns);
  const std::vector<gfloat> felt{ meta->levels, meta->levels + kLevels.size() };
  const std::vector<gfloat> expected = seen(h, picture);
  for (std::size_t i = 0; i < felt.size(); i++)
    fail_unless(std::abs(felt[i] - expected[i]) < 0.03F, "%s: felt %s, seen %s", name,
                text(felt).c_str(), text(expected).c_str());
  const auto added = sound_meta(picture, kRows, kColumns);
  fail_unless(added.has_value(), "%s: what the sound added is gone", name);
  GstBufferList *later = later_maps(picture);
  fail_unless(later != nullptr, "%s: the maps within the frame are gone", name);
  std::vector<gfloat> levels(felt.size());
  gst_buffer_extract(gst_buffer_list_get(later, 0), 0, levels.data(),
                     levels.size() * sizeof(gfloat));
  for (std::size_t i = 0; i < felt.size(); i++)
    fail_unless(std::abs(felt[i] - levels[i]) < 1e-5F);
  const GstSaliencyMeta *saliency = gst_buffer_get_saliency_meta(picture);
  fail_unless(saliency != nullptr, "%s: the saliency map is gone", name);
  for (std::size_t i = 0; i < felt.size(); i++) {
    fail_unless(std::abs(felt[i] - added->levels[i]) < 1e-5F);
    if (saliency->height == kRows)
      fail_unless(std::abs(felt[i] - saliency->values[i]) < 1e-5F);
  }
}

GstBuffer *
through(GstHarness *h)
{
  gst_harness_set_src_caps_str(h, kCaps);
  GstBuffer *in = frame();
  gst_buffer_add_tactile_meta(in, kRows, kColumns, kLevels.data(), kLevels.size());
  gst_buffer_add_saliency_meta(in, kColumns, kRows, kLevels.data(), kLevels.size(), 0);
  tactile::TactileMap added(kRows, kColumns);
  added.levels.assign(kLevels.begin(), kLevels.end());
  add_sound_meta(in, added);
  const LaterMap later{ std::chrono::milliseconds(1), added };
  set_later_maps(in, { &later, 1 });
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  gst_harness_push_event(h, gst_event_new_eos());
  return gst_harness_pull(h);
}

constexpr const char *kElements[] = {
  "videoflip video-direction=identity",
  "videoflip video-direction=90r",
  "videoflip video-direction=180",
  "videoflip video-direction=90l",
  "videoflip video-direction=horiz",
  "videoflip video-direction=vert",
  "videoflip video-direction=ul-lr",
  "videoflip video-direction=ur-ll",
  "videocrop left=48",
  "videocrop top=48 right=48",
  "videobox left=-48",
  "videobox left=48 top=48",
  "videobox left=64 right=-64 bottom=-96",
  "videoflip video-direction=180 ! videocrop left=48 ! videobox top=-96",
};

} // namespace

CHECK_LOOP_TEST(test_elements, 0, std::size(kElements))
{
  const char *name = kElements[__i__];
  GstHarness *h = gst_harness_new_parse(name);
  GstBuffer *out = through(h);
  fail_unless(out != nullptr);
  assert_felt_as_seen(h, out, name);
  gst_buffer_unref(out);
  gst_harness_teardown(h);
}

/// Scaled, a picture keeps its map on each version. With borders, 1.28 says where the picture is.
CHECK_TEST(test_scalers)
{
  for (const char *scaled : { "width=48,height=48", "width=120,height=90,pixel-aspect-ratio=3/4",
                              "width=288,height=96,pixel-aspect-ratio=1/1" }) {
    const std::string line
        = "videoconvertscale ! video/x-raw," + std::string(scaled) + " ! identity";
    GstHarness *h = gst_harness_new_parse(line.c_str());
    GstBuffer *out = through(h);
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(out);
    fail_unless(meta != nullptr, "%s", scaled);
    if (moves_maps())
      assert_felt_as_seen(h, out, scaled);
    else
      fail_unless(std::equal(kLevels.begin(), kLevels.end(), meta->levels));
    gst_buffer_unref(out);
    gst_harness_teardown(h);
  }
}

CHECK_TEST(test_compositor)
{
  GstElement *compositor = gst_element_factory_make("compositor", nullptr);
  gst_util_set_object_arg(G_OBJECT(compositor), "background", "black");
  GstHarness *h = gst_harness_new_with_element(compositor, "sink_%u", "src");
  gst_harness_set_sink_caps_str(h, "video/x-raw,format=I420,width=144,height=192,framerate=25/1");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(compositor, "sink_0");
  g_object_set(pad, "xpos", 48, "ypos", 96, nullptr);
  GstBuffer *out = through(h);
  assert_felt_as_seen(h, out, "compositor");
  gst_buffer_unref(out);
  gst_harness_teardown(h);
  gst_object_unref(compositor);
}

/// What no element moves stays.
CHECK_TEST(test_kept)
{
  for (const char *kept : { "queue", "identity",
                            "videoconvert ! video/x-raw,format=RGB ! videoconvert ! "
                            "video/x-raw,format=I420 ! identity",
                            "videorate ! video/x-raw,framerate=50/1 ! identity",
                            "videobalance saturation=0.5", "tactileextractor" }) {
    GstHarness *h = gst_harness_new_parse(kept);
    GstBuffer *out = through(h);
    fail_unless(gst_buffer_get_tactile_meta(out) != nullptr, "%s: the map is gone", kept);
    assert_felt_as_seen(h, out, kept);
    gst_buffer_unref(out);
    gst_harness_teardown(h);
  }
}

CHECK_MAIN(moved_maps)
