// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile's people: OpenCV's detector on drawn faces and on a photograph, detectors
// upstream, what is missing, and threads. libs/people, face_tracker and detection_thread test how
// faces are followed and what they count.
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "saliencytactile_rig.h"
#include "schematic_face.h"

#include "support/check_tests.h"

namespace {

constexpr const char *kCaps = "video/x-raw,format=RGB,width=320,height=240,framerate=30/1";
constexpr double kHalfWidth = 32;
constexpr double kFaceX = 250; // in the right column, middle row
constexpr double kFaceY = 120;

/// A drawn face on gray, with skin's color. `open`: the mouth, 0 to 1.
GstBuffer *
face_frame(guint number, double open, bool face = true)
{
  std::vector<guint8> pixels(kWidth * kHeight * 3, 110);
  for (int y = 0; y < kHeight && face; y++)
    for (int x = 0; x < kWidth; x++) {
      const double dx = (x + 0.5 - kFaceX) / kHalfWidth;
      const double dy = (y + 0.5 - kFaceY) / kHalfWidth;
      int gray = schematic_face_at(dx, dy);
      if (gray < 0)
        continue;
      if (std::hypot(dx / 0.25, (dy - 0.78) / (0.02 + 0.13 * open)) <= 1)
        gray = 60;
      guint8 *pixel = pixels.data() + 3 * (y * kWidth + x);
      pixel[0] = static_cast<guint8>(std::min(255, gray + 25));
      pixel[1] = static_cast<guint8>(gray - 5);
      pixel[2] = static_cast<guint8>(std::max(0, gray - 30));
    }
  GstBuffer *buffer = gst_buffer_new_memdup(pixels.data(), pixels.size());
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(number, GST_SECOND, 30);
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
  return buffer;
}

/// A film whose source is not live, so that looks for people are waited for.
class Film : public Analysis
{
public:
  explicit Film(const std::string &line = "saliencytactile people=fast") : Analysis(line)
  {
    gst_pad_set_query_function(h->srcpad, [](GstPad *pad, GstObject *parent, GstQuery *query) {
      return static_cast<gboolean>(GST_QUERY_TYPE(query) != GST_QUERY_LATENCY
                                   && gst_pad_query_default(pad, parent, query));
    });
    set_caps(kCaps);
  }

  std::vector<gfloat> show(double open, bool face = true)
  {
    return felt(face_frame(number_++, open, face));
  }
  /// The share of frames in which anything is felt; all of it is to be strongest at the face.
  double play(int frames, bool talks)
  {
    int active = 0;
    for (int i = 0; i < frames; i++) {
      const std::vector<gfloat> levels = show(talks ? 0.5 + 0.5 * std::sin(i * 0.9) : 0);
      if (levels[strongest(levels)] > 0) {
        active++;
        ck_assert_uint_eq(strongest(levels), 5);
      }
    }
    return static_cast<double>(active) / frames;
  }
  guint64 stat(const char *field)
  {
    return stat_of(element, field);
  }

private:
  guint number_ = 0;
};

/// A folder with nothing in it.
constexpr const char *kNowhere = "/nowhere";

} // namespace

/// A drawn face is found. At rest it is not felt, and once it talks it is, at its cell.
CHECK_TEST(test_talking_head)
{
  for (const char *line :
       { "saliencytactile", "saliencytactile people=fast", "saliencytactile people=thorough" }) {
    Film film(line);
    fail_unless(film.play(60, false) == 0);
    ck_assert_uint_eq(film.stat("faces"), 1);
    fail_unless(film.play(15, true) > 0.5);
    fail_unless(film.play(60, true) == 1);
    film.play(30, false);
    fail_unless(film.play(60, false) == 0);
    fail_unless(film.stat("look-mean") > 0);
    fail_if(film.messages.has(GST_MESSAGE_WARNING));
  }
}

