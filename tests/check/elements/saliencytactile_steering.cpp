// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Settings that steer saliencytactile: roi-weights with upstream's regions, among them a real face
// detector's, viewport, max-cue-duration and cue-refractory. libs/region_weights,
// top_down_saliency, viewport and cue_limiter test what they compute.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "painted_frame.h"
#include "schematic_face.h"

#ifdef HAVE_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

#include "support/check_tests.h"

namespace {

/// Two squares that appear at the same time, left and right in the middle row, each with a region.
std::vector<gfloat>
squares_with_regions(const char *weights, const char *left_type, const char *right_type,
                     GstBuffer **last = nullptr)
{
  g_autofree gchar *line
      = g_strdup_printf("saliencytactile people=off attach-saliency=true %s", weights);
  Analysis analysis(line, kCaps);
  const Paint two = both(square(53, 120, 24), square(267, 120, 24));
  std::vector<gfloat> levels;
  for (guint i = 0; i < 16; i++) {
    GstBuffer *buffer = frame(i, i < 12 ? nothing : two);
    if (left_type)
      gst_buffer_add_video_region_of_interest_meta(buffer, left_type, 41, 108, 24, 24);
    if (right_type)
      gst_buffer_add_video_region_of_interest_meta(buffer, right_type, 255, 108, 24, 24);
    g_autoptr(GstBuffer) out = analysis.pass(buffer);
    levels = levels_of(out);
    if (last && i == 15)
      *last = gst_buffer_ref(out);
  }
  return levels;
}

} // namespace

/// A region of weight 0 never plays. One with a raised weight puts others below the threshold.
/// Types without a weight change nothing.
CHECK_TEST(test_weights)
{
  const std::vector<gfloat> plain = squares_with_regions("", "face", "logo");
  fail_unless(plain[3] > 0.3f && plain[5] > 0.3f);

  for (const char *unnamed : { "", "roi-weights=car=0", "roi-weights=face=1" })
    fail_unless(squares_with_regions(unnamed, "face", "logo") == plain);

  const std::vector<gfloat> no_logo
      = squares_with_regions("roi-weights=\"face=1,logo=0\"", "face", "logo");
  fail_unless(no_logo[3] > 0.3f && strongest(no_logo) == 3);
  fail_unless(no_logo[5] == 0 && no_logo[4] == 0 && no_logo[2] == 0 && no_logo[8] == 0);

  const std::vector<gfloat> face
      = squares_with_regions("roi-weights=\"logo=1,face=3\"", "face", "logo");
  fail_unless(strongest(face) == 3 && face[3] > plain[3] && face[5] == 0);

  fail_if(any(squares_with_regions("roi-weights=\"*=0\"", "face", "logo")));
  fail_unless(strongest(squares_with_regions("roi-weights=\"*=0,logo=1\"", "face", "logo")) == 5);
}

#ifdef HAVE_ANALYTICS
/// An object of GstAnalytics is a region, too, unless its tracker has lost it.
CHECK_TEST(test_analytics)
{
  const auto levels = [](bool is_tracked, bool is_lost) {
    Analysis analysis("saliencytactile roi-weights=logo=0", kCaps);
    const Paint two = both(square(53, 120, 24), square(267, 120, 24));
    std::vector<gfloat> last;
    for (guint i = 0; i < 16; i++) {
      GstBuffer *buffer = frame(i, i < 12 ? nothing : two);
      GstAnalyticsRelationMeta *meta = gst_buffer_add_analytics_relation_meta(buffer);
      GstAnalyticsODMtd object;
      GstAnalyticsTrackingMtd track;
      fail_unless(gst_analytics_relation_meta_add_od_mtd(meta, g_quark_from_static_string("logo"),
                                                         255, 108, 24, 24, 0.9F, &object));
      if (is_tracked) {
        fail_unless(gst_analytics_relation_meta_add_tracking_mtd(meta, 7, 0, &track));
        gst_analytics_relation_meta_set_relation(meta, GST_ANALYTICS_REL_TYPE_RELATE_TO, object.id,
                                                 track.id);
      }
      if (is_lost)
        gst_analytics_tracking_mtd_set_lost(&track);
      g_autoptr(GstBuffer) out = analysis.pass(buffer);
      last = levels_of(out);
    }
    return last;
  };
  for (const bool is_tracked : { false, true }) {
    const std::vector<gfloat> no_logo = levels(is_tracked, false);
    fail_unless(no_logo[3] > 0.3f && no_logo[5] == 0);
  }
  fail_unless(levels(true, true) == squares_with_regions("", nullptr, nullptr));
}
#endif

