// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Draws a track against the labels of its film: all of it over time, moments in which it is felt,
// or its worst moments. tests/quality/cinema_pictures.sh makes the pictures of docs/measured.
#include "decode.h"
#include "labels.h"
#include "random.h"

#include "film/or_throw.h"
#include "film/picture.h"
#include "tracks/formats/track_file.h"

#include <gst/gst.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string_view>
#include <utility>

using namespace quality;

namespace {

constexpr double kMargin = 10;
constexpr double kText = 11; ///< height of letters
constexpr double kLine = 14;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

void
set_font(cairo_t *cairo)
{
  cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, kText);
}

void
write_at(cairo_t *cairo, double x, double y, const std::string &text)
{
  cairo_set_source_rgb(cairo, 0.1, 0.1, 0.1);
  cairo_move_to(cairo, x, y);
  cairo_show_text(cairo, text.c_str());
}

/// In lines of at most `width`. Returns their number.
int
write_lines(cairo_t *cairo, double x, double y, double width, const std::string &text)
{
  std::istringstream words(text);
  std::string line;
  int lines = 0;
  const auto flush = [&] {
    write_at(cairo, x, y + lines++ * kLine, line);
  };
  for (std::string word; words >> word;) {
    const std::string longer = line.empty() ? word : line + " " + word;
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, longer.c_str(), &extents);
    if (!line.empty() && extents.width > width) {
      flush();
      line = word;
    } else {
      line = longer;
    }
  }
  flush();
  return lines;
}

// ---- a track over time --------------------------------------------------------------------------

constexpr double kWidth = 1200;
constexpr double kNames = 36; ///< of the lanes
constexpr double kTop = kMargin + kLine;
constexpr double kLane = 20;
constexpr int kCells = 9;

struct Shade
{
  const char *meaning;
  double red, green, blue;
};
constexpr Shade kFelt{ "to be felt here", 0.72, 0.90, 0.72 };
constexpr Shade kAllowed{ "may be felt here", 0.96, 0.94, 0.74 };
constexpr Shade kElsewhere{ "elsewhere", 0.97, 0.97, 0.97 };
constexpr Shade kQuiet{ "nothing to be felt", 0.86, 0.86, 0.86 };

void
fill(cairo_t *cairo, const Shade &shade, double x, double y, double width, double height)
{
  cairo_set_source_rgb(cairo, shade.red, shade.green, shade.blue);
  cairo_rectangle(cairo, x, y, width, height);
  cairo_fill(cairo);
}

const Shade &
shade_of(const Label &label, std::size_t cell)
{
  if (label.verdict == Verdict::quiet)
    return kQuiet;
  if (!label.cells[cell])
    return kElsewhere;
  return label.verdict == Verdict::felt ? kFelt : kAllowed;
}

void
draw_track(cairo_t *cairo, const tactile::Track &track, const std::vector<Label> &labels,
           const std::string &title)
{
  const double length = std::max({ seconds(track.end()), seconds(labels.back().end), 1.0 });
  const double scale = (kWidth - kNames - kMargin) / length;
  const auto x = [&](Time time) {
    return kNames + seconds(time) * scale;
  };

  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  set_font(cairo);
  write_at(cairo, kNames, kMargin + 3, title);
  double legend = kNames + 300;
  for (const Shade &shade : { kFelt, kAllowed, kElsewhere, kQuiet }) {
    fill(cairo, shade, legend, kMargin - 6, 16, 12);
    write_at(cairo, legend + 20, kMargin + 3, shade.meaning);
    legend += 150;
  }
  const auto &entries = track.entries();
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const double y = kTop + kLane * static_cast<double>(cell);
    write_at(cairo, 4, y + kLane / 2 + 4,
             "r" + std::to_string(cell / 3) + "c" + std::to_string(cell % 3));
    for (const Label &label : labels)
      fill(cairo, shade_of(label, cell), x(label.start), y, x(label.end) - x(label.start),
           kLane - 1);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const double level = static_cast<double>(entries[i].map.levels[cell]);
      if (level <= 0)
        continue;
      const double end = x(i + 1 < entries.size() ? entries[i + 1].time : track.end());
      cairo_set_source_rgba(cairo, 0.75, 0.10, 0.10, 0.25 + 0.75 * level);
      cairo_rectangle(cairo, x(entries[i].time), y + 4, end - x(entries[i].time), kLane - 9);
      cairo_fill(cairo);
    }
  }
  for (int second = 0; second <= length; second += 5)
    write_at(cairo, x(std::chrono::seconds(second)), kTop + kLane * kCells + kLine,
             std::to_string(second) + " s");
}