/// A picture without faces that shows nothing new is not analyzed again; a face may begin to talk.
CHECK_TEST(test_rest)
{
  for (const bool face : { false, true }) {
    Film film("saliencytactile");
    for (int i = 0; i < 60; i++)
      film.show(0, face);
    if (face)
      ck_assert_uint_gt(film.stat("analyzed"), 50);
    else
      ck_assert_uint_lt(film.stat("analyzed"), 30);
  }
}

/// Without people the same film is hardly felt, and stats have no looks.
CHECK_TEST(test_off)
{
  Film film("saliencytactile people=off");
  film.play(60, false);
  film.play(60, true);
  ck_assert_uint_eq(film.stat("looks"), 0);
  // The paper is taken literally.
  Film paper("saliencytactile people=fast profile=paper");
  for (int i = 0; i < 30; i++)
    paper.show(0);
  ck_assert_uint_eq(paper.stat("looks"), 0);
}

/// The same film gives the same maps each time, also under load: looks are waited for.
CHECK_TEST(test_the_same_each_time)
{
  const auto play = [] {
    Film film;
    std::vector<std::vector<gfloat>> maps;
    for (int i = 0; i < 90; i++)
      maps.push_back(film.show(0.5 + 0.5 * std::sin(i * 0.9)));
    return maps;
  };
  const auto first = play();
  const auto again = play();
  for (std::size_t i = 0; i < first.size(); i++)
    fail_unless(first[i] == again[i], "frame %zu", i);
}

/// Regions of a detector upstream are the faces; the element's own detector is not even loaded.
CHECK_TEST(test_regions_upstream)
{
  g_setenv("VISUOTACTILE_MODULES", kNowhere, TRUE);
  for (const char *type : { "face", "head", "person", "car" }) {
    const bool person = !g_str_equal(type, "car");
    Film film;
    std::vector<gfloat> levels;
    for (guint i = 0; i < 90; i++) {
      GstBuffer *frame = face_frame(i, 0.5 + 0.5 * std::sin(i * 0.9));
      gst_buffer_add_video_region_of_interest_meta(
          frame, type, static_cast<guint>(kFaceX - kHalfWidth),
          static_cast<guint>(kFaceY - kHalfWidth), 2 * static_cast<guint>(kHalfWidth),
          2 * static_cast<guint>(kHalfWidth));
      levels = film.felt(frame);
    }
    ck_assert_uint_eq(film.stat("faces"), person);
    fail_unless(levels[5] > 0 || !person);
    ck_assert_int_eq(film.messages.has(GST_MESSAGE_WARNING), !person);
  }
}

/// One warning says what is missing and what to install; the film goes on.
CHECK_TEST(test_missing)
{
  for (const char *variable : { "VISUOTACTILE_CASCADES", "VISUOTACTILE_MODULES" }) {
    g_setenv(variable, kNowhere, TRUE);
    Film film("saliencytactile people=fast skip-unchanged=false");
    film.play(60, false);
    const Said said = film.messages.said(GST_MESSAGE_WARNING);
    fail_unless(said.text.find(kNowhere) != std::string::npos, "%s", said.text.c_str());
    fail_unless(said.details.find("opencv-data") != std::string::npos);
    for (int i = 0; i < 60; i++)
      film.show(i % 2);
    fail_if(film.messages.has(GST_MESSAGE_WARNING));
    ck_assert_uint_eq(film.stat("analyzed"), 120);
    // Where nobody has asked for faces, nothing is missing.
    Film automatic("saliencytactile");
    automatic.play(60, false);
    fail_if(automatic.messages.has(GST_MESSAGE_WARNING));
    ck_assert_uint_eq(automatic.stat("faces"), 0);
  }
}