/// Weights apply to the attached saliency map, too.
CHECK_TEST(test_attached_map)
{
  const auto peaks = [](const char *weights) {
    GstBuffer *buffer = nullptr;
    squares_with_regions(weights, "face", "logo", &buffer);
    const GstSaliencyMeta *meta = gst_buffer_get_saliency_meta(buffer);
    fail_unless(meta != nullptr);
    gfloat left = 0;
    gfloat right = 0;
    for (guint y = 0; y < meta->height; y++)
      for (guint x = 0; x < meta->width; x++) {
        gfloat &side = x < meta->width / 2 ? left : right;
        side = std::max(side, meta->values[y * meta->width + x]);
      }
    gst_buffer_unref(buffer);
    return std::pair(left, right);
  };
  const auto [left, right] = peaks("");
  const auto [left_raised, right_lowered] = peaks("roi-weights=\"face=2,logo=0.25\"");
  fail_unless(left > 0 && right > 0);
  fail_unless(std::abs(left_raised - 2 * left) < 0.001f * left);
  fail_unless(std::abs(right_lowered - 0.25f * right) < 0.001f * right);
}

/// Regions are in pixels of the whole frame, also if it is cropped.
CHECK_TEST(test_regions_of_a_cropped_frame)
{
  for (const bool on_it : { true, false }) {
    Analysis analysis("saliencytactile roi-weights=\"logo=0\"", kCaps);
    std::vector<gfloat> levels;
    for (guint i = 0; i < 16; i++) {
      GstBuffer *buffer = frame(i, i < 12 ? Paint(nothing) : square(240, 180, 16));
      GstVideoCropMeta *crop = gst_buffer_add_video_crop_meta(buffer);
      crop->x = 160;
      crop->y = 120;
      crop->width = 160;
      crop->height = 120;
      // If counted from the crop's corner, each would be the other.
      gst_buffer_add_video_region_of_interest_meta(buffer, "logo", on_it ? 232 : 72,
                                                   on_it ? 172 : 52, 16, 16);
      levels = analysis.felt(buffer);
    }
    fail_unless(any(levels) == !on_it);
  }
}

/// A recent region still has effect, but not after a discontinuity.
CHECK_TEST(test_jump_forgets_regions)
{
  for (const bool jumps : { false, true }) {
    Analysis analysis("saliencytactile roi-weights=\"logo=0\"", kCaps);
    for (guint i = 0; i < 12; i++)
      analysis.felt(frame(i, Paint(nothing)));
    GstBuffer *with = frame(12, square(160, 120, 20));
    gst_buffer_add_video_region_of_interest_meta(with, "logo", 150, 110, 20, 20);
    fail_if(any(analysis.felt(with)));
    GstBuffer *gone = frame(13, Paint(nothing));
    if (jumps)
      GST_BUFFER_FLAG_SET(gone, GST_BUFFER_FLAG_DISCONT);
    fail_if(any(analysis.felt(gone)));
    fail_unless(any(analysis.felt(frame(14, square(160, 120, 20)))) == jumps);
  }
}

