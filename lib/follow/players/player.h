// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/evidence.h"
#include "follow/report.h"
#include "tracks/track.h"

#include <glib.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace follow {

/// Callbacks of a player, on the thread of the main context in which it was opened. They must not
/// destroy the player.
struct PlayerEvents
{
  std::function<void(const Report &)> reported;
  std::function<void(const std::string &why)> gone; ///< once; nothing follows
};

/// A connection to a player. It neither waits nor throws. For the thread of its main context.
class Player
{
public:
  virtual ~Player() = default;

  virtual const std::string &name() const = 0; ///< for messages
  virtual Habits habits() const = 0;
  /// The measured delay of its sound against its picture.
  virtual Time sound_latency() const
  {
    return Time(0);
  }
  /// Whether its position is 0 at the film's 0:00. Others report the time stamps of Matroska, and
  /// in transport and program streams the time since their clock began.
  virtual bool counts_from_start() const
  {
    return true;
  }
  /// The reason for which its position is unusable and nothing is felt; empty: none.
  virtual const std::string &fault() const
  {
    static const std::string none;
    return none;
  }
  /// A remark about the player for the user; empty: none.
  virtual std::string remark() const
  {
    return {};
  }
  virtual Source source() const
  {
    return Source::player;
  }
  /// Whether it is connected when it is made. Otherwise it reports by itself when it is.
  virtual bool is_announced() const
  {
    return true;
  }
  /// The track of the film that it reported last, if it knows one.
  virtual std::shared_ptr<const tactile::Track> track() const
  {
    return nullptr;
  }
  /// Queries the position now, if the player is queried for it.
  virtual void ask()
  {
  }
};

/// Local time of reports.
inline Time
local_time()
{
  return std::chrono::microseconds(g_get_monotonic_time());
}

} // namespace follow
