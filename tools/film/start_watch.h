// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/pbutils/pbutils.h>

#include <memory>

/// Where players show a film's 0:00 (lib/gst/cues/film_start.h).
struct StartTimes
{
  visuotactile::Time stream{ 0 };  ///< in GStreamer's stream time
  visuotactile::Time running{ 0 }; ///< in running time, where it is played from its beginning
  /// For players that do not count from 0:00, such as VLC: their position at 0:00.
  visuotactile::Time told{ 0 };
};

/// Watches the demuxers of a discoverer, which has all streams at their first data when it is done.
/// Any thread.
class StartWatch
{
public:
  /// Before it discovers one film.
  explicit StartWatch(GstDiscoverer *discoverer);
  ~StartWatch();
  StartWatch(const StartWatch &) = delete;
  StartWatch &operator=(const StartWatch &) = delete;

  StartTimes times() const;

private:
  struct State;
  std::shared_ptr<State> state_;
};
