// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <optional>
#include <string>
#include <string_view>

typedef struct _JsonObject JsonObject;

namespace follow {

/// mpv's JSON IPC: it tells each change of what was asked for once. Its position is that of the
/// frame that it begins to wait for: one frame after the one on the screen, which is what is
/// reported. Reads no clock, has no socket, and is not thread-safe.
class MpvConversation
{
public:
  /// What to send when the connection is open.
  static std::string questions();

  /// A line of any content, received at a local time. A report, if it tells something.
  std::optional<Report> received(std::string_view line, Time now);

private:
  Time shown(Time position) const;
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
  Time frame_{ 0 };              ///< duration of one; 0: unknown
  std::optional<Time> position_; ///< told since the last report
  bool sought_ = false;          ///< no position was told since
};

} // namespace follow
