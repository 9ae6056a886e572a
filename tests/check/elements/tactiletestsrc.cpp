// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/check_tests.h"

namespace {

/// A region of interest on a ball.
struct Target
{
  gint ball;
  guint x, y, width, height;
  guint64 onset;
  gboolean moving;

  bool operator==(const Target &) const = default;
};

std::vector<Target>
targets(GstBuffer *buffer)
{
  std::vector<Target> found;
  gpointer state = nullptr;
  while (GstMeta *meta = gst_buffer_iterate_meta_filtered(
             buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto *region = reinterpret_cast<GstVideoRegionOfInterestMeta *>(meta);
    fail_unless_equals_string(g_quark_to_string(region->roi_type), "tactile-target");
    GstStructure *param = gst_video_region_of_interest_meta_get_param(region, "tactile-target");
    Target target{ 0, region->x, region->y, region->w, region->h, 0, FALSE };
    fail_unless(gst_structure_get(param, "ball", G_TYPE_INT, &target.ball, "onset", G_TYPE_UINT64,
                                  &target.onset, "moving", G_TYPE_BOOLEAN, &target.moving,
                                  nullptr));
    fail_unless_equals_int(region->id, target.ball);
    found.push_back(target);
  }
  return found;
}

struct Frame
{
  GstClockTime duration;
  std::vector<guint8> bytes;
  std::vector<Target> targets;

  bool operator==(const Frame &) const = default;
};

std::vector<guint8>
bytes_of(GstBuffer *buffer)
{
  std::vector<guint8> bytes(gst_buffer_get_size(buffer));
  gst_buffer_extract(buffer, 0, bytes.data(), bytes.size());
  return bytes;
}

/// A pipeline "tactiletestsrc PROPERTIES ! CAPS" and its frames by timestamp.
class TestSource
{
public:
  explicit TestSource(const std::string &properties,
                      const std::string &caps = "video/x-raw,format=GRAY8,width=160,height=120")
  {
    const std::string text = "tactiletestsrc name=source " + properties + " ! " + caps
                             + " ! fakesink name=sink signal-handoffs=true sync=false";
    pipeline = make_pipeline(text);
    GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
    g_signal_connect(sink, "handoff", G_CALLBACK(take), this);
    gst_object_unref(sink);
  }

  ~TestSource()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }

  TestSource(const TestSource &) = delete;
  TestSource &operator=(const TestSource &) = delete;

  void play_to_the_end()
  {
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    wait_for_eos(pipeline);
  }

  GstElement *pipeline;
  std::map<GstClockTime, Frame> frames;
  std::vector<GstClockTime> order;
  std::function<void(std::size_t)>
      after_frame; ///< called in the streaming thread with the number of frames so far

private:
  static void take(GstElement *sink, GstBuffer *buffer, GstPad *pad, gpointer user)
  {
    (void)sink;
    (void)pad;
    auto *self = static_cast<TestSource *>(user);
    self->order.push_back(GST_BUFFER_PTS(buffer));
    self->frames[GST_BUFFER_PTS(buffer)]
        = { GST_BUFFER_DURATION(buffer), bytes_of(buffer), targets(buffer) };
    if (self->after_frame)
      self->after_frame(self->order.size());
  }
};

std::map<GstClockTime, Frame>
play(const std::string &properties,
     const std::string &caps = "video/x-raw,format=GRAY8,width=160,height=120")
{
  TestSource film(properties, caps);
  film.play_to_the_end();
  return film.frames;
}

GstHarness *
make_harness(const gchar *launch, const gchar *caps)
{
  GstHarness *h = gst_harness_new_parse(launch);
  gst_harness_set_sink_caps_str(h, caps);
  gst_harness_play(h);
  return h;
}

} // namespace

CHECK_TEST(test_defaults)
{
  GstHarness *h = gst_harness_new_parse("tactiletestsrc num-buffers=2");
  gst_harness_set_sink_caps_str(h, "ANY");
  gst_harness_play(h);
  GstBuffer *buffer = gst_harness_pull(h);
  GstCaps *caps = gst_pad_get_current_caps(h->sinkpad);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  fail_unless_equals_int(GST_VIDEO_INFO_FORMAT(&info), GST_VIDEO_FORMAT_I420);
  fail_unless_equals_int(GST_VIDEO_INFO_WIDTH(&info), 1000); // as in the paper's films
  fail_unless_equals_int(GST_VIDEO_INFO_HEIGHT(&info), 1000);
  fail_unless_equals_int(GST_VIDEO_INFO_FPS_N(&info), 30);
  fail_unless_equals_int(GST_VIDEO_INFO_FPS_D(&info), 1);
  fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), 0);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(buffer), GST_SECOND / 30);
  gst_buffer_unref(buffer);
  gst_caps_unref(caps);
  gst_harness_teardown(h);
}

