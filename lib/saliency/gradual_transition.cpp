// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/gradual_transition.h"

#include "saliency/rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace saliency {

namespace {

constexpr double kLag = 4;            ///< k, in frames at 30 fps
constexpr double kShortestStep = 0.9; ///< between pictures that are kept
constexpr std::size_t kMostPictures = 12;
constexpr double kHold = 6;           ///< frames after a transition
constexpr float kVisible = 0.7F;      ///< ΔE
constexpr double kMostPace = 6;       ///< γ
constexpr double kEnoughChange = 0.3; ///< share of samples that change
constexpr double kEnoughAgree = 0.7;  ///< share of those that agree
constexpr float kAgrees = 0.4F;       ///< |D1 − γ D2| / |D1|
constexpr float kNoise = 0.6F;        ///< the same, in ΔE: slow changes are hardly above the noise
constexpr float kEvent = 5;           ///< ΔE: smaller changes beside it do not count
constexpr float kFollows = 0.5F;      ///< the same, for a sample that is not new

using Change = std::array<float, 3>;

float
squared(const Change &change)
{
  return change[0] * change[0] + change[1] * change[1] + change[2] * change[2];
}

/// Calls what(i, D1, D2) for each sample i.
template <class Function>
void
each_sample(const LabImage &now, const LabImage &then, const LabImage &before, Function what)
{
  std::array<const float *, 3> planes[3];
  for (std::size_t c = 0; c < 3; ++c) {
    planes[0][c] = now.planes[c].ptr<float>();
    planes[1][c] = then.planes[c].ptr<float>();
    planes[2][c] = before.planes[c].ptr<float>();
  }
  for (std::size_t i = 0; i < now.planes[0].total(); ++i) {
    Change d1;
    Change d2;
    for (std::size_t c = 0; c < 3; ++c) {
      d1[c] = planes[0][c][i] - planes[1][c][i];
      d2[c] = planes[1][c][i] - planes[2][c][i];
    }
    what(i, d1, d2);
  }
}

} // namespace

/// The picture whose age is nearest.
const GradualTransition::Picture &
GradualTransition::shown(double age) const
{
  return *std::ranges::min_element(
      past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(count_), {},
      [age](const Picture &picture) { return std::abs(picture.age - age); });
}

const cv::Mat &
GradualTransition::operator()(const LabImage &lab, double elapsed)
{
  const cv::Size size = lab.size();
  if (mask_.size() != size) {
    reset();
    mask_.create(size, CV_32FC1);
  }
  for (auto &picture : past_)
    picture.age += elapsed;
  since_ += elapsed;
  if (count_ == 0 || past_[latest_].age >= kShortestStep) {
    past_.resize(kMostPictures);
    latest_ = (latest_ + 1) % kMostPictures;
    count_ = std::min(count_ + 1, kMostPictures);
    past_[latest_].age = 0;
    for (std::size_t c = 0; c < 3; ++c)
      lab.planes[c].copyTo(past_[latest_].lab.planes[c]);
  }
  const Picture &then = shown(kLag);
  const Picture &before = shown(2 * kLag);
  if (before.age < 1.5 * kLag)
    return none_;

  // Mostly too little changes for a transition.
  std::array<const float *, 3> present;
  std::array<const float *, 3> past;
  for (std::size_t c = 0; c < 3; ++c) {
    present[c] = lab.planes[c].ptr<float>();
    past[c] = then.lab.planes[c].ptr<float>();
  }
  const std::size_t changed
      = rows::count_changed(present, past, kVisible * kVisible, lab.planes[0].total());
  const bool enough = static_cast<double>(changed) > kEnoughChange * size.area();
  if (!enough && since_ > kHold)
    return none_;

  double product = 0;
  double power = 0;
  each_sample(lab, then.lab, before.lab, [&](std::size_t, const Change &d1, const Change &d2) {
    product += static_cast<double>(d1[0] * d2[0] + d1[1] * d2[1] + d1[2] * d2[2]);
    power += static_cast<double>(squared(d2));
  });
  const auto pace
      = static_cast<float>(power > 0 ? std::clamp(product / power, 0.0, kMostPace) : 0.0);
  std::size_t agreeing = 0;
  auto *follows = mask_.ptr<float>();
  each_sample(lab, then.lab, before.lab, [&](std::size_t i, const Change &d1, const Change &d2) {
    const float change = std::sqrt(squared(d1));
    const float rest
        = std::sqrt(squared({ d1[0] - pace * d2[0], d1[1] - pace * d2[1], d1[2] - pace * d2[2] }));
    agreeing += change > kVisible && rest < std::max(kAgrees * change, kNoise) ? 1 : 0;
    follows[i] = rest < std::max(kFollows * change, kEvent) ? 1.0F : 0.0F;
  });
  if (enough && static_cast<double>(agreeing) > kEnoughAgree * static_cast<double>(changed))
    since_ = 0;
  return since_ <= kHold ? mask_ : none_;
}

void
GradualTransition::reset()
{
  count_ = 0;
  latest_ = kMostPictures - 1;
  since_ = std::numeric_limits<double>::infinity();
}

} // namespace saliency
