// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/ahead_reader.h"

#include <algorithm>
#include <utility>

namespace follow {

namespace {

/// Interval after which CPU time is counted anew: unused time is not added to the next interval.
constexpr Time kCounted = std::chrono::seconds(1);

/// Key frames are seldom further apart.
constexpr Time kWait = std::chrono::seconds(15);

/// All that follows is known.
bool
is_all(Time known_until)
{
  return known_until >= tactile::Track::kMaxEnd;
}

} // namespace

AheadReader::AheadReader(std::unique_ptr<MapSource> source) : source_(std::move(source))
{
}

Time
AheadReader::known_until(Time position) const
{
  if (!draft_)
    return position;
  // From begin_ to reach_ all is known: no need to look.
  return draft_->known_until(begin_ <= position && position < reach_ ? reach_ : position);
}

void
AheadReader::step(Time position, Time now, Time cpu)
{
  if (!failure_.empty() || complete_)
    return;
  while (failure_.empty() && may_read(position, now, cpu)) {
    const std::optional<tactile::Cue> cue = source_->take();
    if (!cue) {
      ended_ = source_->is_ended();
      break;
    }
    add(*cue);
  }
  if (failure_.empty())
    failure_ = source_->failure();
  if (failure_.empty())
    choose(position, now);
}

bool
AheadReader::is_far_ahead(Time position) const
{
  const Time known = known_until(position);
  return !is_all(known) && known > position + kFar;
}

/// Whether reading may continue: less than kFar is known ahead, and CPU time is left.
bool
AheadReader::may_read(Time position, Time now, Time cpu)
{
  if (is_far_ahead(position))
    return false;
  const Time known = known_until(position);
  if (!mark_ || now - *mark_ >= kCounted) {
    mark_ = now;
    cpu_mark_ = cpu;
  }
  const double share = known < position + kNear ? kUrgentShare : kShare;
  const Time passed = std::max(now - *mark_, Time(std::chrono::milliseconds(20)));
  return static_cast<double>((cpu - cpu_mark_).count())
         <= share * static_cast<double>(passed.count());
}

void
AheadReader::add(const tactile::Cue &cue)
{
  if (!draft_)
    draft_ = std::make_shared<tactile::Draft>(cue.map.rows, cue.map.columns);
  if (!exactly_ && !std::exchange(arrived_, true))
    begin_ = reach_ = cue.begin;
  if (cue.begin > reach_)
    set(reach_, cue.begin, tactile::TactileMap(cue.map.rows, cue.map.columns));
  set(cue.begin, cue.end, cue.map);
  reach_ = std::max(reach_, cue.end);
}

void
AheadReader::set(Time begin, Time end, const tactile::TactileMap &map)
{
  if (const auto done = draft_->set(begin, end, map); !done)
    failure_ = done.error().text();
}

/// Where to read on.
void
AheadReader::choose(Time position, Time now)
{
  if (ended_ && draft_ && (exactly_ || arrived_)) {
    end_ = std::max(end_, reach_);
    set(reach_, tactile::Track::kMaxEnd, tactile::TactileMap(draft_->rows(), draft_->columns()));
  }
  Time want = known_until(position);
  if (draft_ && is_all(want)) { // the skipped parts
    want = draft_->known_until(Time(0));
    complete_ = is_all(want);
  }
  if (ended_ && !draft_) { // nothing from there on, or nothing at all
    want = Time(0);
    if (begin_ == want)
      failure_ = "nothing in it can be decoded";
  }
  if (complete_ || !failure_.empty() || !source_->is_open())
    return;
  const bool is_late = want == position && position > reach_ + kLag;
  if (!is_late)
    late_since_.reset();
  else if (!late_since_)
    late_since_ = now;
  if (!ended_ && is_late && now - *late_since_ > kPatience) {
    too_slow_ = true;
    seek(position + std::chrono::seconds(1), false);
  } else if (!exactly_ && !ended_ && want < begin_ && want > begin_ - kWait) {
    // The source reaches this part without a seek.
  } else if (ended_ || want < begin_ || want > reach_ + kSkip) {
    seek(want, true);
  }
}

void
AheadReader::seek(Time to, bool exactly)
{
  source_->seek(to, exactly);
  begin_ = reach_ = to;
  exactly_ = exactly;
  arrived_ = false;
  ended_ = false;
  late_since_.reset();
}

} // namespace follow
