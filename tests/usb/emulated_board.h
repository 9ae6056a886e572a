// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "emulated_usb.h"
#include "firmware.h"

#include <cerrno>
#include <condition_variable>
#include <deque>
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

/// How long something that must come may take, in a test that would otherwise hang. Nothing is ever waited for that shall not come.
constexpr auto kPatience = std::chrono::seconds(20);

enum class Transport
{
  cdc_acm,
  ftdi,
  ch340,
};

constexpr Transport kTransports[] = { Transport::cdc_acm, Transport::ftdi, Transport::ch340 };

struct BoardDescription
{
  Transport transport = Transport::cdc_acm;
  std::string port = "1-1"; ///< where it is plugged in
  std::string serial = "75833353035351F0C0A1";
  std::string manufacturer = "Arduino (www.arduino.cc)";
  std::string product = "Mega 2560";
  std::optional<std::uint16_t> vendor{};
  Bytes descriptors{}; ///< instead of the transport's
  double baud = 0;     ///< of the emulated wire from host to board; 0: no time passes on it
  /// Bytes that the USB chip takes at once and lets out as the wire goes (an ATmega16U2 as on a Mega: 128); 0: a transfer is done when its
  /// last byte has left. What a chip still holds when the kernel's driver has the board back is lost: see give_back().
  std::size_t chip = 0;
};

/// A USB board: descriptors, control requests, bulk endpoints and a wire of some speed to the firmware behind it. All public methods may be
/// called by any thread.
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

  static Bytes descriptors(Transport transport, std::optional<std::uint16_t> vendor = {});

  // ---- what came
  struct Received
  {
    Clock::time_point time; ///< its stop bit's end on the wire
    std::uint8_t byte = 0;
  };
  std::vector<Received> received() const;
  Bytes bytes() const;
  /// False if there were not as many within kPatience.
  bool wait_for_bytes(std::size_t count) const;
  bool wait_until(const std::function<bool()> &condition)
      const; ///< asked after every event; the board's lock is held
  /// Claims ("claim 0", "release 0", "return 0": to the kernel's driver) and control requests ("40 03 c034 0000", data after that), in order.
  std::vector<std::string> conversation() const;
  int transfers_pending() const;
  /// That have claimed the board and not closed it. With the lock held: in wait_until() and with_firmware().
  std::size_t hosts() const;
  int most_writes_pending() const;
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
  /// So many bulk transfers end in an error, writes that begin after this with half of their bytes taken; kAll: every one.
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
  void release(int interface) override;
  void give_back(int interface) override;
  void submit(const Urb &urb) override;
  std::optional<Urb> cancel(const void *host, gulong address) override;
  void host_left(const void *host) override;
  void changed() override;
  void bind(int interface, bool has_driver);
  void control(const Urb &urb);
  void feed_reads();
  void queue_for_host(std::span<const std::uint8_t> bytes);
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
  const std::size_t packet_;       ///< bytes, of the bulk endpoints
  const std::size_t status_bytes_; ///< that begin each packet to the host

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
  std::deque<Bytes> for_host_;
  Clock::time_point wire_free_{};
  std::deque<Received> in_chip_; ///< with the time at which each will have left
  std::size_t cut_off_ = 0;
  std::vector<Received> received_;
  std::vector<std::string> conversation_;
  int most_writes_pending_ = 0;

  std::size_t payload_; ///< of a packet to the host
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
