// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/shot_cut.h"

#include "saliency/rows.h"

#include <array>

namespace saliency {

ShotCut::ShotCut(const Profile &profile)
    : share_(profile.cut_share),
      contrast_squared_(static_cast<float>(profile.cut_contrast * profile.cut_contrast))
{
}

bool
ShotCut::operator()(const LabImage &lab)
{
  const cv::Size size = lab.size();
  const auto row = [](const LabImage &image, int y) -> std::array<const float *, 3> {
    return { image.planes[0].ptr<float>(y), image.planes[1].ptr<float>(y),
             image.planes[2].ptr<float>(y) };
  };
  std::size_t changed = 0;
  if (last_.size() == size)
    for (int y = 0; y < size.height; ++y)
      changed += rows::count_changed(row(lab, y), row(last_, y), contrast_squared_,
                                     static_cast<std::size_t>(size.width));
  for (std::size_t c = 0; c < 3; ++c)
    lab.planes[c].copyTo(last_.planes[c]);
  return size.area() >= kFewestSamples && static_cast<double>(changed) > share_ * size.area();
}

void
ShotCut::reset()
{
  last_ = {};
}

} // namespace saliency
