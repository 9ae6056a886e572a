// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/stop_board.h"

#include "tactor/drivers/board_choice.h"
#include "tactor/drivers/firmata_protocol.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace tactor {

namespace {

/// The answers at a port. Its methods may be called on any thread.
class Answers
{
public:
  SerialPort::Events events()
  {
    return {
      .received = [this](std::span<const std::uint8_t> bytes) { take(bytes); },
      .written = [this] { note([this] { is_writing_ = false; }); },
      .lost = [this](const std::string &why) { note([&] { lost_ = why; }); },
    };
  }

  /// Resets the board. False if it has not answered within the patience.
  bool reset(SerialPort &port, std::chrono::milliseconds patience)
  {
    std::unique_lock lock(mutex_);
    if (lost_)
      return false;
    if (!std::exchange(is_writing_, true)) {
      // The last host of the board may have been cut off within a message.
      const std::vector<std::uint8_t> bytes
          = firmata::Encoder().end_sysex().reset().ask_version().bytes();
      lock.unlock();
      const bool is_taken = port.write(bytes);
      lock.lock();
      is_writing_ = is_writing_ && is_taken;
    }
    changed_.wait_for(lock, patience, [this] { return is_answered_ || lost_; });
    return is_answered_;
  }

  std::string why() const
  {
    const std::lock_guard lock(mutex_);
    return lost_.value_or(is_writing_ ? "it does not take what it is sent" : "it does not answer");
  }

private:
  void take(std::span<const std::uint8_t> bytes)
  {
    note([&] {
      decoder_.feed(bytes, [this](const firmata::Event &event) {
        is_answered_ = is_answered_ || std::holds_alternative<firmata::VersionReport>(event);
      });
    });
  }

  template <class F> void note(F what)
  {
    const std::lock_guard lock(mutex_);
    what();
    changed_.notify_all();
  }

  mutable std::mutex mutex_; ///< guards all below
  std::condition_variable changed_;
  firmata::Decoder decoder_;
  bool is_answered_ = false;
  bool is_writing_ = false;
  std::optional<std::string> lost_;
};

} // namespace

tl::expected<void, DriverError>
stop_board(SerialBus &bus, const SerialDevice &device, bool *may_pulse,
           const StopPatience &patience)
{
  std::string why;
  {
    Answers answers;
    const tl::expected<std::unique_ptr<SerialPort>, DriverError> port
        = bus.open(device, answers.events());
    if (!port)
      return tl::unexpected(port.error());
    for (int tries = 0; tries < patience.tries; tries++)
      if (answers.reset(**port, patience.answer))
        return {};
    why = answers.why();
  }
  if (may_pulse != nullptr && std::exchange(*may_pulse, false) && bus.reset(device))
    why += "; it was reset by DTR and does not say whether that worked";
  return tl::unexpected(DriverError{ DriverError::Kind::failed, describe(device) + ": " + why });
}

std::string
advice_after(const DriverError &not_stopped)
{
  return not_stopped.text
         + (not_stopped.kind == DriverError::Kind::not_found
                ? "; if it has a supply of its own, its motors may still be on: switch that off"
                : "; its motors may still be on: switch their supply off");
}

} // namespace tactor
