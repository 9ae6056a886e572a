// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile with frames that the CPU reads slowly or not at all, and with formats that the
// analysis does not know: their maps are compared with those of the same film in system memory.
// OpenGL is Mesa's, in software, without a display.
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "saliencytactile_rig.h"
#include "support/fake_vapostproc.h"
#include "support/unmappable.h"
#include <gst/gl/gl.h>

#include "support/check_tests.h"

namespace {

constexpr double kLeastCorrelation = 0.99;

using Levels = std::vector<gfloat>;

/// What a film gave.
struct Play
{
  Levels levels; ///< of all frames, one after the other
  std::string path;
  guint64 frames = 0;
  guint64 bytes = 0;
};

std::string
path_of(GstElement *element)
{
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(element, "stats", &stats, nullptr);
  return gst_structure_get_string(stats, "path");
}

using Change = std::function<GstBuffer *(GstBuffer *)>;
using See = std::function<void(GstBuffer *)>;

/// Plays a launch line with a saliencytactile of that name. `change` gets each frame before it, and
/// gives another one, whose caps are `caps` if these are set; `see` gets it after it.
Play
play(const std::string &line, const See &see = {}, const Change &change = {},
     const char *caps = nullptr)
{
  struct Probes
  {
    Play play;
    const See &see;
    const Change &change;
    const char *caps;
  } probes{ {}, see, change, caps };
  GstElement *pipeline = make_pipeline(line);
  g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline), "saliency");
  g_autoptr(GstPad) in = gst_element_get_static_pad(element, "sink");
  g_autoptr(GstPad) out = gst_element_get_static_pad(element, "src");
  gst_pad_add_probe(
      in,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
      [](GstPad *, GstPadProbeInfo *info, gpointer data) {
        auto *all = static_cast<Probes *>(data);
        if (all->change && info->type & GST_PAD_PROBE_TYPE_BUFFER)
          info->data = all->change(GST_PAD_PROBE_INFO_BUFFER(info));
        if (all->caps && info->type & GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM
            && GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_CAPS) {
          g_autoptr(GstCaps) other = gst_caps_from_string(all->caps);
          gst_event_unref(GST_PAD_PROBE_INFO_EVENT(info));
          info->data = gst_event_new_caps(other);
        }
        return GST_PAD_PROBE_OK;
      },
      &probes, nullptr);
  gst_pad_add_probe(
      out, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad *, GstPadProbeInfo *info, gpointer data) {
        auto *all = static_cast<Probes *>(data);
        GstBuffer *frame = GST_PAD_PROBE_INFO_BUFFER(info);
        for (const gfloat level : levels_of(frame))
          all->play.levels.push_back(level);
        if (all->see)
          all->see(frame);
        return GST_PAD_PROBE_OK;
      },
      &probes, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  probes.play.path = path_of(element);
  probes.play.frames = stat_of(element, "frames");
  probes.play.bytes = stat_of(element, "bytes-read");
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return probes.play;
}

/// Pearson's, over all cells of all frames.
double
correlation(const Levels &a, const Levels &b)
{
  fail_unless_equals_int(a.size(), b.size());
  const auto mean = [](const Levels &values) {
    double sum = 0;
    for (const gfloat value : values)
      sum += value;
    return sum / static_cast<double>(values.size());
  };
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::size_t i = 0; i < a.size(); i++) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  fail_unless(aa > 0 && bb > 0, "a film that is not felt compares nothing");
  return ab / std::sqrt(aa * bb);
}

void
assert_alike(const Play &expected, const Play &play, const std::string &name)
{
  const double r = correlation(expected.levels, play.levels);
  fail_unless(r >= kLeastCorrelation, "%s: correlation %g", name.c_str(), r);
}

/// A ball on a noisy picture.
std::string
film(int width, int height, int frames = 24)
{
  return "tactiletestsrc pattern=dynamic-motion noise=2 num-buffers=" + std::to_string(frames)
         + " ! video/x-raw,format=I420,width=" + std::to_string(width)
         + ",height=" + std::to_string(height) + ",framerate=12/1 ! ";
}