// ---- moments ------------------------------------------------------------------------------------

constexpr int kMoments = 10;
constexpr std::size_t kWorst = 20;
constexpr int kColumns = 5;
constexpr int kPictureWidth = 224;
constexpr int kTextLines = 4;

struct Moment
{
  Time time;
  cv::Mat picture{}; ///< CV_8UC4, a Cairo surface's bytes
};

/// One at random from each tenth of the time in which the track is felt, in order.
std::vector<Moment>
felt_moments(const tactile::Track &track)
{
  const auto &entries = track.entries();
  const auto duration = [&](std::size_t i) {
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    return tactile::is_silent(entries[i].map) ? Time(0) : end - entries[i].time;
  };
  Time felt{ 0 };
  for (std::size_t i = 0; i < entries.size(); ++i)
    felt += duration(i);
  std::vector<Moment> moments;
  Random random(1);
  for (int part = 0; felt.count() > 0 && part < kMoments; ++part) {
    Time rest(std::llround(random.uniform(part, part + 1) / kMoments
                           * static_cast<double>(felt.count())));
    std::size_t i = 0;
    while (i + 1 < entries.size() && rest >= duration(i))
      rest -= duration(i++);
    moments.push_back({ entries[i].time + rest });
  }
  return moments;
}

std::size_t
strongest_cell(const tactile::TactileMap &map)
{
  return static_cast<std::size_t>(std::ranges::max_element(map.levels) - map.levels.begin());
}

bool
is_wrong(const Label &label, const tactile::TactileMap &map)
{
  return label.verdict == Verdict::quiet || !label.cells[strongest_cell(map)];
}

/// The half seconds of the labels in which the track is worst, in order: the mean level of wrong
/// cells, and a level by the label's strength where it is to be felt and no right cell is.
std::vector<Moment>
worst_moments(const tactile::Track &track, const std::vector<Label> &labels)
{
  constexpr Time kHalf = std::chrono::milliseconds(500);
  constexpr int kSamples = 10;
  constexpr double kUsual = 2; ///< strength
  std::vector<std::pair<double, Moment>> halves;
  for (const Label &label : labels)
    for (Time start = label.start; start < std::min(label.end, track.end()); start += kHalf) {
      const Time step = (std::min({ label.end, track.end(), start + kHalf }) - start) / kSamples;
      bool right = false;
      double wrong = 0;
      float most = 0;
      Moment moment{ start + step * (kSamples / 2) };
      for (int i = 0; i < kSamples; ++i) {
        const tactile::TactileMap map = track.at(start + i * step);
        const float level = std::ranges::max(map.levels);
        if (level <= 0)
          continue;
        if (!is_wrong(label, map)) {
          right = true;
          continue;
        }
        wrong += static_cast<double>(level) / kSamples;
        if (level > most)
          moment.time = start + i * step;
        most = std::max(most, level);
      }
      if (label.verdict == Verdict::felt && !right)
        wrong += (label.strength > 0 ? label.strength : kUsual) / 3;
      if (wrong > 0)
        halves.emplace_back(wrong, moment);
    }
  std::ranges::stable_sort(halves, std::greater(), [](const auto &half) { return half.first; });
  std::vector<Moment> moments;
  for (std::size_t i = 0; i < std::min(kWorst, halves.size()); ++i)
    moments.push_back(halves[i].second);
  std::ranges::sort(moments, {}, &Moment::time);
  return moments;
}

/// Fewer shades make a PNG of half the size.
void
take_picture(const cv::Mat &bgr, Moment &moment)
{
  const int height = cvRound(static_cast<double>(bgr.rows) * kPictureWidth / bgr.cols);
  cv::Mat small;
  cv::resize(bgr, small, { kPictureWidth, height }, 0, 0, cv::INTER_AREA);
  cv::bitwise_and(small, cv::Scalar::all(0xF8), small);
  cv::add(small, cv::Scalar::all(0x04), small);
  cv::cvtColor(small, moment.picture, cv::COLOR_BGR2BGRA);
}

/// Of the frames that are shown then.
void
take_pictures(const std::string &film, std::vector<Moment> &moments)
{
  Decoder decoder(film, "decodebin", "BGR");
  auto moment = moments.begin();
  while (moment != moments.end() && decoder.next())
    for (; moment != moments.end() && moment->time < decoder.time() + decoder.duration(); ++moment)
      take_picture(as_mat(decoder.view()), *moment);
  if (moment != moments.end())
    throw std::runtime_error(film + ": ends before its track");
}