/// The synthetic film's own targets as regions of weight 0: its maps stay silent.
CHECK_TEST(test_targets_of_a_film)
{
  for (const char *pattern : { "static-motion", "dynamic-motion" }) {
    g_autofree gchar *line
        = g_strdup_printf("tactiletestsrc pattern=%s num-buffers=240 ! video/x-raw,format=I420,"
                          "width=320,height=240,framerate=30/1 ! "
                          "saliencytactile roi-weights=\"tactile-target=0\"",
                          pattern);
    Analysis analysis(line);
    gst_harness_play(analysis.h);
    for (int i = 0; i < 240; i++) {
      g_autoptr(GstBuffer) out = gst_harness_pull(analysis.h);
      fail_if(any(levels_of(out)), "%s: frame %d", pattern, i);
    }
  }
}

/// A real detector: OpenCV's from gst-plugins-bad, with the cascade of Debian's opencv-data. The
/// picture has a face and, at the same size and contrast, a face on its side, which the detector
/// does not find.
CHECK_TEST(test_face_detector)
{
  GstElementFactory *detector = gst_element_factory_find("facedetect");
  fail_unless(detector != nullptr, "there is no facedetect: run tools/setup.sh test");
  gst_object_unref(detector);

  constexpr double kHalfWidth = 25;
  const auto two_faces = [](int way) {
    return [=](int x, int y) {
      const double dx = (x + 0.5 - 53 - way) / kHalfWidth;
      const double dy = (y + 0.5 - 120 - way) / kHalfWidth;
      const double dx_other = (x + 0.5 - 267 - way) / kHalfWidth;
      return std::max(schematic_face_at(dx, dy), schematic_face_at(dy, dx_other));
    };
  };
  const auto play = [&](const char *weights, const std::function<void(GstBuffer *)> &each) {
    g_autofree gchar *line = g_strdup_printf(
        "facedetect display=false updates=none ! saliencytactile people=off %s", weights);
    Analysis analysis(line, kCaps);
    // Both appear and move along the diagonal, so both are felt to the end, and alike.
    for (guint i = 0; i < 30; i++) {
      const int way = 2 * (static_cast<int>(i) - 20);
      g_autoptr(GstBuffer) out
          = analysis.pass(frame(i, i < 12 ? Paint(nothing) : Paint(two_faces(way))));
      if (i >= 12)
        each(out);
    }
  };

  play("", [](GstBuffer *out) {
    gpointer state = nullptr;
    int faces = 0;
    while (GstMeta *meta = gst_buffer_iterate_meta_filtered(
               out, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
      const auto *region = reinterpret_cast<GstVideoRegionOfInterestMeta *>(meta);
      fail_unless_equals_string(g_quark_to_string(region->roi_type), "face");
      fail_unless(region->x + region->w < 120);
      faces++;
    }
    ck_assert_int_eq(faces, 1);
    const std::vector<gfloat> levels = levels_of(out);
    fail_unless(levels[3] > 0 && levels[5] > 0);
  });
  play("roi-weights=\"face=3\"", [](GstBuffer *out) {
    const std::vector<gfloat> levels = levels_of(out);
    ck_assert_uint_eq(strongest(levels), 3);
    fail_unless(levels[5] == 0);
  });
  play("roi-weights=\"face=0\"", [](GstBuffer *out) {
    const std::vector<gfloat> levels = levels_of(out);
    fail_unless(levels[3] == 0 && levels[0] == 0 && levels[6] == 0);
    ck_assert_uint_eq(strongest(levels), 5);
    fail_unless(levels[5] > 0);
  });
}

/// The property returns the text as set. Text that cannot be parsed causes a warning, changes
/// nothing and prevents the start.
CHECK_TEST(test_weights_as_text)
{
  g_autoptr(GstElement) element = gst_element_factory_make("saliencytactile", nullptr);
  const ElementBus messages(element);
  const auto shown = [&] {
    gchar *text = nullptr;
    g_object_get(element, "roi-weights", &text, nullptr);
    const std::string copy = text ? text : "(none)";
    g_free(text);
    return copy;
  };
  const auto said = [&](GstMessageType type) {
    const Said said = messages.said(type);
    fail_unless(said.domain == GST_LIBRARY_ERROR && said.code == GST_LIBRARY_ERROR_SETTINGS);
    return said.text;
  };
  fail_unless(shown() == "(none)");
  g_object_set(element, "roi-weights", "face=3, *=0.50", nullptr);
  fail_unless(shown() == "face=3, *=0.50");
  fail_if(messages.has(GST_MESSAGE_WARNING));

  g_object_set(element, "roi-weights", "face=30", nullptr);
  fail_unless(shown() == "face=3, *=0.50");
  fail_unless(said(GST_MESSAGE_WARNING).find("0 to 10, got '30'") != std::string::npos);
  fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED),
                         GST_STATE_CHANGE_FAILURE);
  fail_unless(said(GST_MESSAGE_ERROR).find("0 to 10, got '30'") != std::string::npos);
  gst_element_set_state(element, GST_STATE_NULL);

  g_object_set(element, "roi-weights", "", nullptr);
  fail_unless(shown().empty());
  fail_unless(gst_element_set_state(element, GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE);
  g_object_set(element, "roi-weights", nullptr, nullptr);
  fail_unless(shown() == "(none)");
  gst_element_set_state(element, GST_STATE_NULL);
}

