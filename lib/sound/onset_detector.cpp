// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_detector.h"

#include <algorithm>
#include <cmath>

namespace sound {

namespace {

constexpr double kFloor = -70; ///< dB; what is below counts as that
constexpr double kFilledFloor = -85;
constexpr double kExcessFloor = 1e-7;
/// Least mean rise of the upper octaves, dB.
constexpr double kLeastRise = 4;

constexpr int kFeatures = 17;
using Features = std::array<double, kFeatures>;

/// A linear score: found by logistic regression (tests/sound).
struct Score
{
  Features weights;
  double offset;

  double of(const Features &features) const
  {
    double sum = offset;
    for (std::size_t i = 0; i < kFeatures; i++)
      sum += weights[i] * features[i];
    return sum;
  }
};

// In the order of is_blow(): rises of 18–65 and 65–130 Hz; how much fuller are 250–500 Hz and the
// octaves from 1 kHz; low against middle, high against middle and deepest against low excess; how
// uneven the octaves from 500 Hz are; how sudden it is; how much fuller than for long from 1 kHz.
constexpr Score kAgainstNotes{
  { 0.074, -0.024, -0.177, 0.091, 0.809, 0.438, 0.122, 0.151, -0.087, -0.365, -0.229, -1.684, 0.557,
    -1.327, -0.035, 0.666, -0.567 },
  4.400,
};
constexpr Score kAgainstVoices{
  { -0.021, -0.042, -0.087, 0.177, 0.549, 0.486, 0.259, -0.386, 0.001, -0.547, -0.463, -0.607,
    -0.567, -0.932, -0.101, 0.116, -0.157 },
  1.785,
};

double
decibels(double power)
{
  return 10 * std::log10(power);
}

} // namespace

const OnsetDetector::Hop &
OnsetDetector::hop(int ago) const
{
  return hops_[static_cast<std::size_t>((newest_ - ago + kHeld) % kHeld)];
}

bool
OnsetDetector::add(const BandPowers &powers)
{
  newest_ = (newest_ + 1) % kHeld;
  known_ = std::min(known_ + 1, kHeld);
  Hop &now = hops_[static_cast<std::size_t>(newest_)];
  now.power = powers.sum;
  for (std::size_t band = 0; band < kBands; band++) {
    now.db[band] = std::max(decibels(powers.sum[band] + 1e-12), kFloor);
    now.filled[band] = std::max(powers.filled[band], kFilledFloor);
    now.uneven[band] = powers.uneven[band];
  }
  dead_ = std::max(dead_ - 1, 0);
  if (known_ < kHeld || dead_ > 0 || !is_blow())
    return false;
  dead_ = kDeadHops;
  return true;
}

bool
OnsetDetector::is_blow()
{
  constexpr int kMoment = kAhead;
  Powers rise{};
  Powers excess{};
  Powers fuller{};
  Powers uneven{};
  Powers sudden{};
  Powers longer{};
  before_.fill(0);
  for (std::size_t band = 0; band < kBands; band++) {
    double db = kFloor;
    double filled = kFloor;
    for (int ago = kMoment + kGap; ago <= kMoment + kPast; ago++) {
      db = std::max(db, hop(ago).db[band]);
      filled = std::max(filled, hop(ago).filled[band]);
      before_[band] = std::max(before_[band], hop(ago).power[band]);
    }
    const Hop &moment = hop(kMoment);
    const Hop &after = hop(kMoment - 1);
    const double loudest = std::max({ moment.db[band], after.db[band], hop(kMoment - 2).db[band] });
    const double fullest = std::max(moment.filled[band], after.filled[band]);
    rise[band] = std::clamp(loudest - db, -3.0, 15.0);
    excess[band] = std::max(0.0, std::pow(10, loudest / 10) - std::pow(10, db / 10)) + kExcessFloor;
    fuller[band] = std::clamp(fullest - filled, -3.0, 20.0);
    uneven[band] = std::clamp(std::min(moment.uneven[band], after.uneven[band]), 0.0, 20.0);
    sudden[band] = fullest - (hop(kMoment + 1).filled[band] + hop(kMoment + 2).filled[band]) / 2;
    double sum = 0;
    for (int ago = kMoment + kLongGap; ago <= kMoment + kLongPast; ago++)
      sum += hop(ago).filled[band];
    longer[band] = std::clamp(fullest - sum / (kLongPast - kLongGap + 1), -3.0, 30.0);
  }
  if ((fuller[5] + fuller[6] + fuller[7]) / 3 <= kLeastRise)
    return false;
  const auto ratio = [](double a, double b) {
    return std::clamp(decibels(a / b), -20.0, 10.0);
  };
  double suddenness = 0;
  for (std::size_t band = 4; band < kBands; band++)
    suddenness += std::clamp(sudden[band], -3.0, 15.0) / 4;
  const double middle = excess[2] + excess[3] + excess[4];
  const Features features{ rise[0],
                           rise[1],
                           fuller[3],
                           fuller[5],
                           fuller[6],
                           fuller[7],
                           ratio(excess[0] + excess[1], middle),
                           ratio(excess[6] + excess[7], middle),
                           ratio(excess[0], excess[1] + excess[2]),
                           uneven[4],
                           uneven[5],
                           uneven[6],
                           uneven[7],
                           suddenness,
                           longer[5],
                           longer[6],
                           longer[7] };
  return kAgainstNotes.of(features) > 0 && kAgainstVoices.of(features) > 0;
}

const Powers &
OnsetDetector::before() const
{
  return before_;
}

void
OnsetDetector::reset()
{
  known_ = 0;
  dead_ = 0;
}

} // namespace sound
