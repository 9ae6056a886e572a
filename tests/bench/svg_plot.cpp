// SPDX-License-Identifier: LGPL-2.1-or-later
#include "svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace bench {

namespace {

// One plot, in SVG units: the axes, with margins for labels on the left and below, and for names of
// series on the right.
constexpr double kWidth = 400;
constexpr double kHeight = 340;
constexpr double kLeft = 58;
constexpr double kRight = 215;
constexpr double kTop = 40;
constexpr double kBottom = 60;
constexpr double kLineHeight = 13;

constexpr std::array kOwnColors{ "#c62828", "#ef6c00", "#ad1457", "#6a1b9a",
                                 "#b8860b", "#d84315", "#8e24aa", "#5d4037" };
constexpr std::array kOtherColors{
  "#1565c0", "#2e7d32", "#00838f", "#616161", "#283593", "#558b2f"
};

std::string
format(const char *pattern, auto... values)
{
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string
text(double x, double y, const char *anchor, const std::string &content, const char *more = "")
{
  return format("<text x='%.1f' y='%.1f' text-anchor='%s' %s>", x, y, anchor, more) + content
         + "</text>\n";
}

/// Maps values to positions, logarithmically.
class Axis
{
public:
  Axis(double least, double most, double begin, double end)
      : least_(std::log(least)), most_(std::log(std::max(most, least * 1.01))), begin_(begin),
        end_(end)
  {
  }

  double operator()(double value) const
  {
    return begin_ + (end_ - begin_) * (std::log(value) - least_) / (most_ - least_);
  }

private:
  double least_, most_, begin_, end_;
};

/// Moves labels apart until none overlap, as little as possible.
std::vector<double>
spread(std::vector<double> wanted)
{
  std::vector<std::size_t> order(wanted.size());
  for (std::size_t i = 0; i < order.size(); i++)
    order[i] = i;
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  for (int pass = 0; pass < 200; pass++)
    for (std::size_t i = 1; i < order.size(); i++) {
      double &above = wanted[order[i - 1]];
      double &below = wanted[order[i]];
      if (const double lack = kLineHeight - (below - above); lack > 0) {
        above -= lack / 2;
        below += lack / 2;
      }
    }
  return wanted;
}

std::string
draw(const Plot &plot)
{
  double least = 1e300;
  double most = 0;
  for (const Series &series : plot.series)
    for (const Point &point : series.points) {
      least = std::min(least, point.y);
      most = std::max(most, point.y);
    }
  least = std::pow(10, std::floor(std::log10(least)));
  most = std::pow(10, std::ceil(std::log10(most)));
  const Axis x(plot.x_ticks.front(), plot.x_ticks.back(), kLeft, kLeft + kWidth);
  const Axis y(least, most, kTop + kHeight, kTop);

  std::string out
      = text(kLeft, kTop - 16, "start", plot.title, "font-weight='bold' font-size='14'");
  for (double decade = least; decade <= most * 1.001; decade *= 10)
    for (int step = 1; step < (decade * 1.001 < most ? 10 : 2); step++) {
      out += format("<path d='M%.1f %.1fh%.1f' stroke='%s'/>\n", kLeft, y(decade * step), kWidth,
                    step == 1 ? "#bbb" : "#eee");
      if (step == 1)
        out += text(kLeft - 6, y(decade) + 4, "end", format("%g", decade));
    }
  for (std::size_t i = 0; i < plot.x_ticks.size(); i++) {
    out += format("<path d='M%.1f %.1fv%.1f' stroke='#ddd'/>\n", x(plot.x_ticks[i]), kTop, kHeight);
    out += text(x(plot.x_ticks[i]), kTop + kHeight + 17, "middle", plot.x_tick_labels[i]);
  }
  out += text(kLeft + kWidth / 2, kTop + kHeight + 40, "middle", plot.x_label);
  out += text(16, kTop + kHeight / 2, "middle", plot.y_label,
              format("transform='rotate(-90 16 %.1f)'", kTop + kHeight / 2).c_str());

  std::vector<double> names;
  for (const Series &series : plot.series)
    names.push_back(y(series.points.back().y) + 4);
  names = spread(names);
  std::size_t own = 0;
  std::size_t others = 0;
  for (std::size_t i = 0; i < plot.series.size(); i++) {
    const Series &series = plot.series[i];
    const char *color = series.own ? kOwnColors[own++ % kOwnColors.size()]
                                   : kOtherColors[others++ % kOtherColors.size()];
    std::string path;
    for (const Point &point : series.points) {
      path += format("%s%.1f %.1f", path.empty() ? "M" : "L", x(point.x), y(point.y));
      out += format("<circle cx='%.1f' cy='%.1f' r='%s' fill='%s'/>\n", x(point.x), y(point.y),
                    series.own ? "3.5" : "2.5", color);
    }
    const double end_x = x(series.points.back().x);
    out += format("<path d='%s' fill='none' stroke='%s' stroke-width='%s'/>\n", path.c_str(), color,
                  series.own ? "2.5" : "1.2");
    out += format("<path d='M%.1f %.1fL%.1f %.1f' stroke='%s' stroke-width='0.6'/>\n", end_x + 4,
                  y(series.points.back().y), end_x + 14, names[i] - 4, color);
    out += text(end_x + 16, names[i], "start", series.name,
                format("fill='%s'%s", color, series.own ? " font-weight='bold'" : "").c_str());
  }
  return out;
}

} // namespace

std::string
svg(const std::vector<Plot> &plots)
{
  constexpr double kPlot = kLeft + kWidth + kRight;
  constexpr double kTall = kTop + kHeight + kBottom;
  std::string out
      = format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' "
               "font-family='DejaVu Sans, Helvetica, Arial, sans-serif' font-size='11'>\n"
               "<rect width='100%%' height='100%%' fill='white'/>\n",
               kPlot * static_cast<double>(plots.size()), kTall);
  for (std::size_t i = 0; i < plots.size(); i++)
    out += format("<g transform='translate(%.1f 0)'>\n", kPlot * static_cast<double>(i))
           + draw(plots[i]) + "</g>\n";
  return out + "</svg>\n";
}

} // namespace bench