std::string
judgment(const Label &label, const tactile::TactileMap &map)
{
  if (tactile::is_silent(map))
    return label.verdict == Verdict::felt ? "missed" : "silent";
  if (is_wrong(label, map))
    return label.verdict == Verdict::quiet ? "wrong: nothing to be felt" : "wrong cell";
  return label.verdict == Verdict::felt ? "right" : "allowed";
}

void
draw_moment(cairo_t *cairo, const Moment &moment, const tactile::TactileMap &map,
            const std::vector<Label> &labels, double x, double y)
{
  const cv::Mat &picture = moment.picture;
  const Surface surface(cairo_image_surface_create_for_data(picture.data, CAIRO_FORMAT_RGB24,
                                                            picture.cols, picture.rows,
                                                            static_cast<int>(picture.step)));
  cairo_set_source_surface(cairo, surface.get(), x, y);
  cairo_paint(cairo);
  const double width = picture.cols / 3.0;
  const double height = picture.rows / 3.0;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const double level = static_cast<double>(map.levels[cell]);
    if (level <= 0)
      continue;
    const double line = 1 + 4 * level; // stays inside of the cell
    cairo_set_source_rgb(cairo, 1, 0.35, 0);
    cairo_set_line_width(cairo, line);
    cairo_rectangle(cairo, x + static_cast<double>(cell % 3) * width + line / 2,
                    y + static_cast<double>(cell / 3) * height + line / 2, width - line,
                    height - line);
    cairo_stroke(cairo);
  }
  char time[32];
  std::snprintf(time, sizeof time, "%.2f s, ", seconds(moment.time));
  const auto label
      = std::ranges::find_if(labels, [&](const Label &span) { return moment.time < span.end; });
  const double below = y + picture.rows + kLine;
  write_at(cairo, x, below, time + (label == labels.end() ? "not labeled" : judgment(*label, map)));
  if (label != labels.end())
    write_lines(cairo, x, below + kLine, picture.cols, label->what);
}

void
draw_moments(const std::string &out, const tactile::Track &track, const std::vector<Label> &labels,
             const std::string &film, std::vector<Moment> moments)
{
  if (moments.empty())
    throw std::runtime_error(film + ": no such moment");
  take_pictures(film, moments);
  const double step_x = kPictureWidth + kMargin;
  const double step_y = moments[0].picture.rows + kTextLines * kLine + kMargin;
  const auto rows = std::ceil(static_cast<double>(moments.size()) / kColumns);
  write_picture(out, kMargin + kColumns * step_x, kMargin + rows * step_y, 1, [&](cairo_t *cairo) {
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    set_font(cairo);
    for (std::size_t i = 0; i < moments.size(); ++i)
      draw_moment(cairo, moments[i], track.at(moments[i].time), labels,
                  kMargin + static_cast<double>(i % kColumns) * step_x,
                  kMargin + static_cast<double>(i / kColumns) * step_y);
  });
}

} // namespace

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  const bool worst = argc == 6 && std::string_view(argv[5]) == "worst";
  if (argc != 4 && argc != 5 && !worst) {
    std::fprintf(stderr,
                 "usage: track_picture TRACK LABELS PICTURE          all of the track over time\n"
                 "       track_picture TRACK LABELS PICTURE FILM     ten felt moments\n"
                 "       track_picture TRACK LABELS PICTURE FILM worst      the twenty worst\n"
                 "PICTURE ends in .png or .svg.\n");
    return 2;
  }
  cv::setNumThreads(1);
  try {
    const tactile::Track track = or_throw(tactile::read_track_file(argv[1]));
    if (track.rows() != 3 || track.columns() != 3)
      throw std::runtime_error(std::string(argv[1]) + ": expected 3 x 3 tactors");
    const std::vector<Label> labels = read_labels(argv[2]);
    if (labels.empty())
      throw std::runtime_error(std::string(argv[2]) + ": no labels in it");
    if (argc >= 5)
      draw_moments(argv[3], track, labels, argv[4],
                   worst ? worst_moments(track, labels) : felt_moments(track));
    else
      write_picture(argv[3], kWidth, kTop + kLane * kCells + 2 * kMargin, 1, [&](cairo_t *cairo) {
        draw_track(cairo, track, labels, std::filesystem::path(argv[1]).stem().string());
      });
    return 0;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "track_picture: %s\n", problem.what());
    return 1;
  }
}
