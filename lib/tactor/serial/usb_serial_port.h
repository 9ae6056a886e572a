// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"
#include "tactor/priority_mutex.h"
#include "tactor/serial/enumeration.h"
#include "tactor/serial/serial_port.h"
#include "tactor/serial/usb_patience.h"
#include "tactor/thread.h"

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace tactor {

/// An open device with its interfaces claimed. The destructor returns it to the kernel's driver.
class ClaimedDevice
{
public:
  [[nodiscard]] static tl::expected<ClaimedDevice, DriverError>
  open(const UsbContext &context, const SerialDevice &device, bool raises_dtr,
       std::chrono::milliseconds request_patience, const std::stop_token &stop);
  ~ClaimedDevice();
  ClaimedDevice(ClaimedDevice &&) = default;
  ClaimedDevice &operator=(ClaimedDevice &&) = delete;

  /// Switches DTR off and on.
  [[nodiscard]] tl::expected<void, DriverError> pulse_dtr(const UsbContext &context,
                                                          const SerialDevice &device,
                                                          std::chrono::milliseconds patience) const;

  libusb_device_handle *get() const
  {
    return handle_.get();
  }

  const SerialLine &line() const
  {
    return line_;
  }

private:
  ClaimedDevice() = default;
  tl::expected<void, DriverError> claim(const SerialDevice &device);
  tl::expected<void, DriverError> make(const std::vector<ControlRequest> &requests,
                                       const UsbContext &context, const SerialDevice &device,
                                       std::chrono::milliseconds patience,
                                       const std::stop_token &stop) const;

  struct Close
  {
    void operator()(libusb_device_handle *handle) const
    {
      libusb_close(handle);
    }
  };

  SerialLine line_;
  std::unique_ptr<libusb_device_handle, Close> handle_;
  std::vector<int> claimed_;
};

/// A serial line over bulk transfers. UsbSerialBus describes its threads.
class UsbSerialPort : public SerialPort
{
public:
  /// Errors as of SerialBus::open().
  [[nodiscard]] static tl::expected<std::unique_ptr<UsbSerialPort>, DriverError>
  open(const SerialDevice &device, Events events, const UsbPatience &patience,
       const std::stop_token &stop);
  ~UsbSerialPort() override;

  bool write(std::span<const std::uint8_t> bytes) override;

private:
  /// Enough for the host controller to have one while others are processed.
  static constexpr std::size_t kReads = 4;
  /// A multiple of every packet size, so that no packet overflows it.
  static constexpr std::size_t kReadSize = 512;
  /// After this many errors in a row the board is lost. Without a board each transfer fails, with
  /// electrical noise a few do.
  static constexpr int kErrorsInARow = 2 * kReads;

  struct FreeTransfer
  {
    void operator()(libusb_transfer *transfer) const
    {
      libusb_free_transfer(transfer);
    }
  };
  using Transfer = std::unique_ptr<libusb_transfer, FreeTransfer>;

  UsbSerialPort(UsbContext context, ClaimedDevice device, Events events);
  bool allocate(const UsbPatience &patience);
  tl::expected<void, DriverError> begin();
  Transfer allocate(std::uint8_t endpoint, std::span<std::uint8_t> buffer,
                    libusb_transfer_cb_fn done, unsigned patience_ms);
  void run();
  void read_done(libusb_transfer &transfer);
  void write_done(libusb_transfer &transfer);

  // With mutex_ held.
  bool submit(libusb_transfer &transfer);
  bool goes_on(const libusb_transfer &transfer);
  void lose(const std::string &why);
  void note_taken(int bytes);

  const Events events_;
  const UsbContext context_;
  const ClaimedDevice device_;

  std::array<std::array<std::uint8_t, kReadSize>, kReads> read_buffers_{};
  std::array<std::uint8_t, kMaxWrite> write_buffer_{};
  std::array<Transfer, kReads> reads_;
  Transfer write_;
  std::vector<std::uint8_t> received_; ///< without status bytes; event thread only

  PriorityMutex mutex_;             ///< guards what follows
  PriorityCondition settled_;       ///< in_flight_ became 0
  std::size_t in_flight_ = 0;       ///< transfers submitted and not completed
  int read_errors_ = 0;             ///< in a row
  int write_errors_ = 0;            ///< in a row
  bool writing_ = false;            ///< a write is pending
  bool closing_ = false;            ///< no more events or transfers
  bool stop_ = false;               ///< ends the event thread
  bool lost_ = false;               ///< no more transfers, and no event but `lost`
  std::optional<std::string> loss_; ///< why; the event thread has yet to call `lost`

  std::chrono::steady_clock::time_point carried_{}; ///< when the line has carried all bytes

  Thread thread_;
};

} // namespace tactor
