// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/board_description.h"
#include "support/boards/emulated_usb.h"
#include "support/boards/firmware.h"
#include "support/boards/packets.h"
#include "support/boards/serial_chip.h"
#include "tactor/drivers/known_boards.h"

#include <cerrno>
#include <condition_variable>
#include <functional>
#include <limits>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace usb_test {

/// Timeout for what must happen, so that a failing test does not hang. Nothing waits for the
/// absence of an event.
constexpr auto kPatience = std::chrono::seconds(20);

/// A USB board: descriptors, control requests, bulk endpoints and a wire to the firmware. Public
/// methods are thread-safe.
class EmulatedBoard : private UsbfsNode::Device
{
public:
  EmulatedBoard(EmulatedUsb &usb, BoardDescription description,
                std::shared_ptr<Firmware> firmware = nullptr);
  ~EmulatedBoard();
  EmulatedBoard(const EmulatedBoard &) = delete;
  EmulatedBoard &operator=(const EmulatedBoard &) = delete;

  void plug();
  void unplug();

  // ---- received
  std::vector<Received> received() const
  {
    const std::lock_guard lock(mutex_);
    return received_;
  }
  Bytes bytes() const;
  /// False if fewer arrived within kPatience.
  bool wait_for_bytes(std::size_t count) const;
  bool wait_until(const std::function<bool()> &condition)
      const; ///< evaluated after each event, with the board locked
  /// Claims ("claim 0", "release 0", and "return 0" for the kernel's driver) and control requests
  /// ("40 03 c034 0000" and data), in order.
  std::vector<std::string> conversation() const
  {
    const std::lock_guard lock(mutex_);
    return conversation_;
  }
  int transfers_pending() const;
  /// Whether the last thing that happened to it is that the kernel's driver got it. The caller
  /// holds the lock.
  bool is_returned() const
  {
    return !conversation_.empty() && conversation_.back().starts_with("return");
  }
  /// Openings that have claimed the board. The caller holds the lock, as in wait_until() and
  /// with_firmware().
  std::size_t hosts() const
  {
    return hosts_.size();
  }
  int most_writes_pending() const
  {
    const std::lock_guard lock(mutex_);
    return most_writes_pending_;
  }
  /// Bytes in the chip's buffer. The caller holds the lock.
  std::size_t in_chip() const
  {
    return chip_.held();
  }
  /// Bytes lost from the chip's buffer.
  std::size_t cut_off() const
  {
    const std::lock_guard lock(mutex_);
    return chip_.cut_off();
  }
  /// Runs with the board locked.
  void with_firmware(const std::function<void()> &look) const;

  // ---- sent: each call in packets of its own
  void send(std::span<const std::uint8_t> bytes);
  /// Sends one packet, without the status bytes that a transport adds.
  void send_packet(const Bytes &packet);
  /// Limits the payload of a packet, in bytes.
  void fill_packets(std::size_t payload);
  /// Changes the firmware's replies before they are sent. Called with the board locked.
  void garble(std::function<void(Bytes &)> change);

  // ---- faults
  void stall(bool on); ///< the board accepts no data
  /// That many bulk transfers fail, or every one with kAll. Writes that begin later fail after half
  /// of their bytes.
  void break_transfers(int count, int error = EPROTO);
  void fail_next_write(int error)
  {
    const std::lock_guard lock(mutex_);
    write_failure_ = error;
  }
  /// DTR resets nothing.
  void ignore_dtr(bool on)
  {
    const std::lock_guard lock(mutex_);
    ignore_dtr_ = on;
  }
  /// Control requests are never answered.
  void ignore_requests(bool on)
  {
    const std::lock_guard lock(mutex_);
    ignore_requests_ = on;
  }
  bool wait_for_ignored_request() const;
  /// Control requests stall.
  void refuse_requests(bool on)
  {
    const std::lock_guard lock(mutex_);
    refuse_requests_ = on;
  }
  /// Claims fail with EBUSY.
  void use_by_another(bool on)
  {
    const std::lock_guard lock(mutex_);
    busy_ = on;
  }
  void forbid(); ///< denies opening, except to root
  static constexpr int kAll = std::numeric_limits<int>::max();

private:
  tactor::SerialDevice serial_device() const;
  // The caller holds the lock.
  bool claim(const void *host, int interface) override;
  void release(int interface) override
  {
    conversation_.push_back("release " + std::to_string(interface));
  }
  void give_back(int interface) override;
  void submit(const Urb &urb) override;
  std::optional<Urb> cancel(const void *host, gulong address) override;
  void host_left(const void *host) override;
  void changed() override
  {
    changed_.notify_all();
  }
  void control(const Urb &urb);
  void feed_reads();
  void say(Bytes reply);
  void to_firmware(std::uint8_t byte, Clock::time_point time);
  void break_one(const Urb &urb, std::size_t taken = 0);

  void run_wire();
  void carry(std::unique_lock<std::mutex> &lock);
  bool take_into_chip();
  void let_out();

  EmulatedUsb &usb_;
  const BoardDescription description_;
  const std::shared_ptr<Firmware> firmware_;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  bool plugged_ = false;
  bool stop_ = false;
  bool dtr_ = false;
  std::string syspath_;
  std::set<const void *> hosts_;
  std::list<UsbfsNode> nodes_; ///< the last is the current one, or the latest
  std::list<Urb> reads_;
  std::list<Urb> writes_;
  std::list<Urb> requests_; ///< not answered
  Packets for_host_;
  SerialChip chip_;
  Clock::time_point wire_free_{}; ///< without a buffer in the chip
  std::vector<Received> received_;
  std::vector<std::string> conversation_;
  int most_writes_pending_ = 0;

  std::function<void(Bytes &)> garble_;
  bool stalled_ = false;
  int failures_ = 0;
  int failure_ = 0;       ///< errno of each
  int write_failure_ = 0; ///< errno of the next write; 0: none
  bool ignore_dtr_ = false;
  bool ignore_requests_ = false;
  bool refuse_requests_ = false;
  bool busy_ = false;

  std::thread wire_;
};

} // namespace usb_test
