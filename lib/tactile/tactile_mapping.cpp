// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/tactile_mapping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace tactile {

namespace {

// The perceptual gain (docs/design/algorithm.md): the contrast in ΔE above which levels grow, the
// scale of the saturation, and the weakest level, which just clears a motor's 0.5 V of 3 V.
constexpr double kPerceptualOnset = 4;
constexpr double kPerceptualScale = 25;
constexpr double kWeakestLevel = 0.2;

/// Each cell's weights along an axis. A cell's weights sum to 1 if the viewport is the whole
/// picture.
struct Windows
{
  struct Cell
  {
    int first;
    std::size_t begin; ///< index of its weights in `weights`
    std::size_t count;
  };
  std::vector<Cell> cells;
  std::vector<double> weights;

  std::span<const double> of(const Cell &cell) const
  {
    return std::span(weights).subspan(cell.begin, cell.count);
  }

  /// Starts the next cell, with samples first…last.
  void begin(int first, int last)
  {
    const auto count = static_cast<std::size_t>(last - first) + 1;
    cells.push_back({ first, weights.size(), count });
    weights.resize(weights.size() + count, 0.0);
  }

  void add(int sample, double weight)
  {
    weights[cells.back().begin + static_cast<std::size_t>(sample - cells.back().first)] += weight;
  }
};

/// Buffers of map_saliency(), one set per thread: allocates only for a larger map or grid.
struct Workspace
{
  Windows columns;
  Windows rows;
  std::vector<double> kept;   ///< a row of the map
  std::vector<double> pooled; ///< pooled vertically: rows of cells × samples
  std::vector<double> cells;
};

/// An axis of the map in samples: the extent that the cells cover, and the length of the picture
/// before and after it.
struct Axis
{
  int samples;
  double begin;
  double length;
  double before;
  double after;

  Axis(int samples_, const SaliencyView::Extent &picture, double view_begin, double view_length)
      : samples(samples_)
  {
    const double whole = picture.length > 0 ? picture.length : static_cast<double>(samples);
    before = std::max(0.0, view_begin * whole);
    after = std::max(0.0, (1 - (view_begin + view_length)) * whole);
    begin = (picture.length > 0 ? picture.begin : 0.0) + before;
    length = view_length * whole;
  }

  /// Nearest sample of the map.
  int inside(double sample) const
  {
    return static_cast<int>(std::clamp(sample, 0.0, static_cast<double>(samples - 1)));
  }

  /// Center of a sample, in samples, clamped to the viewport.
  double place(int sample) const
  {
    double at = sample;
    if (before > 0)
      at = std::max(at, begin - 0.5);
    if (after > 0)
      at = std::min(at, begin + length - 0.5);
    return at;
  }
};

/// Weights of cell `cell` of `cells`: the share of each sample within the cell. Cells at the edge
/// of the viewport include what lies outside.
void
add_area_window(const Axis &axis, int cells, int cell, Windows &windows)
{
  const double cell_begin = axis.begin + axis.length * cell / cells;
  const double cell_end = axis.begin + axis.length * (cell + 1) / cells;
  const double begin = cell_begin - (cell == 0 ? axis.before : 0.0);
  const double end = cell_end + (cell + 1 == cells ? axis.after : 0.0);
  const int first = axis.inside(std::floor(begin));
  windows.begin(first, std::max(first, axis.inside(std::ceil(end) - 1)));
  for (int sample = static_cast<int>(std::floor(begin)); sample < end; ++sample)
    windows.add(axis.inside(sample), (std::min(end, sample + 1.0) - std::max<double>(begin, sample))
                                         / (cell_end - cell_begin));
}

double
gaussian(double z)
{
  return std::exp(-0.5 * z * z);
}

/// Weights of the map filtered by a Gaussian of `sigma` cells and interpolated at the cell's
/// center: the sum of the Gaussians around the two nearest samples. Each Gaussian is cut at 4 σ and
/// at the map's borders and normalized to sum 1. Samples outside the viewport count at its border.
void
add_gaussian_window(const Axis &axis, int cells, int cell, double sigma, Windows &windows)
{
  const int samples = axis.samples;
  const double middle = std::clamp(axis.begin + axis.length * (cell + 0.5) / cells - 0.5, 0.0,
                                   static_cast<double>(samples - 1));
  const int before = static_cast<int>(middle);
  const double width = sigma * axis.length / cells;
  const int reach = static_cast<int>(std::min<double>(samples, std::ceil(4 * width)));

  const bool to_begin = axis.before > 0 && axis.place(0) >= before - reach;
  const bool to_end = axis.after > 0 && axis.place(samples - 1) <= before + 1 + reach;
  const int first = to_begin ? 0 : std::max(0, before - reach);
  const int last = to_end ? samples - 1 : std::min(samples - 1, before + 1 + reach);
  windows.begin(first, last);
  const auto add_gaussian = [&](int center, double share) {
    double sum = 0;
    for (int i = std::max(0, center - reach); i <= std::min(samples - 1, center + reach); ++i)
      sum += gaussian((i - center) / width);
    for (int i = first; i <= last; ++i) {
      const double distance = axis.place(i) - center;
      if (std::abs(distance) <= reach)
        windows.add(i, share * gaussian(distance / width) / sum);
    }
  };
  add_gaussian(before, 1 - (middle - before));
  if (before < last)
    add_gaussian(before + 1, middle - before);
}

void
find_windows(const Axis &axis, int cells, double sigma, Windows &windows)
{
  windows.cells.clear();
  windows.weights.clear();
  for (int cell = 0; cell < cells; ++cell)
    if (sigma > 0)
      add_gaussian_window(axis, cells, cell, sigma, windows);
    else
      add_area_window(axis, cells, cell, windows);
}

// The relative gain: the weakest level, and how many times stronger the strongest events are.
constexpr double kWeakestRelative = 0.3;
constexpr double kRange = 30;

/// Level of the strongest cell for events of this strength.
double
relative_level(double strength)
{
  const double share = strength > 0 ? 1 + std::log(strength) / std::log(kRange) : 0;
  return kWeakestRelative + (1 - kWeakestRelative) * std::clamp(share, 0.0, 1.0);
}

/// Level of the strongest cell for an event of this contrast in ΔE.
double
perceptual_level(double contrast)
{
  const double felt = std::max(0.0, contrast - kPerceptualOnset) / kPerceptualScale;
  return kWeakestLevel + (1 - kWeakestLevel) * (1 - std::exp(-felt));
}

/// Weighs each cell by how near the picture's center its middle lies.
void
weigh_center(std::vector<double> &cells, int rows, int columns, const Viewport &viewport,
             double weight)
{
  constexpr double kSigma = 0.25; // of each side of the picture
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double x = viewport.left + viewport.width * (c + 0.5) / columns - 0.5;
      const double y = viewport.top + viewport.height * (r + 0.5) / rows - 0.5;
      cells[static_cast<std::size_t>(r * columns + c)]
          *= 1 - weight + weight * gaussian(std::hypot(x, y) / kSigma);
    }
}

} // namespace

