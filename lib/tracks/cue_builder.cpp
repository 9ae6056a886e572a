// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/cue_builder.h"

#include <algorithm>
#include <utility>

namespace tactile {

void
CueBuilder::add(Time begin, Time end, const TactileMap &map)
{
  if (open_ && begin > open_->end && begin - open_->end <= kSeam)
    open_->end = begin;
  if (open_ && (begin < open_->begin || begin > open_->end || map != open_->map)) {
    open_->end = std::clamp(begin, open_->begin, open_->end);
    flush();
  }
  if (!open_)
    open_ = { begin, end, map };
  open_->end = std::max(open_->end, end);
  while (open_->end - open_->begin > kLongest) {
    complete_.push_back({ open_->begin, open_->begin + kLongest, open_->map });
    open_->begin += kLongest;
  }
}

void
CueBuilder::flush()
{
  if (open_ && open_->end > open_->begin)
    complete_.push_back(*std::exchange(open_, std::nullopt));
  open_.reset();
}

std::optional<Cue>
CueBuilder::take()
{
  if (complete_.empty())
    return std::nullopt;
  Cue cue = std::move(complete_.front());
  complete_.pop_front();
  return cue;
}

void
CueBuilder::reset()
{
  open_.reset();
  complete_.clear();
}

std::deque<Cue>
cues_of(const Track &track)
{
  CueBuilder builder;
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++)
    builder.add(entries[i].time, i + 1 < entries.size() ? entries[i + 1].time : track.end(),
                entries[i].map);
  builder.flush();
  std::deque<Cue> cues;
  while (std::optional<Cue> cue = builder.take())
    cues.push_back(*std::move(cue));
  return cues;
}

} // namespace tactile
