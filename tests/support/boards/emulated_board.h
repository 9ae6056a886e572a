// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/board_description.h"
#include "support/boards/emulated_usb.h"
#include "support/boards/firmware.h"
#include "support/boards/packets.h"
#include "support/boards/serial_chip.h"

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

/// How long something that must come may take, in a test that would otherwise hang. Nothing is ever
/// waited for that shall not come.
constexpr auto kPatience = std::chrono::seconds(20);

/// A USB board: descriptors, control requests, bulk endpoints and a wire of some speed to the
/// firmware behind it. All public methods may be called by any thread.
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

  // ---- what came
  std::vector<Received> received() const;
  Bytes bytes() const;
  /// False if there were not as many within kPatience.
  bool wait_for_bytes(std::size_t count) const;
  bool wait_until(const std::function<bool()> &condition)
      const; ///< asked after every event; the board's lock is held
  /// Claims ("claim 0", "release 0", "return 0": to the kernel's driver) and control requests ("40
  /// 03 c034 0000", data after that), in order.
  std::vector<std::string> conversation() const;
  int transfers_pending() const;
  /// That have claimed the board and not closed it. With the lock held: in wait_until() and
  /// with_firmware().
  std::size_t hosts() const
  {
    return hosts_.size();
  }
  int most_writes_pending() const;
  /// Bytes that the chip has taken and not let out. With the lock held, as hosts().
  std::size_t in_chip() const
  {
    return chip_.held();
  }
  /// Bytes that the chip had taken and that never came to the firmware.
  std::size_t cut_off() const;
  /// Runs while the firmware stands still.
  void with_firmware(const std::function<void()> &look) const;

  // ---- what is sent: each as packets of its own
  void send(std::span<const std::uint8_t> bytes);
  /// One packet as it is, with what a transport adds: nothing.
  void send_packet(const Bytes &packet);
  /// Packets have at most so many bytes of the line's.
  void fill_packets(std::size_t payload);
  /// Changes what the firmware says before it is sent, with the lock held.
  void garble(std::function<void(Bytes &)> change);

  // ---- what goes wrong
  void stall(bool on); ///< what is sent is not taken
  /// So many bulk transfers end in an error, writes that begin after this with half of their bytes
  /// taken; kAll: every one.
  void break_transfers(int count, int error = EPROTO);
  void ignore_requests(bool on); ///< control requests are never answered
  bool wait_for_ignored_request() const;
  void refuse_requests(bool on); ///< control requests stall
  void use_by_another(bool on);  ///< claims end in EBUSY
  void forbid();                 ///< nobody may open the device any more; root still may
  static constexpr int kAll = std::numeric_limits<int>::max();

private:
  // With the lock held.
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
  std::list<UsbfsNode> nodes_; ///< the last one is where it is plugged in, or was
  std::list<Urb> reads_;
  std::list<Urb> writes_;
  std::list<Urb> requests_; ///< that are not being answered
  Packets for_host_;
  SerialChip chip_;
  Clock::time_point wire_free_{}; ///< without a chip that holds bytes
  std::vector<Received> received_;
  std::vector<std::string> conversation_;
  int most_writes_pending_ = 0;

  std::function<void(Bytes &)> garble_;
  bool stalled_ = false;
  int failures_ = 0;
  int failure_ = 0; ///< errno of each
  bool ignore_requests_ = false;
  bool refuse_requests_ = false;
  bool busy_ = false;

  std::thread wire_;
};

} // namespace usb_test