constexpr const char *kAnalysis = "saliencytactile name=saliency rows=6 columns=8 threshold=0 ";
const std::string kEnd = std::string("! ") + kAnalysis + "! fakesink";

void
use_software_gl()
{
  g_setenv("GST_GL_WINDOW", "egl-device", TRUE);
  g_setenv("GST_GL_PLATFORM", "egl", TRUE);
  g_setenv("LIBGL_ALWAYS_SOFTWARE", "1", TRUE);
  g_setenv("VISUOTACTILE_GL_IN_SOFTWARE", "1", TRUE);
}

struct GlCase
{
  const char *upload;
  int width;
  int height;
  const char *api;
};
constexpr const char *kRgba
    = "glupload ! glcolorconvert ! video/x-raw(memory:GLMemory),format=RGBA ";
constexpr GlCase kGlCases[] = {
  { "glupload ", 1280, 720, "opengl" },
  { "glupload ", 1280, 720, "opengl3" },
  { "glupload ", 1280, 720, "gles2" },
  { "videoconvert ! video/x-raw,format=NV12 ! glupload ", 1001, 563, "opengl" },
  { "videoconvert ! video/x-raw,format=YUY2 ! glupload ", 1000, 600, "opengl" },
  { "videoconvert ! video/x-raw,format=BGRx ! glupload ", 999, 601, "gles2" },
  { "videoconvert ! video/x-raw,format=GRAY8 ! glupload ", 900, 600, "opengl" },
  { kRgba, 1280, 720, "opengl3" },
  { kRgba, 1919, 1079, "opengl" },
};

/// The analysis marks frames as written by the GPU, and not read: their memory is untouched.
void
expect_unread(GstBuffer *frame)
{
  GstMemory *memory = gst_buffer_peek_memory(frame, 0);
  fail_unless(gst_is_gl_memory(memory));
  fail_unless(GST_MEMORY_FLAG_IS_SET(memory, GST_GL_BASE_MEMORY_TRANSFER_NEED_DOWNLOAD));
}

} // namespace

/// In the bins of players, textures are shrunk too, and not on the thread that brings the film.
CHECK_LOOP_TEST(test_gl_in_a_player, 0, 2)
{
  use_software_gl();
  GstElement *pipeline = make_pipeline(
      film(1280, 720, 12)
      + (__i__ == 0 ? "glupload ! visuotactilesink name=chair driver=simulator video-sink=fakesink"
                    : "jpegenc ! visuotactiledecoder name=chair tactors::driver=simulator ! "
                      "fakesink"));
  struct Threads
  {
    std::atomic<GThread *> film{ nullptr };
    std::atomic<GThread *> analysis{ nullptr };
  } threads;
  const auto watch = [](GstElement *element, const char *name, std::atomic<GThread *> *thread) {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, name);
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad *, GstPadProbeInfo *, gpointer data) {
          *static_cast<std::atomic<GThread *> *>(data) = g_thread_self();
          return GST_PAD_PROBE_OK;
        },
        thread, nullptr);
  };
  g_autoptr(GstElement) chair = gst_bin_get_by_name(GST_BIN(pipeline), "chair");
  g_autoptr(GObject) child = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "analysis");
  watch(chair, "sink", &threads.film);
  watch(GST_ELEMENT(child), "sink", &threads.analysis);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  fail_unless(threads.film != nullptr && threads.analysis != nullptr);
  fail_unless(threads.film != threads.analysis);
  if (__i__ == 0)
    fail_unless(path_of(GST_ELEMENT(child)) == "gl");
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

