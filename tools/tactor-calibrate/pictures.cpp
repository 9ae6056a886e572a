// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pictures.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iterator>
#include <locale>
#include <span>
#include <sstream>

namespace {

constexpr double kWidth = 640;
constexpr double kHeight = 360;
constexpr const char *kBlue = "#1f6fb4";
constexpr const char *kRed = "#c03020";
constexpr const char *kGrey = "#b0b0b0";

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

/// An SVG document being written, the same in any locale.
class Drawing
{
public:
  explicit Drawing(const std::string &title)
  {
    document_.imbue(std::locale::classic());
    document_ << std::fixed << std::setprecision(1)
              << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << ' '
              << kHeight
              << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                 "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    text({ kWidth / 2, 18 }, title, "middle");
  }

  void text(Point at, const std::string &what, const char *anchor = "start")
  {
    g_autofree gchar *escaped = g_markup_escape_text(what.c_str(), -1);
    document_ << "<text x=\"" << at.x << "\" y=\"" << at.y << "\" text-anchor=\"" << anchor << "\">"
              << escaped << "</text>\n";
  }

  void line(std::span<const Point> points, const char *colour, double width = 1,
            const char *dashes = "none")
  {
    document_ << "<polyline fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << width
              << "\" stroke-dasharray=\"" << dashes << "\" points=\"";
    for (const Point &point : points)
      document_ << point.x << ',' << point.y << ' ';
    document_ << "\"/>\n";
  }

  void dot(Point at, const char *colour)
  {
    document_ << "<circle cx=\"" << at.x << "\" cy=\"" << at.y << "\" r=\"2.5\" fill=\"" << colour
              << "\"/>\n";
  }

  std::string finish()
  {
    document_ << "</svg>\n";
    return document_.str();
  }

private:
  std::ostringstream document_;
};

/// Two linear axes with ticks; maps values to places.
class Axes
{
public:
  Axes(Drawing &drawing, Point least, Point most, double x_tick, double y_tick,
       const std::string &x_label, const std::string &y_label)
      : least_(least), most_(most)
  {
    for (double x = std::ceil(least.x / x_tick) * x_tick; x <= most.x + 1e-9; x += x_tick) {
      const std::array grid{ at({ x, least.y }), at({ x, most.y }) };
      drawing.line(grid, "#eeeeee");
      drawing.text({ grid[0].x, kBottom + 16 }, number(std::abs(x) < 1e-9 ? 0 : x, "%.4g"),
                   "middle");
    }
    for (double y = std::ceil(least.y / y_tick) * y_tick; y <= most.y + 1e-9; y += y_tick) {
      const std::array grid{ at({ least.x, y }), at({ most.x, y }) };
      drawing.line(grid, "#eeeeee");
      drawing.text({ kLeft - 6, grid[0].y + 4 }, number(std::abs(y) < 1e-9 ? 0 : y, "%.4g"), "end");
    }
    drawing.text({ (kLeft + kRight) / 2, kHeight - 6 }, x_label, "middle");
    drawing.text({ 6, 34 }, y_label);
  }

  Point at(Point value) const
  {
    return { std::lerp(kLeft, kRight, (value.x - least_.x) / (most_.x - least_.x)),
             std::lerp(kBottom, kTop, (value.y - least_.y) / (most_.y - least_.y)) };
  }

private:
  static constexpr double kLeft = 60;
  static constexpr double kRight = kWidth - 16;
  static constexpr double kTop = 42;
  static constexpr double kBottom = kHeight - 40;

  Point least_;
  Point most_;
};

/// A round distance of ticks, some five of them.
double
tick(double range)
{
  const double power = std::pow(10, std::floor(std::log10(std::max(range, 1e-12) / 5)));
  for (const double step : { 1.0, 2.0, 5.0 })
    if (range / (power * step) <= 6)
      return power * step;
  return power * 10;
}

std::vector<tactor::StepResponse>
rises_of(const std::vector<tactor::StepResponse> &responses)
{
  std::vector<tactor::StepResponse> rises;
  std::ranges::copy_if(responses, std::back_inserter(rises),
                       [](const tactor::StepResponse &response) {
                         return response.fault == tactor::StepFault::none && response.step.rises();
                       });
  return rises;
}

double
latency_ms(const tactor::TactorCalibration &tactor)
{
  return static_cast<double>(tactor.latency.value_or(tactor::Time(0)).count()) / 1e6;
}

std::string
volts(const tactor::Step &step)
{
  return number(step.start_volts, "%.2f") + " to " + number(step.target_volts, "%.2f") + " V";
}

} // namespace

