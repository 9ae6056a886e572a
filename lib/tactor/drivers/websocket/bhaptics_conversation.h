// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/conversation.h"
#include "tactor/drivers/websocket/bhaptics_answers.h"
#include "tactor/drivers/websocket/bhaptics_protocol.h"

#include <tl/expected.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace tactor {

/// A part of a suit: "vest-back", "visor".
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
  Time hello = std::chrono::milliseconds(500);   ///< for the status that a server sends by itself
  Time answer = std::chrono::seconds(5);         ///< for a status
  Time interval = std::chrono::milliseconds(20); ///< the Player's own, at which it drives motors
  Time longest_latency = std::chrono::milliseconds(150);
  BhapticsAnswers::Times answers{};
};

/// A conversation with bHaptics Player, or with a server that speaks as it does.
///
/// 1. *Asking*: the first status says whether the part is connected. Earlier messages of this
///    program are ended. The server may send a status by itself, which is no answer: hence the
///    first message waits for it, and play for further ones.
/// 2. *Playing*: the newest intensities, one message at a time (BhapticsAnswers), and again before
///    their duration ends while a motor is on. A zero waits for an answer only where the server is
///    slow, at which it would wait all the same. The duration is the watchdog. A server that has
///    answered before and does not for long is left.
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
  /// Time until the server answers. Delays behind it, such as Bluetooth, are not known.
  Time latency() const override;

private:
  using Intensities = std::vector<int>;

  void take(const bhaptics::Status &status);
  std::string write_zeros(Time now);
  std::string write_changes(Time now);
  std::string write(std::span<const bhaptics::Frame> frames, Time now);
  std::optional<Time> plays_at() const;
  std::optional<Time> due() const;
  Time turn() const;
  std::optional<Time> silent_at() const;
  bhaptics::Frame frame(std::size_t position, const Intensities &intensities) const;

  const std::string server_;
  const SuitPart part_;
  const BhapticsPatience patience_;
  Intensities wanted_;
  Intensities sent_;
  Time sent_at_{ 0 };
  std::optional<Time> greets_at_; ///< until the first message was sent
  bool is_connected_ = false;     ///< the part, as the first status said
  BhapticsAnswers answers_;
};

/// The part with this name; empty: the default one. The error lists the names.
tl::expected<SuitPart, DriverError> find_suit_part(const std::string &name);

} // namespace tactor
