// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/track_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace follow {

namespace {

/// Length of the silent cue for an unknown part, in film time. Afterwards it may be known.
constexpr Time kUnknown = std::chrono::milliseconds(100);

Time
scaled(Time span, double by)
{
  return Time(std::llround(static_cast<double>(span.count()) * by));
}

} // namespace

void
TrackFollower::set_track(std::shared_ptr<const tactile::Draft> track)
{
  track_ = std::move(track);
  stretch_ = 0; // no stretch has this number
}

void
TrackFollower::set_delay(Time later)
{
  offset_ = later;
}

void
TrackFollower::change_player()
{
  stretch_ = 0;
}

/// The track's map from a film time on, until it changes, a second at most. Unknown parts are
/// silent for a moment.
tactile::Cue
TrackFollower::next_cue(Time begin) const
{
  const tactile::TactileMap *map = track_->at(begin);
  const Time longest = map != nullptr ? tactile::CueBuilder::kLongest : kUnknown;
  return { .begin = begin,
           .end = std::min(begin + longest, track_->until(begin)),
           .map = map != nullptr ? *map : tactile::TactileMap(track_->rows(), track_->columns()) };
}

TrackFollower::Step
TrackFollower::step(const std::optional<PositionEstimator::Estimate> &estimate, Time now,
                    Time ahead)
{
  if (!track_ || !estimate || estimate->rate <= 0)
    return { .silence = std::exchange(plays_, false) };
  const double rate = estimate->rate;
  const auto film_time = [&](Time local) {
    return std::max(Time(0), estimate->position + scaled(local - now - offset_, rate));
  };
  const auto local_time = [&](Time film) {
    return now + offset_ + scaled(film - estimate->position, 1 / rate);
  };
  Step step;
  if (!plays_ || estimate->stretch != stretch_) {
    step.silence = plays_;
    plays_ = true;
    stretch_ = estimate->stretch;
    next_ = film_time(now);
  }
  next_ = std::max(next_, film_time(now)); // the past is skipped
  for (const Time until = film_time(now + ahead); next_ < until;) {
    tactile::Cue cue = next_cue(next_);
    next_ = cue.end;
    cue.begin = local_time(cue.begin);
    cue.end = local_time(cue.end);
    step.cues.push_back(std::move(cue));
  }
  step.until = local_time(next_);
  return step;
}

} // namespace follow
