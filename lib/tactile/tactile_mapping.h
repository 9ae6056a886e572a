// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <cstddef>

namespace tactile {

/// A saliency map to read: `values[y * stride + x]`, 0 ≤ x < width, 0 ≤ y < height; finite and ≥ 0.
struct SaliencyView
{
  const float *values = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0; ///< floats from row to row
};

/// How salient an event has to feel (perceptual), or how large it is.
enum class Gain
{
  none,       ///< the pooled value itself (paper)
  perceptual, ///< the strongest cell follows the event's contrast in ΔE, saturating; the others keep their ratio to it
};

/// From saliency map to levels. Members are named in the order in which they act.
struct MappingSettings
{
  double floor = 0;        ///< absolute, in the map's units: a map whose maximum does not exceed it is silent
  double threshold = 0.5;  ///< share of the maximum, [0, 1]: pixels not above it are dropped (paper: 50 %)
  bool binary = false;     ///< pixels above the threshold count 1 (paper), else they keep their value
  double prefilter_sigma = 0; ///< σ of the Gaussian before pooling, in cells; 0: exact area pooling
  Gain gain = Gain::perceptual;
  double units_per_delta_e = 1; ///< the map's value per ΔE of event contrast (Gain::perceptual)

  static MappingSettings paper();
  static MappingSettings tuned();
};

/// Threshold, pooling by exact area (a pixel on a border of cells counts for each by its share) and gain.
/// `map` of any size ≥ 1×1 is covered by the grid as a whole: cell (r, c) sees rows [r·h/rows, (r+1)·h/rows) and likewise columns.
/// Writes rows × columns levels in [0, 1] into `out` (whose grid says how many).
void map_saliency(const SaliencyView &map, const MappingSettings &settings, TactileMap &out);

} // namespace tactile