std::string
envelope_picture(const tactor::StepResponse &response, const tactor::StepEnvelope &envelope)
{
  Drawing drawing("Tactor " + std::to_string(response.step.tactor) + ", " + volts(response.step)
                  + ": 90 % after " + number(response.risen_ms, "%.1f") + " ms, first motion after "
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
  drawing.line(raw, kGrey, 0.7);
  drawing.line(amplitude, kBlue, 2);
  const double goal = 0.9 * response.steady;
  const double risen = response.risen_ms / 1e3;
  const std::array level{ axes.at({ from, goal }), axes.at({ risen, goal }),
                          axes.at({ risen, -most }) };
  drawing.line(level, kRed, 1, "5 3");
  const std::array command{ axes.at({ 0, -most }), axes.at({ 0, most }) };
  drawing.line(command, "black");
  const double onset = response.onset_ms / 1e3;
  const std::array motion{ axes.at({ onset, -most }), axes.at({ onset, most }) };
  drawing.line(motion, "black", 1, "2 3");
  drawing.text({ axes.at({ from, goal }).x + 4, level[0].y - 4 }, "90 %");
  return drawing.finish();
}

std::string
surface_picture(const tactor::TactorCalibration &tactor,
                const std::vector<tactor::StepResponse> &responses)
{
  const std::vector<tactor::StepResponse> rises = rises_of(responses);
  double volts_max = 1;
  double most = 50;
  for (const tactor::StepResponse &rise : rises) {
    volts_max = std::max(volts_max, rise.step.target_volts);
    most = std::max(most, rise.risen_ms - latency_ms(tactor));
  }
  // Start voltage to the right and back, offset to the left and back, time upwards.
  const auto place = [&](double start, double offset, double ms) {
    return Point{ 320 + (start - offset) / volts_max * 250,
                  330 - (start + offset) / volts_max * 110 - ms / (1.15 * most) * 180 };
  };
  Drawing drawing(tactor.quadratic ? "Rise time: measured, and the quadratic; R² = "
                                         + number(tactor.quadratic->r_squared, "%.3f")
                                   : "Rise time: measured");
  const std::array<std::array<Point, 2>, 3> edges{ { { place(0, 0, 0), place(volts_max, 0, 0) },
                                                     { place(0, 0, 0), place(0, volts_max, 0) },
                                                     { place(0, volts_max, 0),
                                                       place(0, volts_max, most) } } };
  for (const auto &edge : edges)
    drawing.line(edge, "black");
  for (double ms = 0; ms <= most; ms += tick(most))
    drawing.text({ place(0, volts_max, ms).x - 6, place(0, volts_max, ms).y + 4 },
                 number(ms, "%.0f") + (ms == 0 ? " ms" : ""), "end");
  for (double v = 0.5; v <= volts_max; v += 0.5) {
    drawing.text({ place(v, 0, 0).x + 6, place(v, 0, 0).y + 12 }, number(v, "%.1f"));
    drawing.text({ place(0, v, 0).x - 6, place(0, v, 0).y + 12 }, number(v, "%.1f"), "end");
  }
  drawing.text({ 480, 345 }, "start voltage, V");
  drawing.text({ 160, 345 }, "offset, V", "end");
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
  for (const tactor::StepResponse &rise : rises)
    drawing.dot(place(rise.step.start_volts, rise.step.target_volts - rise.step.start_volts,
                      std::max(0.0, rise.risen_ms - latency_ms(tactor))),
                kRed);
  return drawing.finish();
}

std::string
residual_picture(const tactor::TactorCalibration &tactor,
                 const std::vector<tactor::StepResponse> &responses)
{
  const std::vector<tactor::StepResponse> rises = rises_of(responses);
  double volts_max = 1;
  for (const tactor::StepResponse &rise : rises)
    volts_max = std::max(volts_max, rise.step.target_volts);
  std::vector<Point> of_quadratic;
  std::vector<Point> of_table;
  double most = 1;
  for (const tactor::StepResponse &rise : rises) {
    const double s = rise.step.start_volts;
    const double t = rise.step.target_volts;
    const double ms = rise.risen_ms - latency_ms(tactor);
    if (tactor.quadratic)
      of_quadratic.push_back({ t, ms - (*tactor.quadratic)(s, t - s) });
    if (tactor.table)
      of_table.push_back(
          { t, ms - static_cast<double>(tactor::RiseTime(*tactor.table)(s, t).count()) / 1e6 });
  }
  for (const auto *points : { &of_quadratic, &of_table })
    for (const Point &point : *points)
      most = std::max(most, std::abs(point.y));
  Drawing drawing("Measured rise time less the quadratic (red) and less the table (blue)");
  const Axes axes(drawing, { 0, -1.1 * most }, { volts_max + 0.1, 1.1 * most }, 0.5, tick(2 * most),
                  "target voltage, V", "ms");
  for (const Point &point : of_quadratic)
    drawing.dot(axes.at(point), kRed);
  for (const Point &point : of_table)
    drawing.dot(axes.at({ point.x + 0.02, point.y }), kBlue);
  return drawing.finish();
}
