// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Pictures that are rotated or flipped for display: the grid is the viewer's. Compared with
// GStreamer's videoflip, which moves the pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "saliencytactile_rig.h"

#include "support/check_tests.h"

namespace {

struct Way
{
  const char *direction; ///< value of video-direction
  const char *tag;       ///< value of image-orientation
};
constexpr std::array<Way, 8> kWays = { { { "identity", "rotate-0" },
                                         { "90r", "rotate-90" },
                                         { "180", "rotate-180" },
                                         { "90l", "rotate-270" },
                                         { "horiz", "flip-rotate-0" },
                                         { "ur-ll", "flip-rotate-90" },
                                         { "vert", "flip-rotate-180" },
                                         { "ul-lr", "flip-rotate-270" } } };

constexpr const char *kGrids[] = { "rows=3 columns=3", "rows=2 columns=5", "rows=4 columns=1" };

/// The size of a picture and the place where a square appears.
struct Scene
{
  int width;
  int height;
  int x;
  int y;
};
// No orientation maps these places onto each other. Some sizes are multiples of the saliency map's
// samples, others are not.
constexpr Scene kScenes[] = { { 320, 240, 40, 20 }, { 256, 256, 208, 30 }, { 250, 334, 20, 240 } };

std::string
caps_of(const Scene &scene)
{
  return "video/x-raw,format=GRAY8,framerate=30/1,width=" + std::to_string(scene.width)
         + ",height=" + std::to_string(scene.height);
}

/// Gray, with a lighter square from the 12th frame on.
GstBuffer *
scene_frame(const Scene &scene, guint i)
{
  g_autoptr(GstCaps) caps = gst_caps_from_string(caps_of(scene).c_str());
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  GstBuffer *buffer = flat_frame(GST_VIDEO_INFO_SIZE(&info), 110);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE));
  const int x = scene.x + 3 * (static_cast<int>(i) - 14); // it moves, so it is felt to the end
  for (int row = 0; i >= 12 && row < kBall; row++)
    for (int column = 0; column < kBall; column++)
      static_cast<guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(
          &frame, 0))[(scene.y + row) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0) + x + column]
          = 140;
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(buffer) = i * GST_SECOND / 30;
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
  return buffer;
}

void
push_tag(Analysis &analysis, const char *orientation, GstTagScope scope = GST_TAG_SCOPE_STREAM)
{
  GstTagList *tags = orientation ? gst_tag_list_new(GST_TAG_IMAGE_ORIENTATION, orientation, nullptr)
                                 : gst_tag_list_new(GST_TAG_TITLE, "no orientation", nullptr);
  gst_tag_list_set_scope(tags, scope);
  fail_unless(gst_harness_push_event(analysis.h, gst_event_new_tag(tags)));
}

/// The levels of a scene's last frame.
std::vector<gfloat>
play(const std::string &line, const Scene &scene, const char *tag = nullptr)
{
  Analysis analysis(line, caps_of(scene).c_str());
  if (tag)
    push_tag(analysis, tag);
  std::vector<gfloat> levels;
  for (guint i = 0; i < 16; i++)
    levels = analysis.felt(scene_frame(scene, i));
  return levels;
}

/// The largest difference between two maps of the same size.
gfloat
difference(const std::vector<gfloat> &one, const std::vector<gfloat> &other)
{
  ck_assert_uint_eq(one.size(), other.size());
  gfloat most = 0;
  for (std::size_t i = 0; i < one.size(); i++)
    most = std::max(most, std::abs(one[i] - other[i]));
  return most;
}

/// The strongest cell of a 3 × 3 grid after events.
class Player
{
public:
  Player() : analysis("saliencytactile", caps_of(kScenes[0]).c_str())
  {
  }
  /// The square is stored in the top left.
  std::size_t strongest_of_next()
  {
    analysis.flush();
    std::vector<gfloat> levels;
    for (guint i = 0; i < 16; i++)
      levels = analysis.felt(scene_frame(kScenes[0], i));
    return strongest(levels);
  }

  Analysis analysis;
};

} // namespace

