// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The state of a Follower for its queries, and the delay of the vibration.
#include "follower.h"
#include "translation.h"

#include <cmath>
#include <stdexcept>
#include <utility>

using follow::Doing;
using follow::local_time;

const char *
word(Doing doing)
{
  switch (doing) {
  case Doing::stopped:
    return "stopped";
  case Doing::paused:
    return "paused";
  case Doing::stalled:
    return "waits";
  case Doing::playing:
    return "plays";
  }
  return "";
}

double
Follower::nudge(double by)
{
  if (current_ == nullptr)
    throw std::runtime_error(_("no film plays whose time could be moved"));
  const std::string kind = player_kind(current_->player->name());
  timing_.set_offset(kind, timing_.offset(kind) + by);
  set_delay();
  const double offset = timing_.offset(kind);
  tell("the offset with " + kind + " is " + std::to_string(std::lround(offset)) + " ms");
  return offset;
}

double
Follower::nudge_film(double by)
{
  if (current_ == nullptr || film_.empty())
    throw std::runtime_error(_("no film plays whose time could be moved"));
  const std::string film = library::film_name(film_);
  timing_.set_film_offset(film, timing_.film_offset(film) + by);
  set_delay();
  const double offset = timing_.film_offset(film);
  tell("the offset of '" + film + "' is " + std::to_string(std::lround(offset)) + " ms");
  return offset;
}

gboolean
Follower::nudged(double by)
{
  try {
    nudge(by);
  } catch (const std::runtime_error &error) {
    tell(error.what());
  }
  return G_SOURCE_CONTINUE;
}

SyncTo
Follower::sync_to() const
{
  return settings_.sync_to.value_or(
      timing_.sync_to(player_kind(current_->player->name())).value_or(SyncTo::screen));
}

/// Delay in ms from the picture of the followed player until it is seen, or its sound heard.
double
Follower::latency() const
{
  const follow::Player &player = *current_->player;
  const std::string kind = player_kind(player.name());
  if (player.source() == follow::Source::listener) // it hears what is audible, when it is
    return timing_.sound_latency(kind).value_or(0);
  if (sync_to() == SyncTo::screen)
    return settings_.screen_latency.value_or(timing_.screen_latency(kind).value_or(0));
  const std::chrono::duration<double, std::milli> measured = player.sound_latency();
  return settings_.sound_latency.value_or(timing_.sound_latency(kind).value_or(measured.count()));
}

void
Follower::set_delay()
{
  const double later = latency() + timing_.offset(player_kind(current_->player->name()))
                       + timing_.film_offset(library::film_name(film_));
  cues_.set_delay(follow::Time(std::llround(later * 1e6)));
}

FollowStatus
Follower::status() const
{
  const auto seconds = [](follow::Time time) {
    return std::chrono::duration<double>(time).count();
  };
  FollowStatus status{ .state = rests_ ? "rests" : "idle", .library = settings_.track.library };
  if (current_ == nullptr || current_->is_gone)
    return status;
  const follow::Time now = local_time();
  status.player = current_->player->name();
  if (!rests_)
    status.state = word(current_->last.doing);
  status.film = library::film_name(film_);
  status.track = film_track_.what();
  status.fault = film_track_.fault();
  if (current_->last.doing == Doing::playing && !current_->player->fault().empty()) {
    status.state = "lost";
    status.fault = no_position();
  }
  status.sync_to = name_of(sync_to());
  status.latency = latency();
  status.offset = timing_.offset(player_kind(status.player));
  status.film_offset = timing_.film_offset(status.film);
  if (const auto estimate = film_position(now))
    status.position = seconds(estimate->position);
  if (const auto known = film_track_.known_until(position_);
      known && *known < tactile::Track::kMaxEnd)
    status.ahead = seconds(*known - position_);
  return status;
}

std::string
Follower::no_position() const
{
  return "no usable position: " + current_->player->fault();
}

/// Prints a fault or peculiarity of the player, once.
void
Follower::tell_of_player()
{
  const follow::Player &player = *current_->player;
  std::string text
      = player.fault().empty() ? player.remark() : "reports " + no_position() + "; nothing is felt";
  if (text != current_->told && !text.empty())
    tell(player.name() + " " + text);
  current_->told = std::move(text);
}
