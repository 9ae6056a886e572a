// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/tactile_mapping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tactile {

namespace {

// The perceptual gain (docs/algorithm.md): the contrast in ΔE from which an event is felt to grow,
// how fast that saturates, and the level of the weakest, which just clears a motor's 0.5 V of 3 V.
constexpr double kPerceptualOnset = 4;
constexpr double kPerceptualScale = 25;
constexpr double kWeakestLevel = 0.2;

/// What one cell of an axis sees: weights of the samples from `first` on, summing to 1.
struct Window
{
  int first = 0;
  std::vector<double> weights;
};

/// An axis of the map: its samples, and the picture's extent on it.
struct Axis
{
  int samples;
  double begin;
  double length;

  Axis(int samples_, const SaliencyView::Extent &picture)
      : samples(samples_), begin(picture.length > 0 ? picture.begin : 0.0),
        length(picture.length > 0 ? picture.length : static_cast<double>(samples_))
  {
  }

  /// The nearest sample, for what lies beyond the map.
  int inside(double sample) const
  {
    return static_cast<int>(std::clamp(sample, 0.0, static_cast<double>(samples - 1)));
  }
};

/// Cell `cell` of `cells`, each sample counting by the share of it that lies in the cell.
Window
area_window(const Axis &axis, int cells, int cell)
{
  const double begin = axis.begin + axis.length * cell / cells;
  const double end = axis.begin + axis.length * (cell + 1) / cells;
  Window window;
  window.first = axis.inside(std::floor(begin));
  const int last = std::max(window.first, axis.inside(std::ceil(end) - 1));
  window.weights.assign(static_cast<std::size_t>(last - window.first) + 1, 0.0);
  for (int sample = static_cast<int>(std::floor(begin)); sample < end; ++sample)
    window.weights[static_cast<std::size_t>(axis.inside(sample) - window.first)]
        += (std::min(end, sample + 1.0) - std::max<double>(begin, sample)) / (end - begin);
  return window;
}

double
gaussian(double z)
{
  return std::exp(-0.5 * z * z);
}

/// The image filtered by a Gaussian of `sigma` cells and linearly interpolated at the middle of the
/// cell: the sum of the Gaussians about the two nearest samples. Each is cut at 4 σ and at the
/// map's borders and sums to 1 before it is weighted.
Window
gaussian_window(const Axis &axis, int cells, int cell, double sigma)
{
  const int samples = axis.samples;
  const double middle = std::clamp(axis.begin + axis.length * (cell + 0.5) / cells - 0.5, 0.0,
                                   static_cast<double>(samples - 1));
  const int before = static_cast<int>(middle);
  const double width = sigma * axis.length / cells;
  const int reach = static_cast<int>(std::min<double>(samples, std::ceil(4 * width)));

  Window window;
  window.first = std::max(0, before - reach);
  const int last = std::min(samples - 1, before + 1 + reach);
  window.weights.assign(static_cast<std::size_t>(last - window.first) + 1, 0.0);
  const auto add_gaussian = [&](int center, double share) {
    const int begin = std::max(window.first, center - reach);
    const int end = std::min(last, center + reach);
    double sum = 0;
    for (int i = begin; i <= end; ++i)
      sum += gaussian((i - center) / width);
    for (int i = begin; i <= end; ++i)
      window.weights[static_cast<std::size_t>(i - window.first)]
          += share * gaussian((i - center) / width) / sum;
  };
  add_gaussian(before, 1 - (middle - before));
  if (before < last)
    add_gaussian(before + 1, middle - before);
  return window;
}

std::vector<Window>
axis_windows(const Axis &axis, int cells, double sigma)
{
  std::vector<Window> windows;
  windows.reserve(static_cast<std::size_t>(cells));
  for (int cell = 0; cell < cells; ++cell)
    windows.push_back(sigma > 0 ? gaussian_window(axis, cells, cell, sigma)
                                : area_window(axis, cells, cell));
  return windows;
}

/// Level of the strongest cell for an event of so many ΔE.
double
perceptual_level(double contrast)
{
  const double felt = std::max(0.0, contrast - kPerceptualOnset) / kPerceptualScale;
  return kWeakestLevel + (1 - kWeakestLevel) * (1 - std::exp(-felt));
}

double
value_at(const SaliencyView &map, int x, int y)
{
  const float value = map.values[y * map.stride + x];
  return std::isfinite(value) ? static_cast<double>(value) : 0.0;
}

} // namespace

MappingSettings
MappingSettings::paper()
{
  return { .floor = 0,
           .threshold = 0.5,
           .binary = true,
           .prefilter_sigma = 1.0 / 3,
           .gain = Gain::none,
           .units_per_delta_e = 1 };
}

MappingSettings
MappingSettings::tuned()
{
  return { .floor = 0.6,
           .threshold = 0.5,
           .binary = false,
           .prefilter_sigma = 0,
           .gain = Gain::perceptual,
           .units_per_delta_e = 0.065 };
}

MappingSettings
MappingSettings::tuned_spatial()
{
  constexpr double kFirstFrame = (7.0 / 8 + 7.0 / 16 + 7.0 / 32 + 7.0 / 64) / 4;
  MappingSettings settings = tuned();
  settings.floor /= kFirstFrame;
  settings.units_per_delta_e /= kFirstFrame;
  return settings;
}

void
map_saliency(const SaliencyView &map, const MappingSettings &settings, TactileMap &out)
{
  std::ranges::fill(out.levels, 0.0F);
  if (out.levels.empty() || map.values == nullptr || map.width < 1 || map.height < 1)
    return;

  double peak = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      peak = std::max(peak, value_at(map, x, y));
  if (peak <= std::max(0.0, settings.floor))
    return;

  // The cells' windows are separable: along the columns of each row of the map, then down the rows.
  const auto columns
      = axis_windows({ map.width, map.horizontal }, out.columns, settings.prefilter_sigma);
  const auto rows = axis_windows({ map.height, map.vertical }, out.rows, settings.prefilter_sigma);
  const double cut = settings.threshold * peak;
  std::vector<double> kept(static_cast<std::size_t>(map.width));
  std::vector<double> pooled(static_cast<std::size_t>(map.height) * columns.size());
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const double value = value_at(map, x, y);
      const bool keep = value > cut || value == peak;
      kept[static_cast<std::size_t>(x)] = keep ? (settings.binary ? 1.0 : value) : 0.0;
    }
    for (std::size_t c = 0; c < columns.size(); ++c)
      pooled[static_cast<std::size_t>(y) * columns.size() + c]
          = std::inner_product(columns[c].weights.begin(), columns[c].weights.end(),
                               kept.begin() + columns[c].first, 0.0);
  }
  std::vector<double> cells(out.levels.size());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t i = 0; i < rows[r].weights.size(); ++i) {
      const auto y = static_cast<std::size_t>(rows[r].first) + i;
      for (std::size_t c = 0; c < columns.size(); ++c)
        cells[r * columns.size() + c] += rows[r].weights[i] * pooled[y * columns.size() + c];
    }

  double scale = 1;
  if (settings.gain == Gain::perceptual) {
    const double strongest = *std::ranges::max_element(cells);
    if (strongest <= 0)
      return; // so far between the cells' middles that the prefilter does not reach them
    scale = perceptual_level(peak / settings.units_per_delta_e) / strongest;
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    out.levels[i] = static_cast<float>(std::clamp(cells[i] * scale, 0.0, 1.0));
}

} // namespace tactile
