// SPDX-License-Identifier: LGPL-2.1-or-later
#include "feel.h"

#include "follow/players/player.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

using follow::local_time;

namespace {

/// Nothing is felt after so long without a position: docs/design/desk.md.
constexpr follow::Time kPatience = std::chrono::seconds(1);
constexpr guint kTick = 50; ///< ms; a chair takes cues 150 ms before its motors need them

follow::PositionEstimator
new_estimator()
{
  return follow::PositionEstimator({ .habits = { .most_patience = kPatience } });
}

} // namespace

Feel::Feel(std::string sink, const desk::Session &session, std::function<void()> changed)
    : changed_(std::move(changed)), session_(session), estimator_(new_estimator()),
      chair_(std::move(sink), { .told = [this](const std::string &text) { say("open", text); },
                                .failed =
                                    [this](const std::string &text) {
                                      failed(text);
                                    } })
{
}

Feel::~Feel()
{
  if (tick_ != 0)
    g_source_remove(tick_);
}

void
Feel::say(const std::string &state, const std::string &text)
{
  state_ = { .state = state, .text = text };
  changed_();
}

void
Feel::failed(const std::string &text)
{
  chair_.close();
  if (tick_ != 0)
    g_source_remove(tick_);
  tick_ = 0;
  say("failed", text);
}

void
Feel::open()
{
  if (tick_ != 0)
    return;
  try {
    played_ = std::make_shared<tactile::Draft>(session_.document().track());
    chair_.open(played_->rows(), played_->columns());
    follower_.set_track(played_);
  } catch (const std::runtime_error &error) {
    failed(error.what());
    return;
  }
  tick_ = g_timeout_add(
      kTick,
      +[](gpointer self) -> gboolean {
        auto *feel = static_cast<Feel *>(self);
        try {
          feel->step();
          return G_SOURCE_CONTINUE;
        } catch (const std::exception &error) {
          feel->tick_ = 0; // ends by that
          feel->failed(error.what());
          return G_SOURCE_REMOVE;
        }
      },
      this);
  say("open", state_.text);
}

void
Feel::track_changed(const desk::Session::Span &span)
{
  if (tick_ == 0)
    return;
  const auto set = [this](std::int32_t begin, std::int32_t end, const tactile::TactileMap &map) {
    // Cannot fail: the map is from a track. Cues that were handed on stay.
    played_->set(std::chrono::milliseconds(begin), std::chrono::milliseconds(end), map);
  };
  set(span.start, span.end, tactile::TactileMap(played_->rows(), played_->columns()));
  const std::vector<desk::Cue> &cues = session_.document().cues();
  for (auto cue = std::ranges::upper_bound(cues, span.start, {}, &desk::Cue::end);
       cue != cues.end() && cue->start < span.end; ++cue)
    set(cue->start, cue->end, session_.document().map(*cue));
}

void
Feel::step()
{
  const follow::Time now = local_time();
  auto step = follower_.step(estimator_.at(now), now, chair_.ahead());
  if (!step.cues.empty()) // the film ends a map that is still felt
    step.silence = std::exchange(has_felt_, false) || step.silence;
  chair_.take(step);
}

bool
Feel::plays() const
{
  const auto estimate = estimator_.at(local_time());
  return estimate && estimate->rate > 0;
}

void
Feel::position(const desk::PositionMessage &message)
{
  if (rests_)
    return;
  if (std::exchange(page_, message.page) != message.page) {
    estimator_ = new_estimator();
    follower_.change_player();
  }
  // A chair that has failed is tried again when the film begins to play again.
  const bool begins = std::exchange(was_paused_, message.paused) && !message.paused;
  if (begins || (!message.paused && state_.state != "failed"))
    open();
  estimator_.report({ .received = local_time(),
                      .position = follow::Time(std::llround(message.position * 1e6)),
                      .doing = message.paused ? follow::Doing::paused : follow::Doing::playing,
                      .rate = message.rate,
                      .sought = message.leap });
  step();
}

void
Feel::feel(const tactile::TactileMap &map, follow::Time duration, const std::string &page)
{
  if (rests_ || plays())
    return;
  page_ = page;
  open();
  const follow::Time begin = local_time() + chair_.ahead();
  const follow::Time end = begin + duration;
  const tactile::TactileMap silent(map.rows, map.columns);
  chair_.take({ .silence = true,
                .cues = { { .begin = begin, .end = end, .map = map },
                          { .begin = end, .end = end + kPatience, .map = silent } } });
  has_felt_ = true;
}

void
Feel::left(const std::string &page)
{
  if (page != page_)
    return;
  const bool was_open = tick_ != 0;
  close();
  if (was_open)
    say("closed", "");
}

void
Feel::rest(bool rests, const std::string &why)
{
  rests_ = rests;
  close(); // motors at zero when it returns
  say("closed", rests ? "nothing is felt: " + why : "");
}

void
Feel::close()
{
  page_.clear();
  was_paused_ = true;
  has_felt_ = false;
  estimator_ = new_estimator();
  if (tick_ != 0)
    g_source_remove(tick_);
  tick_ = 0;
  chair_.close();
}
