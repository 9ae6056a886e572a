// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/saliency_view.h"
#include "tactile/tactile_map.h"
#include "tactile/viewport.h"

namespace tactile {

/// Whether levels follow the strength of an event as perceived.
enum class Gain
{
  none,       ///< the pooled value itself (paper)
  perceptual, ///< the strongest cell follows the event's contrast in ΔE, with saturation; the other
              ///< cells keep their ratio to it
};

/// Which comes first, the threshold or the pooling.
enum class Order
{
  threshold_first, ///< pixels are compared with the strongest pixel, then pooled (paper)
  pool_first,      ///< pixels are pooled, then cells are compared with the strongest cell
};

/// Parameters from saliency map to levels.
struct MappingSettings
{
  Order order = Order::pool_first;
  /// In the map's units, ≥ 0: a map whose maximum does not exceed this is silent.
  double floor = 0;
  /// Weight of the picture's center, w in [0, 1]: a cell whose middle is (x, y) from it, in sides
  /// of the picture, counts 1 − w + w exp(−(x² + y²) / 2σ²), with σ = 0.25. 0: all cells count the
  /// same.
  double center_weight = 0;
  /// Share of the strongest cell, [0, 1], with Order::threshold_first of the strongest pixel
  /// (paper: 50 %). Values that are not above it are dropped, except the strongest.
  double threshold = 0.5;
  /// Remaining pixels count 1 (paper) instead of their value; for Order::threshold_first.
  bool binary = false;
  /// 0: a cell's value is the mean over its exact area. Otherwise it is the map filtered by a
  /// Gaussian of this σ, in cells, and interpolated at the center of the cell (paper).
  double prefilter_sigma = 0;
  Gain gain = Gain::perceptual;
  /// The map's value per ΔE of event contrast, > 0; for Gain::perceptual.
  double units_per_delta_e = 1;

  /// Threshold of pixels at 50 %, binary, prefilter, no gain (paper, Section 3). The paper does not
  /// give the prefilter's σ; a third of a cell is our choice.
  static MappingSettings paper();

  /// For Profile::tuned() maps: a floor, values kept, exact area, threshold of cells, perceptual
  /// gain (docs/design/algorithm.md).
  static MappingSettings tuned();

  /// The same for Profile::tuned_spatial() maps. Their values are ΔE for figures of one percent of
  /// the picture and larger for smaller ones, so one unit is taken as half a ΔE. The floor is the
  /// weakest event that a motor can render, 4 ΔE. The picture's center has a weight, as people look
  /// there in photographs.
  static MappingSettings tuned_spatial();
};

/// Threshold, pooling and gain: from a saliency map of any size to rows × columns levels in [0, 1],
/// where `out` gives the grid. The map may be smaller than the grid. Cell (r, c) covers rows
/// [r·h/rows, (r+1)·h/rows) of the map's h, and columns likewise. A sample on the border of cells
/// counts for each by its share.
///
/// With a viewport, the cells cover that part of the picture only. A sample outside counts for the
/// nearest cell as much as it would inside, so that nothing is lost.
///
/// With Gain::none a level is the cell's value, at most 1. With Gain::perceptual the strongest
/// cell's level is 0.2 + 0.8 (1 − exp(−max(0, e − 4) / 25)), where e = maximum of the map /
/// units_per_delta_e. The other cells keep their ratio to it: the strength of an event counts, not
/// its size.
///
/// A map without values is silent. Thread-safe.
void map_saliency(const SaliencyView &map, const MappingSettings &settings, TactileMap &out,
                  const Viewport &viewport = {});

} // namespace tactile
