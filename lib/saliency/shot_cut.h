// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "saliency/profile.h"

namespace saliency {

/// Tells where one shot ends and the next begins: from one frame to the next most of the picture
/// changes visibly. What moves in a shot, and a fade, do not change that much at once.
class ShotCut
{
public:
  explicit ShotCut(const Profile &profile);

  /// Whether the frame begins a new shot: more than `Profile::cut_share` of its pixels differ from
  /// the last frame's by more than `Profile::cut_contrast` (ΔE). `lab` is copied. The first frame
  /// after a reset, one of another size and one of fewer than kFewestSamples begin none.
  bool operator()(const LabImage &lab);

  void reset();

private:
  double share_;
  float contrast_squared_;
  LabImage last_;
};

} // namespace saliency
