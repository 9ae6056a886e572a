// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/conversation.h"
#include "tactor/drivers/websocket/answer_times.h"
#include "tactor/drivers/websocket/buttplug_protocol.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tactor {

/// Times of a conversation with a Buttplug server.
struct ButtplugPatience
{
  Time answer = std::chrono::seconds(5);
  Time closing = std::chrono::milliseconds(250); ///< for the answer that the devices were stopped
  /// Between commands to a device of which the server knows no gap.
  Time gap = std::chrono::milliseconds(50);
  Time longest_latency = std::chrono::milliseconds(150);
};

/// A conversation with a Buttplug server, such as Intiface.
///
/// 1. *Asking*: server and client agree on version 4, else on 3, which needs a new connection. Of
///    the server's devices those are taken that the user named; they are stopped.
/// 2. *Playing*: for each device the newest values, one message at a time, not faster than its gap.
///    A zero waits for neither: it is sent at once, and again when the device's turn comes, as a
///    server may carry out overlapping messages in another order. How long the answers take is the
///    latency. Pings, by which the server knows that this program lives.
/// 3. *Closing*: the devices are stopped. Others are never touched.
class ButtplugConversation : public Conversation
{
public:
  /// Errors in a row after which a device counts as lost.
  static constexpr int kMostErrors = 10;

  /// `server` for messages. `names`, separated by commas, are DeviceDisplayName or DeviceName of
  /// the server's devices.
  ButtplugConversation(std::string server, const std::string &names,
                       ButtplugPatience patience = {});

  std::vector<std::string> parts() const override;
  void begin(Time now) override;
  void received(std::string_view text, Time now) override;
  void hung_up(const std::string &why) override;
  void set_levels(std::span<const double> levels) override;
  std::optional<std::string> next(Time now) override;
  std::optional<Time> deadline() const override;
  void close(Time now) override;
  ServedDevice device() const override;
  /// The latency of the slowest device.
  Time latency() const override;

private:
  /// A device that was taken.
  struct Taken
  {
    buttplug::Device device;
    std::vector<int> wanted; ///< of each vibrator, in steps
    std::vector<int> sent;
    std::vector<buttplug::Id> unanswered; ///< commands under way
    Time sent_at{ 0 };                    ///< the last one
    Time waits_since{ 0 };                ///< the first one that is under way, or the last one
    bool has_hurried = false;             ///< a zero was sent before the device's turn
    AnswerTimes answers{};
    int errors = 0; ///< in a row
  };
  enum class Step
  {
    greeting,
    listing,
    stopping,
    done,
  };

  template <class... Kinds> void take_any(const std::variant<Kinds...> &message, Time now);
  void take(const buttplug::ServerInfo &info, Time now);
  void take(const buttplug::Ok &ok, Time now);
  void take(const buttplug::Error &error, Time now);
  void take(const buttplug::DeviceList &list, Time now);
  void take(const buttplug::DeviceRemoved &removed, Time now);
  void choose(const std::vector<buttplug::Device> &devices, Time now);
  void answered(buttplug::Id id, bool is_done, Time now);
  void stop_all(Time now);
  bool is_stopped() const;
  void lose(const Taken &taken, const std::string &why);
  void try_older(const std::string &why);
  std::optional<std::string> next_command(Taken &taken, Time now);
  std::optional<Time> turn(const Taken &taken) const;
  std::optional<Time> due(const Taken &taken) const;
  void sends(Taken &taken, std::vector<buttplug::Id> ids, Time now);
  std::optional<Time> silent_at() const;
  buttplug::Id new_id(buttplug::Id count = 1);

  const std::string server_;
  const std::vector<std::string> names_;
  const ButtplugPatience patience_;
  int version_ = buttplug::kNewest;
  Step step_ = Step::greeting;
  std::vector<std::string> outbox_; ///< to send first, in this order
  buttplug::Id last_id_ = 0;
  buttplug::Id asked_ = 0; ///< the question of this step
  buttplug::ServerInfo info_;
  std::vector<Taken> taken_;
  std::optional<buttplug::Id> ping_; ///< under way
  Time asked_at_{ 0 };               ///< begin of this step
  Time ping_at_{ 0 };                ///< the last one, or the beginning
};

} // namespace tactor
