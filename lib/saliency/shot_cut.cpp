// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/shot_cut.h"

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
    for (int y = 0; y < lab.rows; ++y) {
      const auto *now = lab.ptr<cv::Vec3f>(y);
      const auto *before = last_.ptr<cv::Vec3f>(y);
      for (int x = 0; x < lab.cols; ++x) {
        const cv::Vec3f delta = now[x] - before[x];
        changed += delta.dot(delta) > contrast_squared_ ? 1 : 0;
      }
    }
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
