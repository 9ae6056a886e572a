// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How well do the maps follow the film? Plays the paper's synthetic films, whose balls are known,
// through saliencytactile and prints the metrics of docs/algorithm.md as a Markdown table:
//   (a) share of frames within 0.5 s of an onset or of movement whose strongest cell is one that a
//   ball touches (b) share of the map's energy in such cells (c) share of all-zero maps among
//   frames where nothing has moved for 2.2 s (d) frames from an onset to the first level above zero
//   in a cell that the ball touches (mean)
// With --check: exit status 1 if the tuned profile is below the floors that are written here.
#include <gst/gst.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace {

constexpr GstClockTime kEventSpan = 500 * GST_MSECOND;
constexpr GstClockTime kRestSpan = 2200 * GST_MSECOND;
constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kFps = 30;
constexpr int kFrames = 40 * kFps;
constexpr int kSeeds = 3;

/// What --check asks of the tuned profile on every film.
constexpr struct
{
  double a = 0.99;
  double b = 0.96;
  double c = 0.98;
  double d = 0.5;
} kFloors;

struct Scores
{
  double hits = 0, event_frames = 0;
  double energy_inside = 0, energy_frames = 0;
  double silent = 0, rest_frames = 0;
  double delay = 0, onsets = 0, never = 0;

  double a() const
  {
    return hits / event_frames;
  }
  double b() const
  {
    return energy_inside / energy_frames;
  }
  double c() const
  {
    return silent / rest_frames;
  }
  double d() const
  {
    return delay / onsets;
  }
};

/// Follows one film, frame by frame.
class Judge
{
public:
  explicit Judge(Scores &scores) : scores_(scores)
  {
  }

  ~Judge()
  {
    finish_onsets();
  }