/// Frames in textures of any format and size, with each of OpenGL's interfaces.
CHECK_LOOP_TEST(test_gl, 0, G_N_ELEMENTS(kGlCases))
{
  const GlCase &given = kGlCases[__i__];
  use_software_gl();
  g_setenv("GST_GL_API", given.api, TRUE);
  const std::string source = film(given.width, given.height);
  const Play mapped = play(source + "identity " + kEnd);
  fail_unless(mapped.path == "mapped", "%s", mapped.path.c_str());
  const Play gl = play(source + given.upload + kEnd, given.upload == kRgba ? expect_unread : See());
  fail_unless(gl.path == "gl", "%s: %s", given.upload, gl.path.c_str());
  assert_alike(mapped, gl, given.upload);
}

/// At 4K at most 0.2 MB of 12 MB a frame are read.
CHECK_TEST(test_gl_bytes)
{
  use_software_gl();
  const std::string source = film(3840, 2160, 18);
  const Play mapped = play(source + "identity " + kEnd);
  const Play gl = play(source + kRgba + kEnd, expect_unread);
  fail_unless(gl.path == "gl");
  fail_unless_equals_uint64(gl.frames, 18);
  fail_unless(gl.bytes > 0 && gl.bytes <= 200000 * gl.frames, "%g bytes a frame",
              static_cast<double>(gl.bytes) / static_cast<double>(gl.frames));
  assert_alike(mapped, gl, "4K");
}

/// profile=paper analyzes every pixel.
CHECK_TEST(test_gl_exact)
{
  use_software_gl();
  const std::string end = "! saliencytactile name=saliency profile=paper ! fakesink";
  fail_unless(play(film(1280, 720, 4) + "glupload " + end).path == "mapped");
}

/// Without the module, and where OpenGL is software, frames are read as a whole.
CHECK_LOOP_TEST(test_gl_is_not_there, 0, 2)
{
  use_software_gl();
  if (__i__ == 0)
    g_setenv("VISUOTACTILE_MODULES", "/nonexistent", TRUE);
  else
    g_unsetenv("VISUOTACTILE_GL_IN_SOFTWARE");
  const std::string source = film(1280, 720);
  const Play gl = play(source + "glupload " + kEnd);
  fail_unless(gl.path == "mapped");
  fail_unless_equals_uint64(gl.bytes, 0);
  assert_alike(play(source + "identity " + kEnd), gl, "whole");
}

/// The textures' size changes while the film plays.
CHECK_TEST(test_gl_caps_change)
{
  use_software_gl();
  const Play gl = play("concat name=all ! glupload " + kEnd + " " + film(1280, 720, 6) + "all. "
                       + film(1000, 900, 6) + "all. " + film(801, 600, 6) + "all.");
  fail_unless_equals_uint64(gl.frames, 18);
  fail_unless(gl.path == "gl");
}

/// A real film, 768 × 432.
CHECK_TEST(test_gl_real_film)
{
  const char *folder = g_getenv("TEST_CLIPS");
  const std::string clip = std::string(folder ? folder : "") + "/car-detection.mp4";
  if (!g_file_test(clip.c_str(), G_FILE_TEST_EXISTS))
    return;
  use_software_gl();
  const std::string source = "filesrc location=" + clip
                             + " ! qtdemux ! h264parse ! avdec_h264 ! identity eos-after=100 ! ";
  const std::string end = "! saliencytactile name=saliency rows=6 columns=8 ! fakesink";
  const Play gl = play(source + "glupload " + end);
  fail_unless(gl.path == "gl");
  assert_alike(play(source + "identity " + end), gl, "film");
}

