// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pictures.h"

#include "calibration/tactor_calibration.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <span>

namespace {

struct Color
{
  double red;
  double green;
  double blue;
};
constexpr Color kBlack{ 0, 0, 0 };
constexpr Color kBlue{ 0.12, 0.44, 0.71 };
constexpr Color kRed{ 0.75, 0.19, 0.13 };
constexpr Color kGray{ 0.69, 0.69, 0.69 };
constexpr Color kGrid{ 0.93, 0.93, 0.93 };
constexpr double kDashes[] = { 5, 3 };
constexpr double kDots[] = { 2, 3 };
constexpr double kStart = 0;
constexpr double kMiddle = 0.5;
constexpr double kEnd = 1;

struct Point
{
  double x;
  double y;
};

std::string
number(double value, const char *format)
{
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> buffer;
  return g_ascii_formatd(buffer.data(), static_cast<gint>(buffer.size()), format, value);
}

void
set_color(cairo_t *cairo, const Color &color)
{
  cairo_set_source_rgb(cairo, color.red, color.green, color.blue);
}

/// A white page with a title.
class Drawing
{
public:
  Drawing(cairo_t *cairo, const std::string &title) : cairo_(cairo)
  {
    set_color(cairo_, { 1, 1, 1 });
    cairo_paint(cairo_);
    cairo_select_font_face(cairo_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_, 12);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
    text({ kPictureWidth / 2, 18 }, title, kMiddle);
  }

  /// `place` is which part of the text is at the point: kStart, kMiddle or kEnd.
  void text(Point at, const std::string &what, double place = kStart)
  {
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_, what.c_str(), &extents);
    set_color(cairo_, kBlack);
    cairo_move_to(cairo_, at.x - place * extents.x_advance, at.y);
    cairo_show_text(cairo_, what.c_str());
  }

  void line(std::span<const Point> points, const Color &color, double width = 1,
            std::span<const double> dashes = {})
  {
    set_color(cairo_, color);
    cairo_set_line_width(cairo_, width);
    cairo_set_dash(cairo_, dashes.data(), static_cast<int>(dashes.size()), 0);
    cairo_new_path(cairo_);
    for (const Point &point : points)
      cairo_line_to(cairo_, point.x, point.y);
    cairo_stroke(cairo_);
  }

  void dot(Point at, const Color &color)
  {
    set_color(cairo_, color);
    cairo_new_path(cairo_);
    cairo_arc(cairo_, at.x, at.y, 2.5, 0, 2 * std::numbers::pi);
    cairo_fill(cairo_);
  }

private:
  cairo_t *cairo_;
};

/// Two linear axes with ticks; maps values to points of the picture.
class Axes
{
public:
  Axes(Drawing &drawing, Point least, Point most, double x_tick, double y_tick,
       const std::string &x_label, const std::string &y_label)
      : least_(least), most_(most)
  {
    for (double x = std::ceil(least.x / x_tick) * x_tick; x <= most.x + 1e-9; x += x_tick) {
      const std::array grid{ at({ x, least.y }), at({ x, most.y }) };
      drawing.line(grid, kGrid);
      drawing.text({ grid[0].x, kBottom + 16 }, number(std::abs(x) < 1e-9 ? 0 : x, "%.4g"),
                   kMiddle);
    }
    for (double y = std::ceil(least.y / y_tick) * y_tick; y <= most.y + 1e-9; y += y_tick) {
      const std::array grid{ at({ least.x, y }), at({ most.x, y }) };
      drawing.line(grid, kGrid);
      drawing.text({ kLeft - 6, grid[0].y + 4 }, number(std::abs(y) < 1e-9 ? 0 : y, "%.4g"), kEnd);
    }
    drawing.text({ (kLeft + kRight) / 2, kPictureHeight - 6 }, x_label, kMiddle);
    drawing.text({ 6, 34 }, y_label);
  }

  Point at(Point value) const
  {
    return { std::lerp(kLeft, kRight, (value.x - least_.x) / (most_.x - least_.x)),
             std::lerp(kBottom, kTop, (value.y - least_.y) / (most_.y - least_.y)) };
  }

private:
  static constexpr double kLeft = 60;
  static constexpr double kRight = kPictureWidth - 16;
  static constexpr double kTop = 42;
  static constexpr double kBottom = kPictureHeight - 40;

  Point least_;
  Point most_;
};

/// A round distance for about five ticks.
double
tick(double range)
{
  const double power = std::pow(10, std::floor(std::log10(std::max(range, 1e-12) / 5)));
  for (const double step : { 1.0, 2.0, 5.0 })
    if (range / (power * step) <= 6)
      return power * step;
  return power * 10;
}

std::string
volts(const tactor::Step &step)
{
  return number(step.start_volts, "%.2f") + " to " + number(step.target_volts, "%.2f") + " V";
}

} // namespace