CHECK_TEST(test_same_seed_same_film)
{
  for (const std::string pattern : { "pattern=static-motion", "pattern=dynamic-motion" }) {
    const auto film_frames = play(pattern + " seed=3 noise=2 num-buffers=60");
    fail_unless_equals_int(film_frames.size(), 60);
    fail_unless(film_frames == play(pattern + " seed=3 noise=2 num-buffers=60"));
    fail_if(film_frames == play(pattern + " seed=4 noise=2 num-buffers=60"));
    fail_if(film_frames == play(pattern + " seed=3 noise=1 num-buffers=60"));
  }
  fail_if(play("seed=3 num-buffers=60") == play("seed=3 num-buffers=60 pattern=dynamic-motion"));
  fail_if(play("seed=3 num-buffers=60") == play("seed=3 num-buffers=60 ball-size=0.2"));
}

CHECK_TEST(test_targets_are_where_the_balls_are)
{
  const GstVideoFormat format = GST_VIDEO_FORMAT_GRAY8;
  for (const std::string pattern : { "static-motion", "dynamic-motion" })
    for (const auto &[width, height] : { std::pair{ 320, 200 }, { 201, 333 } }) {
      const std::string caps = "video/x-raw,format=GRAY8,framerate=10/1,width="
                               + std::to_string(width) + ",height=" + std::to_string(height);
      GstVideoInfo info;
      gst_video_info_set_format(&info, format, static_cast<guint>(width),
                                static_cast<guint>(height));
      const int stride = GST_VIDEO_INFO_PLANE_STRIDE(&info, 0);
      int checked = 0;
      for (const auto &[time, frame] :
           play("ball-size=0.1 num-buffers=200 seed=5 pattern=" + pattern, caps)) {
        const double background = frame.bytes[0];
        double outside = 0;
        std::array<double, 2> share{};
        std::array<double, 2> sum_x{};
        std::array<double, 2> sum_y{};
        for (int y = 0; y < height; y++)
          for (int x = 0; x < width; x++) {
            const double difference
                = std::abs(frame.bytes[static_cast<std::size_t>(y * stride + x)] - background);
            bool inside = false;
            for (const Target &target : frame.targets) {
              const auto ux = static_cast<guint>(x);
              const auto uy = static_cast<guint>(y);
              if (ux < target.x || ux >= target.x + target.width || uy < target.y
                  || uy >= target.y + target.height)
                continue;
              inside = true;
              const auto i = static_cast<std::size_t>(target.ball);
              share[i] += difference;
              sum_x[i] += difference * (x + 0.5);
              sum_y[i] += difference * (y + 0.5);
            }
            if (!inside)
              outside += difference;
          }
        fail_unless(outside == 0);
        for (const Target &target : frame.targets) {
          const auto i = static_cast<std::size_t>(target.ball);
          fail_unless(share[i] > 0);
          fail_unless(std::abs(sum_x[i] / share[i] - (target.x + target.width / 2.0)) <= 0.5);
          fail_unless(std::abs(sum_y[i] / share[i] - (target.y + target.height / 2.0)) <= 0.5);
          fail_unless(std::abs(target.width - 0.1 * width) <= 2
                      && std::abs(target.height - 0.1 * width) <= 2);
          fail_unless(target.onset <= time);
          checked++;
        }
      }
      fail_unless(checked >= 190, "%d", checked);
    }
}

CHECK_TEST(test_onsets)
{
  for (const std::string pattern : { "static-motion", "dynamic-motion" }) {
    const auto frames = play("num-buffers=1500 balls=1 pattern=" + pattern,
                             "video/x-raw,format=GRAY8,width=400,height=400,framerate=50/1");
    constexpr GstClockTime kFrame = 20 * GST_MSECOND;
    const Frame *last = nullptr;
    int events = 0;
    for (const auto &[time, frame] : frames) {
      if (last != nullptr && !frame.targets.empty()) {
        const Target &now = frame.targets[0];
        const bool same = last->bytes == frame.bytes;
        if (pattern == "static-motion") {
          fail_if(now.moving);
          fail_unless_equals_int(same,
                                 last->targets.size() == 1 && now.onset == last->targets[0].onset);
        } else if (!last->targets.empty()) {
          if (!now.moving && !last->targets[0].moving)
            fail_unless(same);
          if (now.moving && last->targets[0].moving)
            fail_if(same);
        }
        if (last->targets.empty()
            || now.onset != last->targets[0].onset) { // it happened between the two frames
          fail_unless(now.onset <= time && now.onset + kFrame > time);
          events++;
        }
      }
      last = &frame;
    }
    fail_unless(events >= 5, "%d", events);
  }
}

