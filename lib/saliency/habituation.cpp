// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/habituation.h"

#include <algorithm>
#include <cmath>

namespace saliency {

Habituation::Habituation(const Profile &profile)
    : after_(profile.habituation_after),
      contrast_(static_cast<float>(profile.habituation_contrast)),
      share_of_itself_(static_cast<float>(profile.habituation_share))
{
}

const cv::Mat &
Habituation::settled(const cv::Mat &map, double elapsed)
{
  if (!begun_ || first_.size() != map.size()) {
    begun_ = true;
    map.copyTo(first_);
    age_.create(map.size());
    std::fill_n(age_.ptr<float>(), age_.total(), 0.0F);
    share_.create(map.size(), CV_32FC1);
    return none_;
  }
  bool any = false;
  const auto *now = map.ptr<float>();
  auto *first = first_.ptr<float>();
  auto *age = age_.ptr<float>();
  auto *share = share_.ptr<float>();
  const auto begin = static_cast<float>(after_);
  const float end = begin + static_cast<float>(kFading);
  const auto step = static_cast<float>(elapsed);
  for (std::size_t i = 0; i < map.total(); ++i) {
    const bool stands
        = std::abs(now[i] - first[i]) < std::max(contrast_, share_of_itself_ * first[i]);
    first[i] = stands ? first[i] : now[i];
    const float before = stands ? age[i] : 0;
    age[i] = stands ? std::min(before + step, 2 * end) : 0;
    // What is left of the past falls to 0 linearly from `begin` to `end`.
    const float left = end - std::max(before, begin);
    const float gone = std::min(age[i], end) - std::max(before, begin);
    share[i] = left > 0 && gone > 0 ? gone / left : 0;
    any |= share[i] > 0;
  }
  return any ? share_ : none_;
}

void
Habituation::reset()
{
  begun_ = false;
}

} // namespace saliency
