// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/small_picture.h"

#include "frame/levels.h"

#include <algorithm>

namespace people {

const saliency::LabImage &
SmallPicture::of(const saliency::FrameView &frame, cv::Size map, bool temporal)
{
  int level = 0;
  while (saliency::level_size({ frame.width, frame.height }, level).width > map.width)
    level++;
  level = std::max(0, level - (temporal ? 2 : 0));
  const saliency::FixedLabImage &fixed = front_end_.lab(frame, level, level);
  for (std::size_t c = 0; c < (temporal ? 1 : fixed.planes.size()); ++c) {
    picture_.planes[c].create(fixed.size(), CV_32FC1);
    saliency::to_float(fixed.planes[c], 0, fixed.size().height, picture_.planes[c]);
  }
  return picture_;
}

} // namespace people