/// A picture with a tag or the property has the map of the same picture after videoflip. Pyramids
/// sample every 2ⁿth pixel from the left and top. So a flipped picture's samples are up to one
/// sample off, which is 4 to 8 of 240 pixels. For a square of 24 pixels near a cell's border this
/// changes its level by up to 9 %. A wrong orientation changes it entirely.
CHECK_LOOP_TEST(test_as_if_turned, 0, kWays.size())
{
  const Way &way = kWays[static_cast<std::size_t>(__i__)];
  for (const Scene &scene : kScenes)
    for (const char *grid : kGrids) {
      const std::string analysis = std::string("saliencytactile ") + grid;
      const std::vector<gfloat> turned = play(
          std::string("videoflip video-direction=") + way.direction + " ! " + analysis, scene);
      const gfloat peak = turned[strongest(turned)];
      fail_unless(peak > 0.3f);
      const std::vector<gfloat> tagged = play(analysis, scene, way.tag);
      const std::vector<gfloat> set
          = play(analysis + " video-direction=" + way.direction, scene, "rotate-180");
      fail_unless(set == tagged, "%s: the property's map differs from the tag's", way.direction);
      ck_assert_uint_eq(strongest(tagged), strongest(turned));
      fail_unless(difference(tagged, turned) < 0.15f * peak, "%s, %s, %d x %d: %g", way.direction,
                  grid, scene.width, scene.height, difference(tagged, turned));
    }
}

/// A stream's tag overrides the file's global tag. Both survive flushes, until other tags or
/// another stream come.
CHECK_TEST(test_tags)
{
  Player player;
  ck_assert_uint_eq(player.strongest_of_next(), 0);
  push_tag(player.analysis, "rotate-90", GST_TAG_SCOPE_GLOBAL);
  ck_assert_uint_eq(player.strongest_of_next(), 2);
  ck_assert_uint_eq(player.strongest_of_next(), 2);
  push_tag(player.analysis, "rotate-180", GST_TAG_SCOPE_STREAM);
  ck_assert_uint_eq(player.strongest_of_next(), 8);
  push_tag(player.analysis, "rotate-270", GST_TAG_SCOPE_GLOBAL);
  ck_assert_uint_eq(player.strongest_of_next(), 8);
  push_tag(player.analysis, nullptr, GST_TAG_SCOPE_STREAM);
  ck_assert_uint_eq(player.strongest_of_next(), 6);
  g_object_set(player.analysis.element, "video-direction", GST_VIDEO_ORIENTATION_IDENTITY, nullptr);
  ck_assert_uint_eq(player.strongest_of_next(), 0);
  g_object_set(player.analysis.element, "video-direction", GST_VIDEO_ORIENTATION_AUTO, nullptr);
  ck_assert_uint_eq(player.strongest_of_next(), 6);
  fail_unless(gst_harness_push_event(player.analysis.h, gst_event_new_stream_start("another")));
  ck_assert_uint_eq(player.strongest_of_next(), 0);
}

/// A tag within the stream applies from the next frame on, also if that frame is not analyzed.
CHECK_TEST(test_tag_within_the_stream)
{
  Analysis analysis("saliencytactile max-rate=1", caps_of(kScenes[0]).c_str());
  for (guint i = 0; i < 30; i++)
    analysis.felt(scene_frame(kScenes[0], i / 2));
  analysis.flush();
  for (guint i = 0; i < 12; i++)
    analysis.felt(scene_frame(kScenes[0], i));
  g_object_set(analysis.element, "max-rate", 0.0, nullptr);
  ck_assert_uint_eq(strongest(analysis.felt(scene_frame(kScenes[0], 12))), 0);
  g_object_set(analysis.element, "max-rate", 1.0, nullptr);
  analysis.felt(scene_frame(kScenes[0], 13));
  push_tag(analysis, "rotate-90");
  ck_assert_uint_eq(strongest(analysis.felt(scene_frame(kScenes[0], 14))), 2);
}

/// A designer's map is in the viewer's orientation already.
CHECK_TEST(test_kept_maps)
{
  Analysis analysis("saliencytactile keep-maps=true", caps_of(kScenes[0]).c_str());
  push_tag(analysis, "rotate-90");
  const std::vector<gfloat> levels = { 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f };
  GstBuffer *frame = scene_frame(kScenes[0], 0);
  gst_buffer_add_tactile_meta(frame, 2, 3, levels.data(), levels.size());
  fail_unless(analysis.felt(frame) == levels);
}

CHECK_MAIN(saliencytactile_orientation)
