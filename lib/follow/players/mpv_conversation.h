// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <optional>
#include <string>
#include <string_view>

typedef struct _JsonObject JsonObject;

namespace follow {

/// mpv's JSON IPC: it notifies of each change of the observed properties. Its position is that of
/// the frame that it begins to wait for: when the one before comes to the screen, but at the
/// earliest its option video-timing-offset before the frame's time. Reports have the position of
/// the film at that moment. Reads no clock, has no socket, and is not thread-safe.
class MpvConversation
{
public:
  MpvConversation();

  /// The first queries of an open connection.
  static std::string questions();
  /// A query for a time without notifications: its answer is a report without a position. A frame
  /// may last for seconds.
  static std::string life_sign();
  /// Whether the film should go on, as mpv said last.
  bool plays() const
  {
    return doing() == Doing::playing;
  }

  /// Takes a line of any content, received at a local time. Returns a report if the line has one.
  std::optional<Report> received(std::string_view line, Time now);

private:
  Time shown(Time position);
  bool take(const std::string &property, JsonObject *fields);
  Doing doing() const;
  std::string film() const;

  std::string path_;
  bool ended_ = false; ///< the present film; mpv notifies of the next path if it differs
  std::string folder_; ///< mpv's working directory
  bool paused_ = false;
  bool idle_ = true; ///< neither plays nor is paused; mpv reports it last but one
  bool seeking_ = false;
  double rate_ = 1;
  Time frame_{ 0 };              ///< duration of the last reported one; 0: unknown
  Time earliest_;                ///< local time before a frame's time
  std::optional<Time> told_;     ///< of the frame before
  std::optional<Time> position_; ///< received since the last report
  bool sought_ = false;          ///< no position was received since
};

} // namespace follow
