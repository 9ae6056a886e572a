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
/// L*, a* and b* are each cut at every threshold t = (k + ½) Δt; a cut parts the picture into
/// 4-connected regions above and below t. A region is surrounded if it does not touch the picture's
/// border, and counts if any of it lies beyond the next threshold too: a step across one alone may
/// be noise. Then
///   S(x) = Σ_channels Σ_t Δt (A₀ / A)^p, A the area of the surrounded region of t in which x lies,
/// if any, and A₀ one percent of the picture. For a region of that size, and for any with p = 0,
/// S(x) is how much of each channel every way from x to the border has to cross (Zhang & Sclaroff
/// 2016: Boolean map distance), less the last Δt. With p > 0 a small region stands out more than a
/// large one; at p = ½ the sum of S over a region grows as its diameter does.
///
/// What the picture's border cuts off counts as ground. Unlike in the paper, each region counts by
/// its own area rather than by the L2 norm of all that a threshold finds, thresholds do not depend
/// on the picture (a color that appears elsewhere changes nothing here), and there is neither
/// whitening nor morphology.
class Surroundedness
{
public:
  /// Δt in [0.5, 100] ΔE; p in [0, 1].
  Surroundedness(double threshold_step, double area_exponent);

  /// `lab`: finite, not empty. `map` becomes CV_32FC1 of its size, ≥ 0; what is
  /// not surrounded is exactly 0. The time it takes grows with the sum of all horizontal steps of
  /// color, in units of Δt.
  void operator()(const LabImage &lab, cv::Mat &map);

private:
  /// A row lies on different sides of a threshold in columns x - 1 and x.
  struct Crossing
  {
    int x;
    int y;
  };

  /// Pixels of a row from x to the next run, all on one side of a threshold. Runs are joined to
  /// regions in a union-find forest; what is said of the region holds at its root.
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
  std::vector<int> row_codes_;       ///< thresholds that each row's first pixel is above
  std::vector<Run> runs_;            ///< of one cut, row by row
  std::vector<int> row_runs_;        ///< first run of each row, and the end
  std::vector<std::int64_t> change_; ///< of S from pixel to pixel of a row, fixed-point
};

} // namespace saliency
