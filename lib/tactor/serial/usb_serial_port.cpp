// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/usb_serial_port.h"

#include "tactor/realtime/realtime_thread.h"
#include "tactor/serial/control_transfer.h"
#include "tactor/serial/permission.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace tactor {

namespace {

/// DTR acts on a board's reset by a capacitor of 100 nF, which 10 kΩ discharge.
constexpr auto kHangUp = std::chrono::milliseconds(20);

constexpr auto kErrorPause = std::chrono::milliseconds(10);

/// Delay of a USB chip between its endpoint and its serial line.
constexpr auto kChipTime = std::chrono::milliseconds(2);

std::string
called(const SerialDevice &device)
{
  return device.name + " at USB " + device.bus_path;
}

tl::unexpected<DriverError>
failure(int error, const SerialDevice &device, const char *what)
{
  using Kind = DriverError::Kind;
  switch (error) {
  case LIBUSB_ERROR_ACCESS:
    return tl::unexpected(
        DriverError{ Kind::permission, called(device) + " may not be opened by you; "
                                           + permission_advice(device.bus_path) });
  case LIBUSB_ERROR_BUSY:
    return tl::unexpected(DriverError{
        Kind::busy, called(device) + " is in use by another program; close that first" });
  case LIBUSB_ERROR_NO_DEVICE:
    return tl::unexpected(DriverError{ Kind::not_found, called(device) + " was unplugged" });
  default:
    return tl::unexpected(
        DriverError{ Kind::failed, called(device) + " " + what + ": "
                                       + libusb_strerror(static_cast<libusb_error>(error)) });
  }
}

tl::expected<UsbSerialDevice, DriverError>
find(const UsbContext &context, const SerialDevice &device)
{
  tl::expected<std::vector<UsbSerialDevice>, DriverError> all = find_serial_devices(context);
  if (!all)
    return tl::unexpected(all.error());
  for (UsbSerialDevice &found : *all)
    if (found.device == device)
      return std::move(found); // cppcheck-suppress returnStdMoveLocal; no local, but an element
  return tl::unexpected(
      DriverError{ DriverError::Kind::not_found, called(device) + " is not plugged in" });
}

/// A transfer's callback that calls a method of its port.
template <auto method>
void LIBUSB_CALL
forward(libusb_transfer *transfer)
{
  using Port = std::remove_pointer_t<decltype([]<class T>(void (T::*)(libusb_transfer &)) {
    return static_cast<T *>(nullptr);
  }(method))>;
  (static_cast<Port *>(transfer->user_data)->*method)(*transfer);
}

} // namespace

tl::expected<ClaimedDevice, DriverError>
ClaimedDevice::open(const UsbContext &context, const SerialDevice &device, bool raises_dtr,
                    std::chrono::milliseconds request_patience, const std::stop_token &stop)
{
  tl::expected<UsbSerialDevice, DriverError> found = find(context, device);
  if (!found)
    return tl::unexpected(found.error());
  ClaimedDevice claimed;
  claimed.line_ = std::move(found->line);
  libusb_device_handle *handle = nullptr;
  if (const int error = libusb_open(found->handle.get(), &handle); error != LIBUSB_SUCCESS)
    return failure(error, device, "cannot be opened");
  claimed.handle_.reset(handle);
  libusb_set_auto_detach_kernel_driver(handle, 1);
  return claimed.claim(device)
      .and_then([&] {
        std::vector<ControlRequest> requests = claimed.line_.set_up;
        if (raises_dtr)
          std::ranges::copy(claimed.line_.ready, std::back_inserter(requests));
        return claimed.make(requests, context, device, request_patience, stop);
      })
      .map([&] { return std::move(claimed); });
}

ClaimedDevice::~ClaimedDevice()
{
  for (; !claimed_.empty(); claimed_.pop_back())
    libusb_release_interface(handle_.get(), claimed_.back());
}

tl::expected<void, DriverError>
ClaimedDevice::claim(const SerialDevice &device)
{
  for (const int interface : line_.interfaces) {
    if (const int error = libusb_claim_interface(handle_.get(), interface); error != LIBUSB_SUCCESS)
      return failure(error, device, "cannot be claimed");
    claimed_.push_back(interface);
  }
  return {};
}