/// Regions and windows are in the pixels of the frame, not in those of its small picture.
CHECK_LOOP_TEST(test_gl_metas, 0, 2)
{
  use_software_gl();
  const bool crops = __i__ == 1;
  const Change mark = [crops](GstBuffer *frame) {
    frame = gst_buffer_make_writable(frame);
    if (crops) {
      GstVideoCropMeta *crop = gst_buffer_add_video_crop_meta(frame);
      crop->x = 320;
      crop->y = 80;
      crop->width = 800;
      crop->height = 560;
    } else {
      gst_buffer_add_video_region_of_interest_meta(frame, "corner", 0, 0, 700, 400);
    }
    return frame;
  };
  const std::string source = film(1280, 720);
  const std::string end
      = std::string("! ") + kAnalysis + (crops ? "" : "roi-weights=corner=0.05 ") + "! fakesink";
  const Play mapped = play(source + "identity " + end, {}, mark);
  const Play gl = play(source + "glupload " + end, {}, mark);
  fail_unless(gl.path == "gl");
  assert_alike(mapped, gl, crops ? "window" : "region");
  // What is compared depends on them.
  fail_unless(correlation(mapped.levels, play(source + "identity " + end).levels)
              < kLeastCorrelation);
}

namespace {

/// Frames of a film of 1280 × 720 as if in memory of that name, which the CPU cannot map.
Play
play_unmappable(const std::string &source, const char *feature, const See &see)
{
  const std::string caps = "video/x-raw(" + std::string(feature)
                           + "),format=NV12,width=1280,height=720,framerate=12/1";
  return play(
      source + "videoconvert ! video/x-raw,format=NV12 " + kEnd, see,
      [](GstBuffer *frame) { return Unmappable::hide(frame); }, caps.c_str());
}

struct Neighbor
{
  bool asked = false;
};

} // namespace

/// An element that takes the frames' memory shrinks them.
CHECK_TEST(test_element)
{
  FakeVaPostProc::install();
  const std::string source = film(1280, 720);
  for (const char *feature : { "memory:VAMemory", "memory:DMABuf" }) {
    const Play element = play_unmappable(source, feature, [](GstBuffer *frame) {
      fail_unless(gst_memory_is_type(gst_buffer_peek_memory(frame, 0), "Unmappable"));
    });
    fail_unless(element.path == "element", "%s: %s", feature, element.path.c_str());
    fail_unless(element.bytes > 0 && element.bytes <= 200000 * element.frames);
    assert_alike(play(source + "identity " + kEnd), element, feature);
  }
}

/// That element's display is the one that the pipeline uses.
CHECK_TEST(test_element_shares_the_display)
{
  FakeVaPostProc::install();
  Analysis analysis;
  Neighbor neighbor;
  gst_pad_add_probe(
      analysis.h->srcpad, GST_PAD_PROBE_TYPE_QUERY_UPSTREAM,
      [](GstPad *, GstPadProbeInfo *info, gpointer data) {
        const gchar *type = nullptr;
        GstQuery *query = GST_PAD_PROBE_INFO_QUERY(info);
        if (GST_QUERY_TYPE(query) == GST_QUERY_CONTEXT && gst_query_parse_context_type(query, &type)
            && g_str_equal(type, FakeVaPostProc::kContext))
          static_cast<Neighbor *>(data)->asked = true;
        return GST_PAD_PROBE_OK;
      },
      &neighbor, nullptr);
  constexpr const char *kCaps
      = "video/x-raw(memory:VAMemory),format=NV12,width=1280,height=720,framerate=30/1";
  analysis.set_caps(kCaps);
  const std::vector<gfloat> levels
      = analysis.felt(Unmappable::hide(flat_frame(std::size_t{ 1280 } * 720 * 3 / 2, 128)));
  ck_assert_uint_eq(levels.size(), 9);
  fail_unless(neighbor.asked, "the neighbor upstream was not asked");
  fail_unless(analysis.messages.has(GST_MESSAGE_NEED_CONTEXT), "the application was not asked");
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));
  analysis.set_caps("video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1");
  gst_bus_set_flushing(analysis.messages.bus, TRUE); // messages hold their sources
  fail_unless_equals_int(FakeVaPostProc::alive(), 0);
}