/// A small square moves about the picture's middle. With the fixed viewport only the middle cell
/// plays. With the adaptive one left and right do, too, until a discontinuity.
CHECK_TEST(test_viewport)
{
  const auto moving = [](guint i) {
    return square(160 + static_cast<int>(44 * std::sin(i * 2 * G_PI / 60)), 120, 10);
  };
  for (const char *mode : { "fixed", "adaptive" }) {
    const bool adaptive = g_str_equal(mode, "adaptive");
    g_autofree gchar *line = g_strdup_printf("saliencytactile viewport=%s temporal=false", mode);
    Analysis analysis(line, kCaps);
    std::set<std::size_t> cells;
    for (guint i = 0; i < 300; i++) {
      const std::size_t cell = strongest(analysis.felt(frame(i, moving(i))));
      if (i >= 150)
        cells.insert(cell);
    }
    fail_unless(cells
                == (adaptive ? std::set<std::size_t>{ 3, 4, 5 } : std::set<std::size_t>{ 4 }));

    // Rightmost position.
    ck_assert_uint_eq(strongest(analysis.felt(frame(300, moving(15)))), adaptive ? 5 : 4);
    GstBuffer *jump = frame(301, moving(15));
    GST_BUFFER_FLAG_SET(jump, GST_BUFFER_FLAG_DISCONT);
    ck_assert_uint_eq(strongest(analysis.felt(jump)), 4);
  }
}

/// The camera pans over a texture. With camera=gentle a wave runs to the right, weaker than events,
/// and the disc that appears is felt as without.
CHECK_TEST(test_camera)
{
  const auto picture = [](guint i) -> Paint {
    return [i](int x, int y) {
      if (i >= 60 && std::hypot(x - 200, y - 120) < 20)
        return 250;
      const double there = x + 4.0 * i;
      return static_cast<int>(110 + 25 * std::sin(there / 17) + 20 * std::sin(y / 13.0 + there / 41)
                              + 15 * std::sin(y / 29.0 - there / 23));
    };
  };
  Analysis off("saliencytactile", kCaps);
  Analysis gentle("saliencytactile camera=gentle", kCaps);
  bool event = false;
  std::vector<std::size_t> crests; // in the order of time
  for (guint i = 0; i < 75; i++) {
    const std::vector<gfloat> plain = off.felt(frame(i, picture(i)));
    const std::vector<gfloat> waved = gentle.felt(frame(i, picture(i)));
    if (any(plain)) {
      fail_unless(i >= 60, "felt at %u", i);
      fail_unless(waved == plain);
      event = true;
      continue;
    }
    fail_unless(std::ranges::max(waved) < 0.3F);
    if (i >= 20 && i < 60) {
      fail_unless(any(waved), "silent at %u", i);
      const std::size_t column = strongest(waved) % 3;
      if (crests.empty() || crests.back() != column)
        crests.push_back(column);
    }
  }
  fail_unless(event);
  fail_unless(crests.size() >= 3);
  for (std::size_t i = 1; i < crests.size(); i++)
    ck_assert_uint_eq(crests[i], (crests[i - 1] + 1) % 3);
}

