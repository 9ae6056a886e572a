// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Pictures of key frames from all over a film.
#include "tactile-track-desk/glance.h"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

constexpr std::array<unsigned, 3> kColors{ 0xffff0000, 0xff00ff00, 0xff0000ff };

/// Four seconds of each color at five frames a second, with a key frame every two seconds.
Film
make_film(const std::string &path)
{
  std::string line;
  for (const unsigned color : kColors)
    line += "videotestsrc pattern=solid-color foreground-color=" + std::to_string(color)
            + " num-buffers=20 ! video/x-raw,format=I420,width=160,height=120,framerate=5/1 ! c. ";
  const Pipeline pipeline
      = make_pipeline(line
                      + "concat name=c ! vp8enc deadline=1 keyframe-max-dist=10 "
                        "keyframe-mode=auto ! matroskamux ! filesink location="
                      + path);
  const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus.get(), GST_CLOCK_TIME_NONE,
      static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
  return discover_film(path);
}

/// Index of the strongest component in the middle of a JPEG of 80 × 60 pixels.
unsigned
color_of(const std::string &jpeg)
{
  const TemporaryFile file(jpeg, ".jpg");
  const Pipeline pipeline
      = make_pipeline("filesrc location=" + file.path
                      + " ! jpegdec ! videoconvert ! video/x-raw,format=RGB ! appsink name=out");
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  const Owned<GstElement> out = element(pipeline, "out");
  GstSample *sample = gst_app_sink_pull_sample(GST_APP_SINK(out.get()));
  fail_unless(sample != nullptr);
  GstVideoInfo info;
  GstVideoFrame frame;
  fail_unless(gst_video_info_from_caps(&info, gst_sample_get_caps(sample)));
  fail_unless(gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ));
  const auto *pixel = static_cast<const guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0))
                      + GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0) * 30 + 3 * 40;
  const auto strongest = static_cast<unsigned>(std::max_element(pixel, pixel + 3) - pixel);
  gst_video_frame_unmap(&frame);
  gst_sample_unref(sample);
  return strongest;
}

/// In the order in which they come.
std::vector<std::pair<gint64, unsigned>>
colors(const Film &film, gint64 every)
{
  std::vector<std::pair<gint64, unsigned>> found;
  GMainLoop *loop = g_main_loop_new(nullptr, FALSE);
  const Glance glance(
      film, 80, 60, every,
      { .taken
        = [&](gint64 ms, const std::string &jpeg) { found.emplace_back(ms, color_of(jpeg)); },
        .done =
            [&] {
              g_main_loop_quit(loop);
            } });
  g_main_loop_run(loop);
  g_main_loop_unref(loop);
  return found;
}

} // namespace

CHECK_TEST(test_key_frames)
{
  const TemporaryFile file("", ".webm");
  const auto found = colors(make_film(file.path), 1000);
  ck_assert_uint_eq(found.size(), 12);
  std::set<gint64> known{ 12'000 };
  for (const auto &[ms, color] : found) {
    ck_assert_uint_eq(color, static_cast<unsigned>(ms / 4000));
    // However many there is time for, they are from all over the film.
    known.insert(ms);
    gint64 widest = *known.begin();
    for (auto next = std::next(known.begin()); next != known.end(); ++next)
      widest = std::max(widest, *next - *std::prev(next));
    fail_unless(widest * static_cast<gint64>(known.size() - 1) <= 32'000,
                "%zu pictures leave %.1f s without one", known.size() - 1,
                static_cast<double>(widest) / 1000);
  }
  ck_assert_uint_eq(known.size(), 13);
}

CHECK_TEST(test_no_film)
{
  const TemporaryFile file("", ".webm");
  Film film = make_film(file.path);
  g_file_set_contents(file.path.c_str(), "no film", -1, nullptr);
  fail_unless(colors(film, 1000).empty());
}

CHECK_MAIN(glance)
