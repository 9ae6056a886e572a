// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../visuotactile-follow/chair.h"

#include "desk/session.h"
#include "follow/position_estimator.h"
#include "follow/track_follower.h"

#include <functional>
#include <memory>
#include <string>

/// The chair plays along with the film of a page, or feels one map while that stands. Of the main
/// context's thread.
class Feel
{
public:
  /// How the chair is, for pages.
  struct State
  {
    std::string state = "closed"; ///< or "open", "failed"
    std::string text;             ///< which board, or what is wrong
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
  /// The map for a time, unless the film plays.
  void feel(const tactile::TactileMap &map, follow::Time duration, const std::string &page);
  /// Motors to zero if the page is the one that plays.
  void left(const std::string &page);
  /// Motors to zero, until nobody rests any more: the screen is locked, or the computer sleeps.
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
  std::shared_ptr<tactile::Draft> played_; ///< what the follower reads
  std::string page_;                       ///< for which the chair plays
  follow::PositionEstimator estimator_;
  follow::TrackFollower follower_;
  Chair chair_;
  bool was_paused_ = true;
  bool rests_ = false;
  bool has_felt_ = false; ///< one map, which may still be felt
  guint tick_ = 0;
};
