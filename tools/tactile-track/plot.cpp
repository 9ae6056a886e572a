// SPDX-License-Identifier: LGPL-2.1-or-later
//
// plot: a track over time, a lane for each cell, frames of its film above.
#include "commands.h"

#include "film/film.h"
#include "film/picture.h"
#include "film/pipeline.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <cairo.h>
#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

constexpr double kWidth = 1200;
constexpr double kMargin = 12;
constexpr double kLabels = 44;
constexpr double kAxis = 24;
constexpr int kFrames = 8;

/// A decoded frame as a picture.
Surface
picture_of(GstSample *sample)
{
  GstVideoInfo info;
  GstVideoFrame frame;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample))
      || !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return nullptr;
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, info.width, info.height));
  auto *pixels = cairo_image_surface_get_data(surface.get());
  for (int row = 0; row < info.height; row++)
    std::memcpy(pixels + std::ptrdiff_t{ row } * cairo_image_surface_get_stride(surface.get()),
                static_cast<const guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0))
                    + std::ptrdiff_t{ row } * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0),
                static_cast<std::size_t>(info.width) * 4);
  cairo_surface_mark_dirty(surface.get());
  gst_video_frame_unmap(&frame);
  return surface;
}

/// Frames from the middle of kFrames equal parts of a film that lasts `end`; null where none can be
/// decoded.
std::vector<Surface>
frames_of(const Film &film, tactile::Time end, int width, int height)
{
  const Pipeline pipeline = make_pipeline(
      film_source(film) + " film. ! videoconvert ! videoscale ! video/x-raw,format=BGRx,width="
      + std::to_string(width) + ",height=" + std::to_string(height)
      + ",pixel-aspect-ratio=1/1 ! appsink name=frames sync=false max-buffers=1");
  const Owned<GstElement> sink = element(pipeline, "frames");
  gst_element_set_state(pipeline.get(), GST_STATE_PAUSED);
  std::vector<Surface> frames;
  for (int i = 0; i < kFrames; i++) {
    frames.emplace_back();
    if (gst_element_get_state(pipeline.get(), nullptr, nullptr, 10 * GST_SECOND)
        != GST_STATE_CHANGE_SUCCESS)
      continue;
    gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME,
                            static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE),
                            end.count() * (2L * i + 1) / (2L * kFrames));
    if (GstSample *sample
        = gst_app_sink_try_pull_preroll(GST_APP_SINK(sink.get()), 10 * GST_SECOND)) {
      frames.back() = picture_of(sample);
      gst_sample_unref(sample);
    }
  }
  gst_element_set_state(pipeline.get(), GST_STATE_NULL);
  return frames;
}

/// A round number of seconds between ticks, at most a dozen of them.
double
tick_of(double length)
{
  for (const double tick : { 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0 })
    if (length / tick <= 12)
      return tick;
  return 3600;
}

class Plot
{
public:
  Plot(const tactile::Track &track, int frame_height)
      : track_(track), cells_(track.rows() * track.columns()),
        lane_(std::clamp(360.0 / cells_, 2.0, 28.0)),
        top_(kMargin + (frame_height > 0 ? frame_height + kMargin : 0)),
        length_(std::max(std::chrono::duration<double>(track.end()).count(), 1e-3))
  {
  }

  double height() const
  {
    return top_ + lane_ * cells_ + kAxis + kMargin;
  }

  void draw(cairo_t *cairo, const std::vector<Surface> &frames) const
  {
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    const double step = (kWidth - kLabels - kMargin) / kFrames;
    for (std::size_t i = 0; i < frames.size(); i++)
      if (frames[i]) {
        cairo_set_source_surface(cairo, frames[i].get(), kLabels + static_cast<double>(i) * step,
                                 kMargin);
        cairo_paint(cairo);
      }
    draw_lanes(cairo);
    draw_axis(cairo);
  }

private:
  double x(tactile::Time time) const
  {
    return kLabels
           + std::chrono::duration<double>(time).count() / length_ * (kWidth - kLabels - kMargin);
  }

