// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>
#include <string>

namespace follow {

using visuotactile::Time;

/// The state of a player, as reported.
enum class Doing
{
  stopped, ///< no film is open
  paused,
  stalled, ///< would play, but waits for data, or seeks
  playing,
};

/// Where the positions of a player come from.
enum class Source
{
  player,       ///< itself
  media_server, ///< coarsely
  listener,     ///< its sound
};

/// A report of a player at one moment. Local times are of the monotonic clock.
struct Report
{
  Time received{ 0 }; ///< local time
  /// Local time before which the position was not read, if known: the time of the query.
  std::optional<Time> asked{};
  std::optional<Time> position{}; ///< film time; none: this report has something else
  Doing doing = Doing::playing;
  double rate = 1;              ///< film seconds a second
  bool sought = false;          ///< the player says that the position has leapt
  std::string film{};           ///< path, URI or title; a report of another one is of a new film
  std::optional<Time> length{}; ///< of the film, if the player reports it
};

} // namespace follow
