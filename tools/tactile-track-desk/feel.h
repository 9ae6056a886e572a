// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../visuotactile-follow/chair.h"

#include "desk/session.h"
#include "follow/position_estimator.h"
#include "follow/track_follower.h"

#include <functional>
#include <memory>
#include <string>

/// Plays the track on the chair along with the film of a page, or one map in a pause. Main
/// context's thread.
class Feel
{
public:
  /// The state of the chair, for pages.
  struct State
  {
    std::string state = "closed"; ///< or "open", "failed"
    std::string text;             ///< name of the board, or its fault
  };

  /// `sink` is tactorsink with its properties, as on a launch line.
  Feel(std::string sink, const desk::Session &session, std::function<void()> changed);
  ~Feel();
  Feel(const Feel &) = delete;
  Feel &operator=(const Feel &) = delete;

  const State &state() const
  {
    return state_;
  }

  /// The track was edited here; its grid stays.
  void track_changed(const desk::Session::Span &span);
  void position(const desk::PositionMessage &message);
  /// Plays the map for a time, unless the film plays.
  void feel(const tactile::TactileMap &map, follow::Time duration, const std::string &page);
  /// Motors to zero if the chair plays for this page.
  void left(const std::string &page);
  /// Motors to zero while the screen is locked or the computer sleeps.
  void rest(bool rests, const std::string &why);

private:
  void open();
  void close();
  void failed(const std::string &text);
  void say(const std::string &state, const std::string &text);
  void step();
  bool plays() const;

  std::function<void()> changed_;
  State state_;
  const desk::Session &session_;
  std::shared_ptr<tactile::Draft> played_; ///< the track of the follower
  std::string page_;                       ///< the page for which the chair plays
  follow::PositionEstimator estimator_;
  follow::TrackFollower follower_;
  Chair chair_;
  bool was_paused_ = true;
  bool rests_ = false;
  bool has_felt_ = false; ///< one map, whose vibration may not be over
  guint tick_ = 0;
};