CHECK_TEST(test_motion_at_any_frame_rate)
{
  const auto slow = play("pattern=dynamic-motion num-buffers=40",
                         "video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1");
  const auto fast = play("pattern=dynamic-motion num-buffers=200",
                         "video/x-raw,format=GRAY8,width=160,height=120,framerate=50/1");
  int common = 0;
  for (const auto &[time, frame] : slow) {
    fail_unless_equals_uint64(frame.duration, GST_SECOND / 10);
    const auto same = fast.find(time);
    fail_unless(same != fast.end());
    fail_unless(same->second.bytes == frame.bytes && same->second.targets == frame.targets);
    common++;
  }
  fail_unless_equals_int(common, 40);

  // A variable frame rate counts as 30.
  const auto variable
      = play("num-buffers=5", "video/x-raw,format=GRAY8,width=16,height=16,framerate=0/1");
  fail_unless_equals_uint64(variable.rbegin()->first, 4 * GST_SECOND / 30);

  // Times do not accumulate errors.
  TestSource ntsc("num-buffers=1001",
                  "video/x-raw,format=GRAY8,width=1,height=1,framerate=30000/1001");
  ntsc.play_to_the_end();
  for (std::size_t i = 0; i < ntsc.order.size(); i++)
    fail_unless_equals_uint64(ntsc.order[i], gst_util_uint64_scale(i, 1001 * GST_SECOND, 30000));
}

static void
seek(TestSource &film, gdouble rate, GstClockTime start, GstClockTime stop)
{
  change_state(film.pipeline, GST_STATE_PAUSED);
  film.order.clear();
  film.frames.clear();
  seek_exactly(film.pipeline, rate, start, stop);
  film.play_to_the_end();
}

CHECK_TEST(test_seek_equals_direct_play)
{
  const std::string properties = "pattern=dynamic-motion seed=9 noise=1";
  const auto direct = play(properties + " num-buffers=150");
  TestSource film(properties);
  seek(film, 1.0, 3 * GST_SECOND, 4 * GST_SECOND);
  fail_unless_equals_int(film.order.size(), 30);
  fail_unless_equals_uint64(film.order.front(), 3 * GST_SECOND);
  for (const auto &[time, frame] : film.frames)
    fail_unless(direct.at(time) == frame);

  // Between two frames: the one that is shown at that time.
  TestSource between(properties);
  seek(between, 1.0, 3 * GST_SECOND + 10 * GST_MSECOND, 4 * GST_SECOND);
  fail_unless_equals_uint64(between.order.front(), 3 * GST_SECOND);

  // At twice the rate.
  TestSource fast(properties);
  seek(fast, 2.0, 2 * GST_SECOND, 3 * GST_SECOND);
  fail_unless_equals_int(fast.order.size(), 30);
}

CHECK_TEST(test_backwards)
{
  const std::string properties = "pattern=dynamic-motion seed=9";
  const auto direct = play(properties + " num-buffers=150");
  TestSource film(properties);
  seek(film, -1.0, 3 * GST_SECOND, 4 * GST_SECOND);
  fail_unless_equals_int(film.order.size(), 30);
  fail_unless_equals_uint64(film.order.back(), 3 * GST_SECOND);
  for (std::size_t i = 1; i < film.order.size(); i++)
    fail_unless(film.order[i] < film.order[i - 1]);
  for (const auto &[time, frame] : film.frames)
    fail_unless(direct.at(time) == frame);

  // Back to the beginning, and no further.
  TestSource whole(properties);
  seek(whole, -1.0, 0, GST_SECOND / 2);
  fail_unless_equals_int(whole.order.size(), 15);
  fail_unless_equals_uint64(whole.order.back(), 0);
}

CHECK_TEST(test_duration)
{
  TestSource film("num-buffers=75", "video/x-raw,format=GRAY8,width=8,height=8,framerate=25/1");
  change_state(film.pipeline, GST_STATE_PAUSED);
  gint64 duration = 0;
  fail_unless(gst_element_query_duration(film.pipeline, GST_FORMAT_TIME, &duration));
  fail_unless_equals_int64(duration, 3 * GST_SECOND);

  TestSource endless("");
  change_state(endless.pipeline, GST_STATE_PAUSED);
  fail_if(gst_element_query_duration(endless.pipeline, GST_FORMAT_TIME, &duration)
          && duration >= 0);
}

