// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/websocket/answer_times.h"
#include "tactor/drivers/websocket/bhaptics_protocol.h"

#include <deque>
#include <optional>
#include <string_view>
#include <vector>

namespace tactor {

/// Which statuses of bHaptics Player answer messages. A status names no message, may come by
/// itself, and may not come at all.
///
/// - Where a message switches a position on or off and the server lists what plays, the first
///   status that has the change is the answer, and no earlier one.
/// - Otherwise each status is an answer. After a status without a message under way, only those
///   count that come as late as the last answer that was known to be one.
/// - Without an answer the next message goes when it is overdue. A server that never answers is
///   sent messages by time.
///
/// It reads no clock and is not thread-safe.
class BhapticsAnswers
{
public:
  struct Times
  {
    /// After the first message nothing else is sent for this time: the statuses then show whether
    /// the server answers, and whether it also sends statuses by itself.
    Time listening = std::chrono::milliseconds(500);
    /// For an answer, before the next message goes without it: twice the usual time, within these.
    Time shortest = std::chrono::milliseconds(200);
    Time longest = std::chrono::milliseconds(500);
    Time quick = std::chrono::milliseconds(50); ///< see is_quick()
    Time slack = std::chrono::milliseconds(50); ///< that motors run on if the next one is late
    Time renewal = std::chrono::milliseconds(100);
    Time forgotten = std::chrono::seconds(1); ///< no answer is expected any more
  };

  /// `positions` are those that messages are about.
  BhapticsAnswers(std::vector<std::string_view> positions, Times times);

  void begin();
  /// A message went out. `playing` are the positions that are on from now on.
  void sent(std::vector<std::string_view> playing, Time now);
  void heard(const bhaptics::Status &status, Time now);

  /// When the next message may go, as far as answers are concerned.
  Time ready_at() const;
  /// Whether a message beside one that is under way does not wait long, where it answers at all.
  bool is_quick() const;
  /// How long motors run after a message without another one.
  Time duration() const;
  /// The first message since the last status.
  std::optional<Time> waits_since() const;
  bool has_answered() const;
  /// Until then no other message than the first one is sent; none before the first one.
  std::optional<Time> listens_until() const;
  Time latency() const;

private:
  bool lists(const bhaptics::Status &status) const;
  bool shows_last(const bhaptics::Status &status) const;
  void forget(Time now);
  Time overdue() const;

  const std::vector<std::string_view> positions_;
  const Times times_;
  std::vector<std::string_view> playing_; ///< as sent last
  bool is_change_ = false;                ///< the last message, which alone was under way, made one
  bool lists_ = false;                    ///< the server lists what plays
  bool speaks_unasked_ = false;
  bool may_be_answered_ = false; ///< the last message, by a status that may be another one
  bool has_answered_ = false;
  std::deque<Time> under_way_; ///< when they were sent
  Time sent_at_{ 0 };
  Time overdue_at_{ 0 }; ///< the answer to the last message, whose duration is a little longer
  std::optional<Time> first_at_; ///< the first message
  std::optional<Time> waits_since_;
  std::optional<Time> certain_; ///< how long the last answer took that was one for certain
  AnswerTimes took_;
};

} // namespace tactor
