// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/conversation.h"
#include "tactor/drivers/websocket/answer_times.h"
#include "tactor/drivers/websocket/bhaptics_protocol.h"

#include <tl/expected.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace tactor {

/// What of a suit plays: "vest-back", "visor".
struct SuitPart
{
  std::string_view name;
  std::vector<std::string_view> positions; ///< side by side, or each a panel
  Layout layout;
};

/// All names; the first one is the default.
const std::vector<SuitPart> &suit_parts();

/// Times of a conversation with bHaptics Player.
struct BhapticsPatience
{
  Time hello = std::chrono::milliseconds(500); ///< for the status that a server sends unasked
  Time answer = std::chrono::seconds(5);       ///< for a status
  /// Of each message: how long motors run after it. The watchdog.
  Time duration = std::chrono::milliseconds(300);
  Time renewal = std::chrono::milliseconds(100);
  Time interval = std::chrono::milliseconds(20); ///< the Player's own, at which it drives motors
  /// How long a message waits for the status that answers the one before; as much longer for each
  /// further one without. The Player does not promise to answer each.
  Time turn = std::chrono::milliseconds(250);
  /// By which a message lasts longer than it takes until the next one may go: no gap is felt.
  Time overlap = std::chrono::milliseconds(50);
  Time longest_latency = std::chrono::milliseconds(150);
};

/// A conversation with bHaptics Player, or with a server that speaks as it does.
///
/// 1. *Asking*: the first status says whether the part is connected. What this program played there
///    before is ended. The server may send a status by itself, which is no answer: hence the first
///    message waits for it.
/// 2. *Playing*: the newest intensities, one message at a time, and again before their duration
///    ends while a motor is on. How long the answers take is the latency. A status does not say
///    which message it answers: with a server that also sends some unasked, more than one message
///    may be under way, never faster than `interval`.
class BhapticsConversation : public Conversation
{
public:
  /// `server` for messages. `part` is of suit_parts().
  BhapticsConversation(std::string server, SuitPart part, BhapticsPatience patience = {});

  std::vector<std::string> parts() const override;
  void begin(Time now) override;
  void received(std::string_view text, Time now) override;
  void set_levels(std::span<const double> levels) override;
  std::optional<std::string> next(Time now) override;
  std::optional<Time> deadline() const override;
  void close(Time now) override;
  ServedDevice device() const override;
  Time latency() const override;

private:
  using Intensities = std::vector<int>;

  void take(const bhaptics::Status &status);
  std::string write_zeros(Time now);
  std::string write_changes(Time now);
  std::string write(std::span<const bhaptics::Frame> frames, Time now);
  Time patience() const;
  std::optional<Time> due() const;
  std::optional<Time> silent_at() const;
  bool is_on() const;
  bhaptics::Frame frame(std::size_t position, const Intensities &intensities) const;

  const std::string server_;
  const SuitPart part_;
  const BhapticsPatience patience_;
  Intensities wanted_;
  Intensities sent_;
  Time sent_at_{ 0 };
  std::optional<Time> greets_at_;   ///< until the first message was sent
  int unanswered_ = 0;              ///< messages
  std::optional<Time> waits_since_; ///< the first message after the last status
  AnswerTimes answers_;
};

/// The part with this name; empty: the default one. The error lists the names.
tl::expected<SuitPart, DriverError> find_suit_part(const std::string &name);

} // namespace tactor
