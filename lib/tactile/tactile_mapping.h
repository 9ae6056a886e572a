// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/saliency_view.h"
#include "tactile/tactile_map.h"
#include "tactile/viewport.h"

namespace tactile {

/// How salient an event has to feel (perceptual), or how large it is.
enum class Gain
{
  none,       ///< the pooled value itself (paper)
  perceptual, ///< the strongest cell follows the event's contrast in ΔE, saturating; the others
              ///< keep their ratio to it
};

/// From saliency map to levels. Members are named in the order in which they act.
struct MappingSettings
{
  /// Absolute, in the map's units, ≥ 0: a map whose maximum does not exceed it is silent.
  double floor = 0;
  /// Share of the maximum, [0, 1]: pixels not above it are dropped (paper: 50 %), but never the
  /// maximum itself.
  double threshold = 0.5;
  /// Pixels that stay count 1 (paper), else they keep their value.
  bool binary = false;
  /// 0: a cell's value is the mean over its exact area. Else it is the map filtered by a Gaussian
  /// of this σ, in cells, and linearly interpolated at the cell's middle (paper).
  double prefilter_sigma = 0;
  Gain gain = Gain::perceptual;
  /// The map's value per ΔE of event contrast, > 0 (Gain::perceptual).
  double units_per_delta_e = 1;

  /// Threshold 50 %, binary, prefilter σ of a third of a cell, no gain (paper, Section 3; the σ is
  /// our choice).
  static MappingSettings paper();

  /// Floor and units of Profile::tuned()'s maps, values kept, exact area, perceptual gain
  /// (docs/design/algorithm.md).
  static MappingSettings tuned();

  /// The same for Profile::tuned_spatial()'s maps, whose values are ΔE for figures of one percent
  /// of the picture, more for smaller ones: a unit is taken as half a ΔE, and the weakest that is
  /// felt is the weakest that a motor can render, 4 ΔE.
  static MappingSettings tuned_spatial();
};

/// Threshold, pooling and gain. The grid covers the picture in a `map` of any size, also smaller
/// than the grid: cell (r, c) is rows [r·h/rows, (r+1)·h/rows) of its h and likewise columns, and a
/// sample on a border of cells counts for each by its share.
///
/// With a viewport the cells share that part of the picture alone, and the rest of the picture lies
/// on its border: a sample outside counts for the nearest cell as much as it would inside, so that
/// nothing is lost.
///
/// With Gain::none a level is the cell's value, at most 1. With Gain::perceptual the strongest
/// cell's level is 0.2 + 0.8 (1 − exp(−max(0, e − 4) / 25)), e = maximum of the map /
/// units_per_delta_e, and the others keep their ratio to it: what counts is how salient the event
/// is, not how large.
///
/// Writes rows × columns levels in [0, 1] into `out`, whose grid says how many. A map without
/// values is silent. Any thread may call it.
void map_saliency(const SaliencyView &map, const MappingSettings &settings, TactileMap &out,
                  const Viewport &viewport = {});

} // namespace tactile