CHECK_TEST(test_formats_show_the_same)
{
  // Every format against RGB, by GStreamer's own converter. Chroma subsampling changes edges.
  for (const auto &[width, height] : { std::pair{ 64, 48 }, { 65, 47 }, { 1300, 720 } })
    for (const std::string format : { "I420", "NV12", "GRAY8", "BGRx", "RGB" }) {
      const std::string size = ",width=" + std::to_string(width)
                               + ",height=" + std::to_string(height) + ",framerate=1/2";
      const std::string target = format == "GRAY8" ? "GRAY8" : "RGB";
      const auto frame_of = [&](const std::string &native) {
        const std::string launch
            = "tactiletestsrc seed=2 balls=1 ball-size=0.3 num-buffers=2 ! video/x-raw,format="
              + native + size + " ! videoconvert";
        GstHarness *h
            = make_harness(launch.c_str(), ("video/x-raw,format=" + target + size).c_str());
        gst_buffer_unref(gst_harness_pull(h)); // the empty first frame
        GstBuffer *buffer = gst_harness_pull(h);
        std::vector<guint8> bytes = bytes_of(buffer);
        gst_buffer_unref(buffer);
        gst_harness_teardown(h);
        return bytes;
      };
      const std::vector<guint8> native = frame_of(format);
      const std::vector<guint8> rgb = frame_of("RGB");
      fail_unless_equals_int(native.size(), rgb.size());
      std::size_t far = 0;
      std::size_t colored = 0;
      const auto row = static_cast<std::size_t>(target == "RGB" ? 3 * width : width); // bytes
      for (std::size_t i = 0; i < rgb.size(); i++) {
        if (i % GST_ROUND_UP_4(row) >= row) // padding
          continue;
        far += std::abs(native[i] - rgb[i]) > 4;
        colored += std::abs(rgb[i] - rgb[0]) > 20;
      }
      fail_unless(colored > rgb.size() / 50);
      const double edge = 12.0 / (0.3 * width); // a ring around the ball, as a share of its pixels
      fail_unless(static_cast<double>(far) < edge * static_cast<double>(colored),
                  "%s %d: %zu of %zu", format.c_str(), width, far, colored);
    }
}

CHECK_TEST(test_colors)
{
  // R'G'B' 119 for each matrix and range, by hand: gray has no chroma, and Y' = 16 + 219 · 119/255
  // = 118.2.
  for (const auto &[caps, luma] :
       { std::pair{ "video/x-raw,format=I420,width=8,height=8,colorimetry=bt601", 118 },
         { "video/x-raw,format=I420,width=8,height=8,colorimetry=bt709", 118 },
         { "video/x-raw,format=I420,width=8,height=8,colorimetry=1:4:0:0", 119 },
         { "video/x-raw,format=RGB,width=8,height=8", 119 } }) {
    const auto frames = play("num-buffers=1", caps);
    fail_unless_equals_int(frames.begin()->second.bytes[0], luma);
  }
  const auto frames = play("num-buffers=1", "video/x-raw,format=I420,width=8,height=8");
  fail_unless_equals_int(frames.begin()->second.bytes[8 * 8], 128);
}

CHECK_TEST(test_noise)
{
  const auto still = play("noise=4 num-buffers=2", "video/x-raw,format=GRAY8,width=512,height=256");
  const auto plain = play("num-buffers=1", "video/x-raw,format=GRAY8,width=512,height=256");
  const double luma = plain.at(0).bytes[0];
  std::vector<double> earlier;
  double product = 0;
  for (const auto &[time, frame] : still) {
    double squares = 0;
    for (std::size_t i = 0; i < frame.bytes.size(); i++) {
      const double v = frame.bytes[i] - luma;
      squares += v * v;
      if (time == 0)
        earlier.push_back(v);
      else
        product += v * earlier[i];
    }
    fail_unless(std::abs(std::sqrt(squares / static_cast<double>(frame.bytes.size())) - 4) < 0.1);
  }
  const double covariance = product / static_cast<double>(earlier.size());
  fail_unless(std::abs(covariance) < 0.2, "%g", covariance); // independent from frame to frame
}