/// A detector whose memory runs out: the film goes on, and is felt.
CHECK_TEST(test_out_of_memory)
{
  g_setenv("VISUOTACTILE_MODULES", THROWING_MODULES, TRUE);
  Film film("saliencytactile people=fast skip-unchanged=false");
  film.play(60, false);
  const Said said = film.messages.said(GST_MESSAGE_WARNING);
  fail_unless(said.text == "Faces are not detected: out of memory.", "%s", said.text.c_str());
  film.play(60, false);
  fail_if(film.messages.has(GST_MESSAGE_WARNING));
  ck_assert_uint_eq(film.stat("analyzed"), 120);
  ck_assert_uint_eq(film.stat("faces"), 0);
}

/// It is switched on, off and to another effort while the film plays.
CHECK_TEST(test_changes)
{
  const char *const modes[] = { "fast", "off", "thorough", "auto" };
  Film film("saliencytactile people=off");
  for (const char *mode : modes) {
    film.set("people", mode);
    film.play(45, false);
    ck_assert_uint_eq(film.stat("faces"), !g_str_equal(mode, "off"));
  }
  for (int i = 0; i < 60; i++) {
    film.set("people", modes[i % 4]);
    g_object_set(film.element, "temporal", i % 5 != 0, "profile", i % 7 == 0, nullptr);
    film.show(0);
  }
}

/// A live source is never held up, and the element stops while a look is under way.
CHECK_TEST(test_live)
{
  for (int frames = 1; frames < 12; frames += 3) {
    Analysis analysis("saliencytactile people=thorough", kCaps); // GstHarness is live
    for (int i = 0; i < frames; i++) {
      g_autoptr(GstBuffer) out = analysis.pass(face_frame(static_cast<guint>(i), 0));
    }
    fail_unless_equals_int(gst_element_set_state(analysis.element, GST_STATE_NULL),
                           GST_STATE_CHANGE_SUCCESS);
    ck_assert_uint_eq(stat_of(analysis.element, "frames"), static_cast<guint64>(frames));
  }
}

/// Sinks that say that frames come late are not made to wait.
CHECK_TEST(test_late_frames)
{
  Film film;
  gst_harness_push_upstream_event(
      film.h, gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 1.5, GST_SECOND, GST_SECOND));
  film.play(90, false); // whatever is found
  gst_harness_push_upstream_event(
      film.h, gst_event_new_qos(GST_QOS_TYPE_OVERFLOW, 0.5, -GST_SECOND, 2 * GST_SECOND));
  film.play(30, false);
  ck_assert_uint_eq(film.stat("faces"), 1);
}

/// After a seek faces have to be found anew; a cut is one, too.
CHECK_TEST(test_seek_and_cut)
{
  Film film;
  film.play(45, false);
  ck_assert_uint_eq(film.stat("faces"), 1);
  film.flush();
  film.show(0);
  ck_assert_uint_eq(film.stat("faces"), 0);
  film.play(45, false);
  ck_assert_uint_eq(film.stat("faces"), 1);
  GstBuffer *white = gst_buffer_new_allocate(nullptr, kWidth * kHeight * 3, nullptr);
  gst_buffer_memset(white, 0, 255, kWidth * kHeight * 3);
  GST_BUFFER_PTS(white) = 100 * GST_SECOND / 30;
  gst_buffer_unref(film.pass(white));
  ck_assert_uint_eq(film.stat("faces"), 0);
}

/// A photograph of people in skin's colors: what is found at once is where they are.
CHECK_TEST(test_photograph)
{
  const std::string photograph = std::string(g_getenv("TEST_PHOTOGRAPHS")) + "/1409.jpg";
  if (!std::filesystem::exists(photograph))
    return; // there is no such data here
  g_autofree gchar *line
      = g_strdup_printf("filesrc location=%s ! jpegdec ! saliencytactile temporal=false "
                        "people=thorough name=analysis ! fakesink",
                        photograph.c_str());
  GstElement *pipeline = make_pipeline(line);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  g_autoptr(GstElement) analysis = gst_bin_get_by_name(GST_BIN(pipeline), "analysis");
  ck_assert_uint_eq(stat_of(analysis, "looks"), 1);
  ck_assert_uint_eq(stat_of(analysis, "faces"), 1);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_MAIN(saliencytactile_people)
