// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace saliency {

/// Surroundedness, the figure-ground cue of Boolean map saliency (Zhang & Sclaroff 2013): a figure
/// is enclosed by its ground.
///
/// L*, a* and b* are each cut at every threshold t = (k + ½) Δt into 4-connected regions above and
/// below t. A region is surrounded if it does not touch the picture's border. It counts if any of
/// it lies beyond the next threshold, too, since a step across a single one may be noise. Then
///   S(x) = Σ_channels Σ_t Δt (A₀ / A)^p,
/// where A is the area of the surrounded region of t that contains x, if any, and A₀ is one percent
/// of the picture.
///
/// If A = A₀ or p = 0, S(x) is the Boolean map distance (Zhang & Sclaroff 2016) less the last Δt:
/// the smallest change of each channel along any path from x to the border. With p > 0 a small
/// region stands out more than a large one. At p = ½ the sum of S over a region grows as its
/// diameter does.
///
/// A figure that the border cuts off counts as ground. There are three differences from the 2013
/// paper. Each region counts by its own area, rather than by the L2 norm of all regions of a
/// threshold. Thresholds do not depend on the picture, so a color elsewhere changes nothing here.
/// There is neither whitening nor morphology.
class Surroundedness
{
public:
  /// Δt in [0.5, 100] ΔE; p in [0, 1].
  Surroundedness(double threshold_step, double area_exponent);

  /// `lab`: finite, not empty. `map` becomes CV_32FC1 of its size, ≥ 0, exactly 0 where nothing is
  /// surrounded. Run time grows with the sum of all horizontal color steps in units of Δt.
  void operator()(const LabImage &lab, cv::Mat &map);

private:
  /// Columns x - 1 and x of row y lie on different sides of a threshold.
  struct Crossing
  {
    int x;
    int y;
  };

  /// Pixels of a row from x to the next run, all on one side of a threshold. Runs are joined into
  /// regions by a union-find forest; the root holds the region's properties.
  struct Run
  {
    int x;
    int parent;
    int area;    ///< of the region, pixels
    bool border; ///< the region touches the picture's border
    bool beyond; ///< some of the region lies beyond the next threshold
  };

  class CrossingCursor;

  void prepare(cv::Size size);
  void find_crossings(const cv::Mat &plane);
  void join_runs(int threshold);
  void add_surrounded();
  int run_end(int run, int y) const;
  int root(int run);
  void unite(int a, int b);

  double threshold_step_;
  double area_exponent_;
  cv::Size size_;
  std::vector<std::int64_t> weight_;             ///< Δt (A₀/A)^p by area in pixels, fixed-point
  std::vector<std::vector<Crossing>> crossings_; ///< by threshold, row by row
  std::vector<int> row_codes_;       ///< per row: number of thresholds below its first pixel
  std::vector<Run> runs_;            ///< of one threshold, row by row
  std::vector<int> row_runs_;        ///< index of each row's first run, and the end
  std::vector<std::int64_t> change_; ///< of S between adjacent pixels of a row, fixed-point
};

} // namespace saliency