  void frame(GstBuffer *buffer)
  {
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
    if (!meta)
      return;
    const GstClockTime time = GST_BUFFER_PTS(buffer);
    const std::size_t cells = static_cast<std::size_t>(meta->rows) * meta->columns;

    std::set<std::size_t> touched;
    gpointer state = nullptr;
    bool moving = false;
    std::map<int, GstClockTime> onsets;
    while (GstMeta *item = gst_buffer_iterate_meta_filtered(
               buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
      auto *roi = reinterpret_cast<GstVideoRegionOfInterestMeta *>(item);
      const GstStructure *target
          = gst_video_region_of_interest_meta_get_param(roi, "tactile-target");
      if (!target)
        continue;
      gint ball = 0;
      guint64 onset = 0;
      gboolean ball_moves = FALSE;
      gst_structure_get_int(target, "ball", &ball);
      gst_structure_get_uint64(target, "onset", &onset);
      gst_structure_get_boolean(target, "moving", &ball_moves);
      moving |= ball_moves;
      onsets[ball] = onset;
      for (guint r = roi->y * meta->rows / kHeight;
           r <= (roi->y + roi->h - 1) * meta->rows / kHeight; r++)
        for (guint c = roi->x * meta->columns / kWidth;
             c <= (roi->x + roi->w - 1) * meta->columns / kWidth; c++)
          touched.insert(r * meta->columns + c);
    }

    if (onsets != onsets_) {
      finish_onsets();
      // A ball that is there in the first frame is no onset.
      if (!first_)
        pending_ = 0;
      onsets_ = onsets;
      if (!first_)
        last_event_ = time;
    }
    if (moving)
      last_event_ = time;
    first_ = false;

    const std::span<const gfloat> levels(meta->levels, cells);
    double sum = 0;
    double inside = 0;
    for (std::size_t i = 0; i < cells; i++) {
      sum += levels[i];
      inside += touched.contains(i) ? levels[i] : 0;
    }
    if (pending_) {
      if (inside > 0) {
        scores_.delay += *pending_;
        scores_.onsets++;
        pending_.reset();
      } else {
        ++*pending_;
      }
    }
    if (last_event_ && time - *last_event_ <= kEventSpan) {
      scores_.event_frames++;
      const auto strongest
          = static_cast<std::size_t>(std::ranges::max_element(levels) - levels.begin());
      scores_.hits += sum > 0 && touched.contains(strongest);
      if (sum > 0) {
        scores_.energy_inside += inside / sum;
        scores_.energy_frames++;
      }
    }
    if (time - last_event_.value_or(0) >= kRestSpan) {
      scores_.rest_frames++;
      scores_.silent += sum == 0;
    }
  }

private:
  void finish_onsets()
  {
    if (!pending_)
      return;
    scores_.delay += *pending_; // never felt: as long as it lasted
    scores_.onsets++;
    scores_.never++;
    pending_.reset();
  }

  Scores &scores_;
  std::map<int, GstClockTime> onsets_;
  std::optional<double> pending_;
  std::optional<GstClockTime> last_event_;
  bool first_ = true;
};

bool
play(const std::string &line, Scores &scores)
{
  g_autoptr(GError) error = nullptr;
  GstElement *pipeline = gst_parse_launch(line.c_str(), &error);
  if (!pipeline || error) {
    std::fprintf(stderr, "%s: %s\n", line.c_str(), error->message);
    return false;
  }
  Judge judge(scores);
  GstElement *end = gst_bin_get_by_name(GST_BIN(pipeline), "end");
  GstPad *pad = gst_element_get_static_pad(end, "sink");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad *, GstPadProbeInfo *info, gpointer data) {
        static_cast<Judge *>(data)->frame(GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      &judge, nullptr);
  gst_object_unref(pad);
  gst_object_unref(end);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus *bus = gst_element_get_bus(pipeline);
  GstMessage *message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  const bool ok = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
  if (!ok) {
    gst_message_parse_error(message, &error, nullptr);
    std::fprintf(stderr, "%s: %s\n", line.c_str(), error->message);
  }
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return ok;
}

} // namespace

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  const bool check = argc > 1 && std::strcmp(argv[1], "--check") == 0;
  if (argc > 1 && !check) {
    std::fprintf(stderr, "usage: %s [--check]\n", argv[0]);
    return 2;
  }
  bool good = true;
  std::printf(
      "| film | profile | noise σ | (a) | (b) | (c) | (d) frames | onsets | never felt |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const char *pattern : { "static-motion", "dynamic-motion" })
    for (const char *profile : { "paper", "tuned" })
      for (const int noise : { 0, 2, 4 }) {
        // The floors are the tuned profile's, and the ends of the noise scale tell enough.
        if (check && (std::strcmp(profile, "paper") == 0 || noise == 2))
          continue;
        Scores scores;
        for (int seed = 1; seed <= (check ? 2 : kSeeds); seed++) {
          g_autofree gchar *line
              = g_strdup_printf("tactiletestsrc pattern=%s seed=%d noise=%d num-buffers=%d ! "
                                "video/x-raw,format=I420,width=%d,height=%d,framerate=%d/1 ! "
                                "saliencytactile profile=%s ! fakesink name=end",
                                pattern, seed, noise, kFrames, kWidth, kHeight, kFps, profile);
          if (!play(line, scores))
            return 1;
        }
        std::printf("| %s | %s | %d | %.3f | %.3f | %.3f | %.2f | %.0f | %.0f |\n", pattern,
                    profile, noise, scores.a(), scores.b(), scores.c(), scores.d(), scores.onsets,
                    scores.never);
        std::fflush(stdout);
        if (check)
          good &= scores.a() >= kFloors.a && scores.b() >= kFloors.b && scores.c() >= kFloors.c
                  && scores.d() <= kFloors.d;
      }
  if (!good)
    std::fprintf(stderr,
                 "tactile_quality: below the floors: (a) %.2f, (b) %.2f, (c) %.2f, (d) %.2f\n",
                 kFloors.a, kFloors.b, kFloors.c, kFloors.d);
  return good ? 0 : 1;
}
