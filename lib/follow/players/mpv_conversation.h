// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <optional>
#include <string>
#include <string_view>

typedef struct _JsonObject JsonObject;

namespace follow {

/// mpv's JSON IPC: it tells each change of what was asked for once. Its position is that of the
/// frame that it begins to wait for: when the one before comes to the screen, but at the earliest
/// its option video-timing-offset before the frame's time. What is reported is where the film is
/// then. Reads no clock, has no socket, and is not thread-safe.
class MpvConversation
{
public:
  MpvConversation();

  /// What to send when the connection is open.
  static std::string questions();
  /// What to send while mpv tells nothing: its answer is a report without a position. A frame may
  /// last for seconds.
  static std::string life_sign();
  /// Whether the film should go on, as mpv said last.
  bool plays() const
  {
    return doing() == Doing::playing;
  }

  /// A line of any content, received at a local time. A report, if it tells something.
  std::optional<Report> received(std::string_view line, Time now);

private:
  Time shown(Time position);
  bool take(const std::string &property, JsonObject *fields);
  Doing doing() const;
  std::string film() const;

  std::string path_;
  bool ended_ = false; ///< the film there; the next one's path is told only if it is another
  std::string folder_; ///< mpv's working directory
  bool paused_ = false;
  bool idle_ = false; ///< neither plays nor is paused
  bool seeking_ = false;
  double rate_ = 1;
  Time frame_{ 0 };              ///< duration of the last one that was told; 0: unknown
  Time earliest_;                ///< local time before a frame's time
  std::optional<Time> told_;     ///< of the frame before
  std::optional<Time> position_; ///< told since the last report
  bool sought_ = false;          ///< no position was told since
};

} // namespace follow
