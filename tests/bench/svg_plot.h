// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace bench {

struct Point
{
  double x;
  double y;
};

struct Series
{
  std::string name;
  bool own = false; ///< with a thick line
  std::vector<Point> points{};
};

/// A plot with two logarithmic axes. Numbers are > 0.
struct Plot
{
  std::string title;
  std::string x_label; ///< with the unit
  std::string y_label;
  std::vector<double> x_ticks; ///< positions; the first and the last are the ends of the axis
  std::vector<std::string> x_tick_labels;
  std::vector<Series> series;
};

/// The plots side by side as an SVG document.
std::string svg(const std::vector<Plot> &plots);

} // namespace bench
