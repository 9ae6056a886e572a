// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/track_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace follow {

namespace {

Time
scaled(Time span, double by)
{
  return Time(std::llround(static_cast<double>(span.count()) * by));
}

} // namespace

void
TrackFollower::set_track(std::optional<tactile::Track> track)
{
  track_ = std::move(track);
  stretch_ = 0; // no stretch has this number
}

void
TrackFollower::edit_track(tactile::Track track)
{
  track_ = std::move(track);
}

void
TrackFollower::set_offset(Time later)
{
  offset_ = later;
}

void
TrackFollower::change_player()
{
  stretch_ = 0;
}

/// The track's map from a film time on, until it changes, a second at most; silence after the end.
tactile::Cue
TrackFollower::next_cue(Time begin) const
{
  const auto &entries = track_->entries();
  const auto next = std::ranges::upper_bound(entries, begin, {}, &tactile::Track::Entry::time);
  Time end = begin + tactile::CueBuilder::kLongest;
  if (next != entries.end())
    end = std::min(end, next->time);
  else if (begin < track_->end())
    end = std::min(end, track_->end());
  return { .begin = begin, .end = end, .map = track_->at(begin) };
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
  next_ = std::max(next_, film_time(now)); // what is past is not felt
  for (const Time until = film_time(now + ahead); next_ < until;) {
    tactile::Cue cue = next_cue(next_);
    next_ = cue.end;
    cue.begin = local_time(cue.begin);
    cue.end = local_time(cue.end);
    step.cues.push_back(std::move(cue));
  }
  return step;
}

} // namespace follow