MappingSettings
MappingSettings::paper()
{
  return {
    .order = Order::threshold_first, .binary = true, .prefilter_sigma = 1.0 / 3, .gain = Gain::none
  };
}

MappingSettings
MappingSettings::tuned()
{
  return { .floor = 0.8, .center_weight = 0.4, .gain = Gain::relative, .units_per_delta_e = 0.13 };
}

MappingSettings
MappingSettings::tuned_spatial()
{
  MappingSettings settings = tuned();
  settings.gain = Gain::perceptual;
  settings.units_per_delta_e = 2;
  settings.floor = kPerceptualOnset * settings.units_per_delta_e;
  settings.center_weight = 0.7;
  return settings;
}

void
map_saliency(const SaliencyView &map, const MappingSettings &settings, TactileMap &out,
             const Viewport &viewport)
{
  std::ranges::fill(out.levels, 0.0F);
  if (out.levels.empty() || map.empty())
    return;

  const double peak = map.peak();
  if (peak <= std::max(0.0, settings.floor))
    return;

  // The weights are separable: pool vertically first, then horizontally.
  thread_local Workspace work;
  find_windows({ map.width, map.horizontal, viewport.left, viewport.width }, out.columns,
               settings.prefilter_sigma, work.columns);
  find_windows({ map.height, map.vertical, viewport.top, viewport.height }, out.rows,
               settings.prefilter_sigma, work.rows);
  const bool pool_first = settings.order == Order::pool_first;
  const double cut = pool_first ? 0 : settings.threshold * peak;
  const auto width = static_cast<std::size_t>(map.width);
  work.kept.resize(width);
  work.pooled.assign(work.rows.cells.size() * width, 0.0);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const double value = map.at(x, y);
      const bool keep = value > cut || value == peak;
      work.kept[static_cast<std::size_t>(x)] = keep ? (settings.binary ? 1.0 : value) : 0.0;
    }
    double *row = work.pooled.data();
    for (const Windows::Cell &cell : work.rows.cells) {
      const auto i
          = static_cast<std::size_t>(y - cell.first); // wraps to a huge value before the first
      if (i < cell.count) {
        const double weight = work.rows.of(cell)[i];
        for (std::size_t x = 0; x < width; ++x)
          row[x] += weight * work.kept[x];
      }
      row += width;
    }
  }
  work.cells.clear();
  for (std::size_t r = 0; r < work.rows.cells.size(); ++r)
    for (const Windows::Cell &cell : work.columns.cells) {
      const auto weights = work.columns.of(cell);
      work.cells.push_back(std::inner_product(
          weights.begin(), weights.end(),
          work.pooled.begin() + static_cast<std::ptrdiff_t>(r * width) + cell.first, 0.0));
    }
  std::vector<double> &cells = work.cells;
  if (settings.center_weight > 0)
    weigh_center(cells, out.rows, out.columns, viewport, settings.center_weight);
  const double strongest = *std::ranges::max_element(cells);
  if (pool_first)
    std::ranges::replace_if(
        cells,
        [least = settings.threshold * strongest, strongest](double cell) {
          return cell <= least && cell != strongest;
        },
        0.0);

  double scale = 1;
  if (settings.gain != Gain::none) {
    if (strongest <= 0)
      return; // the prefilter does not reach any cell's center
    const double level = settings.gain == Gain::relative
                             ? relative_level(map.strength * settings.sensitivity)
                             : perceptual_level(peak / settings.units_per_delta_e);
    scale = level / strongest;
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    out.levels[i] = static_cast<float>(std::clamp(cells[i] * scale, 0.0, 1.0));
}

} // namespace tactile