/// Memory that nobody can read, and caps that GStreamer 1.22 does not know, pass as they are, with
/// one warning.
CHECK_LOOP_TEST(test_unreadable, 0, 4)
{
  constexpr const char *kCaps[] = {
    "video/x-raw(memory:Fake),format=NV12,width=1280,height=720,framerate=30/1",
    "video/x-raw(memory:Fake),format=NV12_32L32,width=1280,height=720,framerate=30/1",
    "video/x-raw(memory:DMABuf),format=DMA_DRM,drm-format=(string)NV12:0x0100000000000002,"
    "width=1280,height=720,framerate=30/1",
    "video/x-raw(memory:Fake),format=OF_TOMORROW,width=0,height=0",
  };
  Analysis analysis;
  analysis.set_caps(kCaps[__i__]);
  for (int i = 0; i < 3; i++) {
    GstBuffer *frame = Unmappable::hide(flat_frame(std::size_t{ 1280 } * 720 * 3 / 2, 128));
    GstMemory *memory = gst_buffer_peek_memory(frame, 0);
    g_autoptr(GstBuffer) out = analysis.pass(frame);
    fail_unless(gst_buffer_peek_memory(out, 0) == memory);
    for (const gfloat level : levels_of(out))
      fail_unless(level == 0);
  }
  const Said said = analysis.messages.said(GST_MESSAGE_WARNING);
  fail_unless(said.domain == GST_RESOURCE_ERROR && said.code == GST_RESOURCE_ERROR_READ);
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));
  fail_unless(path_of(analysis.element) == (__i__ == 0 ? "mapped" : "none"));
}

/// A frame that others have, too, passes with the same memory and metas.
CHECK_TEST(test_shared_frame)
{
  constexpr const char *kCaps
      = "video/x-raw(memory:Fake),format=NV12,width=1280,height=720,framerate=30/1";
  Analysis analysis("saliencytactile", kCaps);
  g_autoptr(GstBuffer) frame = Unmappable::hide(flat_frame(std::size_t{ 1280 } * 720 * 3 / 2, 128));
  GST_BUFFER_PTS(frame) = GST_SECOND;
  gst_buffer_add_video_meta(frame, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_NV12, 1280, 720);
  g_autoptr(GstBuffer) out = analysis.pass(gst_buffer_ref(frame));
  fail_unless(out != frame);
  fail_unless(gst_buffer_peek_memory(out, 0) == gst_buffer_peek_memory(frame, 0));
  fail_unless_equals_uint64(GST_BUFFER_PTS(out), GST_SECOND);
  fail_unless(gst_buffer_get_video_meta(out) != nullptr);
  fail_unless(gst_buffer_get_tactile_meta(out) != nullptr);
  fail_unless(gst_buffer_get_tactile_meta(frame) == nullptr);
}

/// Formats that the analysis does not know are converted.
CHECK_LOOP_TEST(test_other_formats, 0, 8)
{
  constexpr const char *kFormats[]
      = { "AYUV64", "v210", "NV16", "Y444_10LE", "GBR", "RGB16", "GRAY16_LE", "NV12_4L4" };
  const char *format = kFormats[__i__];
  const std::string source = film(1280, 720);
  const std::string gray
      = g_str_has_prefix(format, "GRAY") ? "videoconvert ! video/x-raw,format=GRAY8 ! " : "";
  const Play other = play(source + "videoconvert ! video/x-raw,format=" + format + " " + kEnd);
  fail_unless(other.path == "converted", "%s: %s", format, other.path.c_str());
  assert_alike(play(source + gray + "identity " + kEnd), other, format);
}

/// A source with a choice takes a format that is read as it is.
CHECK_TEST(test_known_formats_come_first)
{
  fail_unless(play(std::string("videotestsrc num-buffers=2 ! ") + kAnalysis + "! fakesink").path
              == "mapped");
  fail_unless(
      play(std::string("videotestsrc num-buffers=2 ! videoconvert ! ") + kAnalysis + "! fakesink")
          .path
      == "mapped");
}

CHECK_MAIN_TIMEOUT(saliencytactile_memory, 60)
