// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "saliency/profile.h"

namespace saliency {

/// Shot boundary detector: most of the picture changes visibly from one frame to the next. Motion
/// within a shot and fades change less at a time.
class ShotCut
{
public:
  explicit ShotCut(const Profile &profile);

  /// Whether the frame starts a new shot: more than `Profile::cut_share` of its pixels differ from
  /// the last frame by more than `Profile::cut_contrast` (ΔE). False for the first frame after
  /// reset(), after a change of size, and with fewer than kFewestSamples. `lab` is copied.
  bool operator()(const LabImage &lab);

  /// Drops the last frame: the next one starts no shot.
  void reset();

private:
  double share_;
  float contrast_squared_;
  LabImage last_;
};

} // namespace saliency