tl::expected<void, DriverError>
ClaimedDevice::make(const std::vector<ControlRequest> &requests, const UsbContext &context,
                    const SerialDevice &device, std::chrono::milliseconds patience,
                    const std::stop_token &stop) const
{
  for (const ControlRequest &request : requests)
    if (const int error = control_transfer(context, handle_.get(), request, patience, stop);
        error != LIBUSB_SUCCESS)
      return failure(error, device, "cannot be set up");
  return {};
}

tl::expected<void, DriverError>
ClaimedDevice::pulse_dtr(const UsbContext &context, const SerialDevice &device,
                         std::chrono::milliseconds patience) const
{
  if (line_.hang_up.empty())
    return tl::unexpected(DriverError{ DriverError::Kind::failed,
                                       called(device) + " is not known to be reset by DTR" });
  return make(line_.hang_up, context, device, patience, {}).and_then([&] {
    std::this_thread::sleep_for(kHangUp);
    return make(line_.ready, context, device, patience, {});
  });
}

tl::expected<std::unique_ptr<UsbSerialPort>, DriverError>
UsbSerialPort::open(const SerialDevice &device, Events events, const UsbPatience &patience,
                    const std::stop_token &stop)
{
  tl::expected<UsbContext, DriverError> context = UsbContext::create();
  if (!context)
    return tl::unexpected(context.error());
  tl::expected<ClaimedDevice, DriverError> claimed
      = ClaimedDevice::open(*context, device, events.raises_dtr, patience.request, stop);
  if (!claimed)
    return tl::unexpected(claimed.error());
  std::unique_ptr<UsbSerialPort> port(
      new UsbSerialPort(std::move(*context), std::move(*claimed), std::move(events)));
  if (!port->allocate(patience))
    return failure(LIBUSB_ERROR_NO_MEM, device, "cannot be used");
  if (const tl::expected<void, DriverError> begun = port->begin(); !begun)
    return tl::unexpected(begun.error());
  return port;
}

UsbSerialPort::UsbSerialPort(UsbContext context, ClaimedDevice device, Events events)
    : events_(std::move(events)), context_(std::move(context)), device_(std::move(device))
{
}

/// False if memory is out.
bool
UsbSerialPort::allocate(const UsbPatience &patience)
{
  const SerialLine &line = device_.line();
  for (std::size_t i = 0; i < kReads; i++)
    reads_[i] = allocate(line.in_endpoint, read_buffers_[i], forward<&UsbSerialPort::read_done>, 0);
  write_ = allocate(line.out_endpoint, write_buffer_, forward<&UsbSerialPort::write_done>,
                    static_cast<unsigned>(patience.write.count()));
  received_.reserve(kReadSize);
  return write_
         && std::ranges::all_of(reads_, [](const Transfer &read) { return read != nullptr; });
}

tl::expected<void, DriverError>
UsbSerialPort::begin()
{
  tl::expected<Thread, DriverError> thread = Thread::start([this] { run(); });
  if (!thread)
    return tl::unexpected(thread.error());
  thread_ = std::move(*thread);
  const std::lock_guard lock(mutex_);
  for (Transfer &read : reads_)
    if (!submit(*read))
      break;
  return {};
}

UsbSerialPort::~UsbSerialPort()
{
  if (!thread_)
    return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  // Without the lock: a transfer that completes now is not submitted again.
  libusb_cancel_transfer(write_.get());
  for (Transfer &read : reads_)
    libusb_cancel_transfer(read.get());
  {
    PriorityLock lock(mutex_);
    settled_.wait(lock, [this] { return in_flight_ == 0; });
    stop_ = true;
  }
  libusb_interrupt_event_handler(context_.get());
  thread_.join();
  // The kernel's driver takes over and sets another baud rate, which cuts off bytes that the chip
  // still holds: kMaxWrite bytes or 90 ms at most.
  std::this_thread::sleep_until(carried_ + kChipTime);
}

UsbSerialPort::Transfer
UsbSerialPort::allocate(std::uint8_t endpoint, std::span<std::uint8_t> buffer,
                        libusb_transfer_cb_fn done, unsigned patience_ms)
{
  Transfer transfer(libusb_alloc_transfer(0));
  if (transfer)
    libusb_fill_bulk_transfer(transfer.get(), device_.get(), endpoint, buffer.data(),
                              static_cast<int>(buffer.size()), done, this, patience_ms);
  return transfer;
}

