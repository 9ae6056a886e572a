// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/shot_cut.h"

#include "saliency/rows.h"

namespace saliency {

ShotCut::ShotCut(const Profile &profile)
    : share_(profile.cut_share),
      contrast_squared_(static_cast<float>(profile.cut_contrast * profile.cut_contrast))
{
}

bool
ShotCut::operator()(const cv::Mat &lab)
{
  std::size_t changed = 0;
  if (last_.size() == lab.size())
    for (int y = 0; y < lab.rows; ++y)
      changed += rows::count_changed(lab.ptr<float>(y), last_.ptr<float>(y), contrast_squared_,
                                     static_cast<std::size_t>(lab.cols));
  lab.copyTo(last_);
  return lab.total() >= kFewestSamples
         && static_cast<double>(changed) > share_ * static_cast<double>(lab.total());
}

void
ShotCut::reset()
{
  last_.release();
}

} // namespace saliency
