// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/front_end.h"
#include "people/people.h"

namespace people {

/// A front end for People::Scene::picture.
class SmallPicture
{
public:
  /// Of the frame whose map has this size, valid until the next call.
  const saliency::LabImage &of(const saliency::FrameView &frame, cv::Size map, bool temporal);

private:
  saliency::FrontEnd front_end_;
  saliency::LabImage picture_;
};

} // namespace people