CHECK_TEST(test_any_size)
{
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 1, 7 }, { 7, 1 }, { 3, 3 }, { 1921, 17 } })
    for (const std::string format : { "I420", "NV12", "GRAY8", "BGRx", "RGB" }) {
      const auto frames = play("noise=1 num-buffers=3 pattern=dynamic-motion",
                               "video/x-raw,framerate=1/1,format=" + format + ",width="
                                   + std::to_string(width) + ",height=" + std::to_string(height));
      fail_unless_equals_int(frames.size(), 3);
      for (const Target &target : frames.rbegin()->second.targets) {
        fail_unless(target.width >= 1 && target.height >= 1);
        fail_unless(target.x + target.width <= static_cast<guint>(width)
                    && target.y + target.height <= static_cast<guint>(height));
      }
    }
}

CHECK_TEST(test_renegotiation)
{
  // A change of the frame rate does not move the film's time.
  TestSource film(
      "num-buffers=20",
      "capsfilter name=filter caps=video/x-raw,format=GRAY8,width=16,height=16,framerate=10/1");
  GstElement *filter = gst_bin_get_by_name(GST_BIN(film.pipeline), "filter");
  film.after_frame = [&](std::size_t frames) {
    if (frames == 5)
      gst_util_set_object_arg(G_OBJECT(filter), "caps",
                              "video/x-raw,format=RGB,width=32,height=32,framerate=50/1");
  };
  film.play_to_the_end();
  fail_unless_equals_int(film.order.size(), 20);
  GstClockTime expected = 0;
  std::size_t large = 0;
  for (const GstClockTime time : film.order) {
    const Frame &frame = film.frames.at(time);
    fail_unless_equals_uint64(time, expected);
    expected += frame.duration;
    const bool before = frame.bytes.size() == 16 * 16;
    fail_unless(before || frame.bytes.size() == 32 * 32 * 3);
    fail_unless_equals_uint64(frame.duration, (before ? 100 : 20) * GST_MSECOND);
    large += !before;
  }
  fail_unless(large >= 14);
  gst_object_unref(filter);
}

CHECK_TEST(test_properties_while_playing)
{
  TestSource film("balls=1 num-buffers=20",
                  "video/x-raw,format=GRAY8,width=200,height=200,framerate=1/2");
  GstElement *source = gst_bin_get_by_name(GST_BIN(film.pipeline), "source");
  film.after_frame = [&](std::size_t frames) {
    if (frames == 5) {
      g_object_set(source, "balls", 2, "ball-size", 0.2, "noise", 3.0, "seed", 8, nullptr);
      gst_util_set_object_arg(G_OBJECT(source), "pattern", "dynamic-motion");
    }
  };
  film.play_to_the_end();
  for (std::size_t i = 1; i < 20; i++) {
    const std::vector<Target> &found = film.frames.at(film.order[i]).targets;
    fail_unless_equals_int(found.size(), i < 5 ? 1 : 2);
    fail_unless(i < 5 ? found[0].width <= 14 : found[0].width >= 40 && found[0].width <= 42);
  }

  gint pattern = 0;
  guint seed = 0;
  gint count = 0;
  gdouble noise = 0;
  gdouble size = 0;
  gboolean live = TRUE;
  g_object_get(source, "pattern", &pattern, "seed", &seed, "balls", &count, "noise", &noise,
               "ball-size", &size, "is-live", &live, nullptr);
  fail_unless(pattern == 1 && seed == 8 && count == 2 && noise == 3.0 && size == 0.2 && !live);
  gst_object_unref(source);
}

CHECK_TEST(test_live_by_the_clock)
{
  GstHarness *h = gst_harness_new_parse("tactiletestsrc is-live=true");
  gst_harness_set_sink_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=10/1");
  gst_harness_use_testclock(h);
  gst_harness_play(h);
  for (guint i = 0; i < 3; i++) {
    fail_unless(gst_harness_crank_single_clock_wait(h)); // a frame is made when its time comes
    GstBuffer *buffer = gst_harness_pull(h);
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), i * 100 * GST_MSECOND);
    gst_buffer_unref(buffer);
  }
  fail_unless_equals_uint64(gst_clock_get_time(GST_ELEMENT_CLOCK(h->element)), 200 * GST_MSECOND);
  gst_harness_teardown(h);
}

CHECK_TEST(test_absurd_size)
{
  GstElement *pipeline = make_pipeline(
      "tactiletestsrc ! video/x-raw,format=BGRx,width=2147483647,height=2147483647 ! fakesink");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus *bus = gst_element_get_bus(pipeline);
  GstMessage *message = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_MAIN(tactiletestsrc)