void
draw_envelope(cairo_t *cairo, const tactor::StepResponse &response,
              const tactor::StepEnvelope &envelope)
{
  Drawing drawing(cairo, "Tactor " + std::to_string(response.step.tactor) + ", "
                             + volts(response.step) + ": 90 % after "
                             + number(response.risen_ms, "%.1f") + " ms, first motion after "
                             + number(response.onset_ms, "%.1f") + " ms");
  const double from = -0.1;
  const double to = std::max(0.3, 2.2 * response.risen_ms / 1e3);
  const double most = 1.3 * response.steady;
  const Axes axes(drawing, { from, -most }, { to, most }, tick(to - from), tick(2 * most),
                  "time after the command, s", "amplitude");
  std::vector<Point> raw;
  std::vector<Point> amplitude;
  for (std::size_t i = 0; i < envelope.raw.size(); i++) {
    const double at = envelope.first_s + static_cast<double>(i) / envelope.rate;
    if (at < from || at > to)
      continue;
    raw.push_back(axes.at({ at, std::clamp(envelope.raw[i], -most, most) }));
    amplitude.push_back(axes.at({ at, std::min(envelope.amplitude[i], most) }));
  }
  drawing.line(raw, kGray, 0.7);
  drawing.line(amplitude, kBlue, 2);
  const double goal = 0.9 * response.steady;
  const double risen = response.risen_ms / 1e3;
  const std::array level{ axes.at({ from, goal }), axes.at({ risen, goal }),
                          axes.at({ risen, -most }) };
  drawing.line(level, kRed, 1, kDashes);
  const std::array command{ axes.at({ 0, -most }), axes.at({ 0, most }) };
  drawing.line(command, kBlack);
  const double onset = response.onset_ms / 1e3;
  const std::array motion{ axes.at({ onset, -most }), axes.at({ onset, most }) };
  drawing.line(motion, kBlack, 1, kDots);
  drawing.text({ axes.at({ from, goal }).x + 4, level[0].y - 4 }, "90 %");
}

void
draw_surface(cairo_t *cairo, const tactor::TactorCalibration &tactor,
             const std::vector<tactor::StepResponse> &responses)
{
  const std::vector<tactor::RiseTimeSample> rises = tactor::rise_time_samples(responses, tactor);
  double volts_max = 1;
  double most = 50;
  for (const tactor::RiseTimeSample &rise : rises) {
    volts_max = std::max(volts_max, rise.target_volts);
    most = std::max(most, rise.milliseconds);
  }
  // Start voltage to the right and back, offset to the left and back, time upwards.
  const auto place = [&](double start, double offset, double ms) {
    return Point{ 320 + (start - offset) / volts_max * 250,
                  330 - (start + offset) / volts_max * 110 - ms / (1.15 * most) * 180 };
  };
  Drawing drawing(cairo, tactor.quadratic ? "Rise time: measured, and the quadratic; R² = "
                                                + number(tactor.quadratic->r_squared, "%.3f")
                                          : "Rise time: measured");
  const std::array<std::array<Point, 2>, 3> edges{ { { place(0, 0, 0), place(volts_max, 0, 0) },
                                                     { place(0, 0, 0), place(0, volts_max, 0) },
                                                     { place(0, volts_max, 0),
                                                       place(0, volts_max, most) } } };
  for (const auto &edge : edges)
    drawing.line(edge, kBlack);
  for (double ms = 0; ms <= most; ms += tick(most))
    drawing.text({ place(0, volts_max, ms).x - 6, place(0, volts_max, ms).y + 4 },
                 number(ms, "%.0f") + (ms == 0 ? " ms" : ""), kEnd);
  for (double v = 0.5; v <= volts_max; v += 0.5) {
    drawing.text({ place(v, 0, 0).x + 6, place(v, 0, 0).y + 12 }, number(v, "%.1f"));
    drawing.text({ place(0, v, 0).x - 6, place(0, v, 0).y + 12 }, number(v, "%.1f"), kEnd);
  }
  drawing.text({ 480, 345 }, "start voltage, V");
  drawing.text({ 160, 345 }, "offset, V", kEnd);
  if (tactor.quadratic) {
    const auto wire = [&](const std::function<Point(double, double)> &at) {
      for (double fixed = 0; fixed < volts_max - 0.1; fixed += 0.25) {
        std::vector<Point> points;
        for (double moving = 0; moving <= volts_max - fixed + 1e-9; moving += 0.05)
          points.push_back(at(fixed, moving));
        drawing.line(points, kBlue, 0.6);
      }
    };
    const auto height = [&](double s, double d) {
      return std::clamp((*tactor.quadratic)(s, d), 0.0, 1.15 * most);
    };
    wire([&](double s, double d) { return place(s, d, height(s, d)); });
    wire([&](double d, double s) { return place(s, d, height(s, d)); });
  }
  for (const tactor::RiseTimeSample &rise : rises)
    drawing.dot(place(rise.start_volts, rise.target_volts - rise.start_volts, rise.milliseconds),
                kRed);
}

void
draw_residuals(cairo_t *cairo, const tactor::TactorCalibration &tactor,
               const std::vector<tactor::StepResponse> &responses)
{
  const std::vector<tactor::RiseTimeSample> rises = tactor::rise_time_samples(responses, tactor);
  double volts_max = 1;
  for (const tactor::RiseTimeSample &rise : rises)
    volts_max = std::max(volts_max, rise.target_volts);
  std::vector<Point> of_quadratic;
  std::vector<Point> of_table;
  double most = 1;
  for (const tactor::RiseTimeSample &rise : rises) {
    const double s = rise.start_volts;
    const double t = rise.target_volts;
    const double ms = rise.milliseconds;
    if (tactor.quadratic)
      of_quadratic.push_back({ t, ms - (*tactor.quadratic)(s, t - s) });
    if (tactor.table)
      of_table.push_back(
          { t, ms - static_cast<double>(tactor::RiseTime(*tactor.table)(s, t).count()) / 1e6 });
  }
  for (const auto *points : { &of_quadratic, &of_table })
    for (const Point &point : *points)
      most = std::max(most, std::abs(point.y));
  Drawing drawing(cairo, "Measured rise time less the quadratic (red) and less the table (blue)");
  const Axes axes(drawing, { 0, -1.1 * most }, { volts_max + 0.1, 1.1 * most }, 0.5, tick(2 * most),
                  "target voltage, V", "ms");
  for (const Point &point : of_quadratic)
    drawing.dot(axes.at(point), kRed);
  for (const Point &point : of_table)
    drawing.dot(axes.at({ point.x + 0.02, point.y }), kBlue);
}