bool
UsbSerialPort::write(std::span<const std::uint8_t> bytes)
{
  assert(!bytes.empty() && bytes.size() <= kMaxWrite);
  const std::lock_guard lock(mutex_);
  if (writing_ || lost_ || bytes.empty() || bytes.size() > kMaxWrite)
    return false;
  std::copy(bytes.begin(), bytes.end(), write_buffer_.begin());
  write_->buffer = write_buffer_.data();
  write_->length = static_cast<int>(bytes.size());
  writing_ = submit(*write_);
  return writing_;
}

void
UsbSerialPort::run()
{
  RealtimeThread realtime(events_.realtime);
  PriorityLock lock(mutex_);
  while (!stop_) {
    lock.unlock();
    realtime.turn();
    const int error = libusb_handle_events_completed(context_.get(), nullptr);
    lock.lock();
    if (error != LIBUSB_SUCCESS && error != LIBUSB_ERROR_INTERRUPTED) {
      lose(libusb_strerror(static_cast<libusb_error>(error)));
      settled_.wait_for(lock, kErrorPause); // no busy loop if it keeps failing
    }
    if (loss_ && !closing_) {
      const std::string why = *std::exchange(loss_, std::nullopt);
      lock.unlock();
      if (events_.lost)
        events_.lost(why);
      lock.lock();
    }
  }
}

void
UsbSerialPort::read_done(libusb_transfer &transfer)
{
  const SerialLine &line = device_.line();
  received_.clear();
  // All packets of a transfer but the last are full.
  for (int begin = 0; begin < transfer.actual_length; begin += line.in_packet)
    received_.insert(received_.end(),
                     transfer.buffer + std::min(begin + line.status_bytes, transfer.actual_length),
                     transfer.buffer + std::min(begin + line.in_packet, transfer.actual_length));
  {
    const std::lock_guard lock(mutex_);
    if (!goes_on(transfer) || !submit(transfer))
      return;
  }
  if (!received_.empty() && events_.received)
    events_.received(received_);
}

void
UsbSerialPort::write_done(libusb_transfer &transfer)
{
  {
    const std::lock_guard lock(mutex_);
    note_taken(transfer.actual_length);
    if (!goes_on(transfer))
      return;
    transfer.buffer += transfer.actual_length;
    transfer.length -= transfer.actual_length;
    if (transfer.length > 0) {
      submit(transfer);
      return;
    }
    writing_ = false;
  }
  if (events_.written)
    events_.written();
}

bool
UsbSerialPort::submit(libusb_transfer &transfer)
{
  const int error = libusb_submit_transfer(&transfer);
  if (error == LIBUSB_SUCCESS) {
    in_flight_++;
    return true;
  }
  lose(error == LIBUSB_ERROR_NO_DEVICE ? "it was unplugged"
                                       : libusb_strerror(static_cast<libusb_error>(error)));
  return false;
}

/// Accounts for a completed transfer. False if no more is to be submitted.
bool
UsbSerialPort::goes_on(const libusb_transfer &transfer)
{
  if (--in_flight_ == 0)
    settled_.notify_all();
  int &errors = transfer.endpoint == device_.line().in_endpoint ? read_errors_ : write_errors_;
  switch (transfer.status) {
  case LIBUSB_TRANSFER_COMPLETED:
    errors = 0;
    break;
  case LIBUSB_TRANSFER_ERROR:
  case LIBUSB_TRANSFER_OVERFLOW:
    if (++errors >= kErrorsInARow)
      lose("it does not answer any more; was it unplugged?");
    break;
  case LIBUSB_TRANSFER_NO_DEVICE:
    lose("it was unplugged");
    break;
  case LIBUSB_TRANSFER_TIMED_OUT:
    lose("it has not taken what it was sent for " + std::to_string(transfer.timeout) + " ms");
    break;
  case LIBUSB_TRANSFER_STALL:
    lose("it refuses what it is sent");
    break;
  case LIBUSB_TRANSFER_CANCELLED:
    lose("it was reset");
    break;
  }
  return !lost_ && !closing_;
}

/// Accounts for the bytes of a completed transfer, which are in the chip or on the line.
void
UsbSerialPort::note_taken(int bytes)
{
  if (bytes == 0)
    return;
  const auto now = std::chrono::steady_clock::now();
  carried_ = std::min(std::max(carried_, now) + bytes * kByteTime,
                      now + static_cast<int>(kMaxWrite) * kByteTime);
}

void
UsbSerialPort::lose(const std::string &why)
{
  if (closing_ || lost_)
    return;
  lost_ = true;
  loss_ = why;
  libusb_interrupt_event_handler(context_.get());
}

} // namespace tactor