/// A square that stays plays for max-cue-duration, and again after any kind of discontinuity. The
/// same holds if maps are repeated between analyses.
CHECK_TEST(test_cue_duration)
{
  for (const char *rate : { "", "max-rate=2" }) {
    g_autofree gchar *line
        = g_strdup_printf("saliencytactile temporal=false max-cue-duration=500000000 %s", rate);
    Analysis analysis(line, kCaps);
    guint number = 0;
    const auto expect_cue = [&](bool discont) {
      for (guint i = 0; i < 40; i++) {
        GstBuffer *buffer = frame(number++, square(160, 120, 20));
        if (discont && i == 0)
          GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
        fail_unless(any(analysis.felt(buffer)) == (i < 15), "frame %u of %u", i, number);
      }
    };
    expect_cue(false);
    expect_cue(true);
    analysis.push_segment();
    expect_cue(false);
    analysis.flush();
    expect_cue(false);
    analysis.set_caps(
        "video/x-raw,format=RGB,width=320,height=240,framerate=30/1,pixel-aspect-ratio=2/1");
    expect_cue(false);
    number = 0; // back in time
    expect_cue(false);
  }
}

/// Squares that appear repeatedly in the middle cell: those within the refractory time do not play.
CHECK_TEST(test_cue_refractory)
{
  Analysis analysis("saliencytactile temporal=false cue-refractory=1000000000", kCaps);
  for (guint i = 0; i < 180; i++) {
    // On for half a second, off for half a second. Every second square begins half a second after
    // the last cue's end, and the refractory time ends only with that square.
    const bool there = i % 30 < 15;
    const bool is_felt
        = any(analysis.felt(frame(i, there ? square(160, 120, 20) : Paint(nothing))));
    fail_unless(is_felt == (i % 60 < 15), "frame %u", i);
  }
}

/// Other threads may set any property at any time.
CHECK_TEST(test_set_from_another_thread)
{
  Analysis analysis("saliencytactile", kCaps);
  std::thread other([&] {
    const char *const weights[] = { "face=3,logo=0", "*=0.5", "", "logo=10" };
    for (guint i = 0; i < 2000; i++) {
      g_object_set(analysis.element, "roi-weights", weights[i % 4], "viewport", i % 2,
                   "max-cue-duration", static_cast<guint64>(i % 3) * GST_MSECOND, "cue-refractory",
                   i % 5 ? static_cast<guint64>(0) : G_MAXUINT64, nullptr);
      gchar *text = nullptr;
      guint64 refractory = 0;
      g_object_get(analysis.element, "roi-weights", &text, "cue-refractory", &refractory, nullptr);
      g_free(text);
    }
  });
  for (guint i = 0; i < 60; i++) {
    GstBuffer *buffer = frame(i, square(40 + 4 * static_cast<int>(i), 120, 20));
    gst_buffer_add_video_region_of_interest_meta(buffer, i % 2 ? "face" : "logo", 30 + 4 * i, 110,
                                                 20, 20);
    for (const gfloat level : analysis.felt(buffer))
      fail_unless(level >= 0 && level <= 1);
  }
  other.join();
}

CHECK_MAIN(saliencytactile_steering)
