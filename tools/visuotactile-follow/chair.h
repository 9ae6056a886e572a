// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/live_settings.h"
#include "film/pipeline.h"
#include "follow/track_follower.h"

#include <functional>
#include <string>

/// tactorsink for a film in another program: a live pipeline that takes cues in local time. Main
/// context's thread.
class Chair
{
public:
  struct Events
  {
    std::function<void(const std::string &)> told;   ///< name of the board; warnings
    std::function<void(const std::string &)> failed; ///< nothing is felt any more
  };

  /// `sink` is tactorsink with its properties, as on a launch line. Opens no board.
  Chair(std::string sink, Events events);
  ~Chair();
  Chair(const Chair &) = delete;
  Chair &operator=(const Chair &) = delete;

  /// Opens the board for maps of this grid, unless it is open. Throws std::runtime_error.
  void open(int rows, int columns);
  /// Motors to zero, board released.
  void close();

  bool is_open() const
  {
    return pipeline_ != nullptr;
  }

  /// How far ahead of their time cues must be pushed.
  follow::Time ahead() const;
  void take(const follow::TrackFollower::Step &step);

private:
  gboolean on_message(GstMessage *message);
  void undo_latency();

  const std::string sink_line_;
  const Events events_;
  Pipeline pipeline_;
  Owned<GstElement> source_;
  Owned<GstElement> sink_;
  LiveSettings live_;
  guint watch_ = 0;
};