  void draw_lanes(cairo_t *cairo) const
  {
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, 11);
    for (int cell = 0; cell < cells_; cell++) {
      const double y = top_ + lane_ * cell;
      cairo_set_source_rgb(cairo, 0.95, 0.95, 0.95);
      cairo_rectangle(cairo, kLabels, y, kWidth - kLabels - kMargin, lane_ - 1);
      cairo_fill(cairo);
      if (lane_ >= 10) {
        const std::string label = "r" + std::to_string(cell / track_.columns()) + "c"
                                  + std::to_string(cell % track_.columns());
        cairo_set_source_rgb(cairo, 0.2, 0.2, 0.2);
        cairo_move_to(cairo, kMargin, y + lane_ / 2 + 4);
        cairo_show_text(cairo, label.c_str());
      }
      draw_lane(cairo, static_cast<std::size_t>(cell), y);
    }
  }

  void draw_lane(cairo_t *cairo, std::size_t cell, double y) const
  {
    const auto &entries = track_.entries();
    for (std::size_t i = 0; i < entries.size(); i++) {
      const auto level = static_cast<double>(entries[i].map.levels[cell]);
      if (level <= 0)
        continue;
      const double begin = x(entries[i].time);
      const double end = x(i + 1 < entries.size() ? entries[i + 1].time : track_.end());
      cairo_set_source_rgba(cairo, 0.85, 0.33, 0.1, 0.15 + 0.85 * level);
      cairo_rectangle(cairo, begin, y, std::max(end - begin, 0.5), lane_ - 1);
      cairo_fill(cairo);
    }
  }

  void draw_axis(cairo_t *cairo) const
  {
    const double y = top_ + lane_ * cells_;
    const double tick = tick_of(length_);
    cairo_set_source_rgb(cairo, 0.2, 0.2, 0.2);
    cairo_set_line_width(cairo, 1);
    for (int i = 0; i * tick <= length_; i++) {
      const double at = x(tactile::Time(std::llround(i * tick * 1e9)));
      cairo_move_to(cairo, at, y);
      cairo_line_to(cairo, at, y + 4);
      cairo_stroke(cairo);
      gchar text[32];
      g_snprintf(text, sizeof text, "%g s", i * tick);
      cairo_move_to(cairo, at + 2, y + 15);
      cairo_show_text(cairo, text);
    }
  }

  const tactile::Track &track_;
  int cells_;
  double lane_;
  double top_;
  double length_;
};

} // namespace

int
plot(int argc, char **argv)
{
  TextOption output;
  TextOption film_name;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The picture to write or replace: .png or .svg"), "FILE" },
    { "film", 0, 0, G_OPTION_ARG_FILENAME, &film_name.value,
      N_("Draw frames of this film above the track"), "FILM" },
    {},
  };
  const std::vector<std::string> names
      = parse_options(argc, argv, entries, common,
                      { .arguments = "TRACK -o PICTURE",
                        .summary = N_("Draws a track over time: each cell has a lane, which is "
                                      "darker where the level is higher."),
                        .least = 1,
                        .most = 1 });
  const std::string out = output.text();
  if (!is_picture_name(out))
    throw UsageError(_("expected -o PICTURE that ends in .png or .svg"));
  const tactile::Track track = or_throw(tactile::read_track_file(names[0]));

  std::vector<Surface> frames;
  int frame_height = 0;
  if (film_name.is_set()) {
    gst_init(nullptr, nullptr);
    const Film film = discover_film(film_name.text());
    const int width = static_cast<int>((kWidth - kLabels - kMargin) / kFrames - 4);
    frame_height = std::clamp(width * film.height / std::max(film.width, 1), 1, 4 * width);
    frames = frames_of(film, track.end(), width, frame_height);
  }
  const Plot drawing(track, frame_height);
  write_picture(out, kWidth, drawing.height(), 1,
                [&](cairo_t *cairo) { drawing.draw(cairo, frames); });
  return 0;
}
