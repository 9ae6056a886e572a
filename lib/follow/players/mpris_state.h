// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <glib.h>

#include <optional>
#include <string>

namespace follow {

/// The properties of a player by MPRIS 2 (org.mpris.MediaPlayer2.Player). Values of other
/// types than the specification's are ignored. Not thread-safe.
class MprisState
{
public:
  /// Properties of PropertiesChanged or GetAll: a{sv}.
  void take(GVariant *properties);

  /// A report at a local time, without a position.
  Report report(Time now) const;
  bool plays() const
  {
    return doing_ == Doing::playing;
  }

private:
  void take_metadata(GVariant *metadata);

  Doing doing_ = Doing::stopped;
  double rate_ = 1;
  std::string film_; ///< its URL, else its title
  std::optional<Time> length_;
};

} // namespace follow
