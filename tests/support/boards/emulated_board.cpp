// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/emulated_board.h"

#include "support/boards/hex.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace usb_test {

EmulatedBoard::EmulatedBoard(EmulatedUsb &usb, BoardDescription description,
                             std::shared_ptr<Firmware> firmware)
    : usb_(usb), description_(std::move(description)), firmware_(std::move(firmware)),
      for_host_(description_.transport),
      chip_(description_.chip, description_.baud, description_.chip_time),
      wire_(&EmulatedBoard::run_wire, this)
{
  plug();
}

EmulatedBoard::~EmulatedBoard()
{
  unplug();
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }
  wire_.join();
  nodes_.clear(); // their threads use the board
}

/// As it is listed, as far as it is recognized by that.
tactor::SerialDevice
EmulatedBoard::serial_device() const
{
  const Bytes descriptors = usb_descriptors(description_);
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(
        at + 1 < descriptors.size() ? descriptors[at] | descriptors[at + 1] << 8 : 0);
  };
  return { .serial = description_.serial,
           .bus_path = description_.port,
           .vendor = word(8),
           .product = word(10) };
}

void
EmulatedBoard::plug()
{
  const std::lock_guard lock(mutex_);
  const int bus = std::atoi(description_.port.c_str());
  const int address = usb_.next_address();
  syspath_ = format("/devices/usb%d/%s", bus, description_.port.c_str());
  // Must precede the hot-plug event.
  UsbfsNode::Device &self = *this;
  nodes_.emplace_back(usb_, usb_node(bus, address), mutex_, self);

  plugged_ = true;
  dtr_ = false;
  if (firmware_)
    firmware_->reset(); // power; nobody hears its banner
  if (description_.is_known)
    tactor::KnownBoards(tactor::KnownBoards::default_file()).add(serial_device());
  const std::string device = umockdev_entry(description_, syspath_, bus, address);
  GError *error = nullptr;
  if (!umockdev_testbed_add_from_string(usb_.testbed(), device.c_str(), &error))
    throw std::runtime_error(error->message);
  usb_.bind(syspath_, 0, true);
}

void
EmulatedBoard::unplug()
{
  const std::lock_guard lock(mutex_);
  if (!plugged_)
    return;
  plugged_ = false;
  // The event reads the properties from sysfs.
  umockdev_testbed_uevent(usb_.testbed(), ("/sys" + syspath_).c_str(), "remove");
  umockdev_testbed_remove_device(usb_.testbed(), ("/sys" + syspath_).c_str());
  for (std::list<Urb> *pending : { &reads_, &writes_, &requests_ })
    for (; !pending->empty(); pending->pop_front())
      nodes_.back().done(pending->front(), -ESHUTDOWN, 0);
  nodes_.back().unplug();
  for_host_.clear();
  chip_.lose_power();
  changed_.notify_all();
}

// ---- received

Bytes
EmulatedBoard::bytes() const
{
  Bytes all;
  for (const Received &one : received())
    all.push_back(one.byte);
  return all;
}

bool
EmulatedBoard::wait_until(const std::function<bool()> &condition) const
{
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kPatience, condition);
}

bool
EmulatedBoard::wait_for_bytes(std::size_t count) const
{
  return wait_until([&] { return received_.size() >= count; });
}

int
EmulatedBoard::transfers_pending() const
{
  const std::lock_guard lock(mutex_);
  return static_cast<int>(reads_.size() + writes_.size() + requests_.size()
                          + nodes_.back().to_be_reaped());
}

bool
EmulatedBoard::wait_for_ignored_request() const
{
  return wait_until([this] { return !requests_.empty(); });
}

void
EmulatedBoard::with_firmware(const std::function<void()> &look) const
{
  const std::lock_guard lock(mutex_);
  look();
}

// ---- faults

void
EmulatedBoard::stall(bool on)
{
  const std::lock_guard lock(mutex_);
  stalled_ = on;
  changed_.notify_all();
}

void
EmulatedBoard::break_transfers(int count, int error)
{
  const std::lock_guard lock(mutex_);
  failures_ = count;
  failure_ = error;
  for (std::list<Urb> *pending : { &reads_, &writes_ })
    for (; failures_ > 0 && !pending->empty(); pending->pop_front())
      break_one(pending->front());
  changed_.notify_all();
}

void
EmulatedBoard::break_one(const Urb &urb, std::size_t taken)
{
  failures_ -= failures_ < kAll ? 1 : 0;
  if (description_.chip > 0)
    chip_.take(urb.bytes().first(taken), Clock::now());
  else
    for (const std::uint8_t byte : urb.bytes().first(taken))
      to_firmware(byte, Clock::now());
  nodes_.back().done(urb, -failure_, taken);
}

void
EmulatedBoard::forbid()
{
  const std::lock_guard lock(mutex_);
  nodes_.back().forbid();
}

// ---- to the host

void
EmulatedBoard::send(std::span<const std::uint8_t> bytes)
{
  const std::lock_guard lock(mutex_);
  for_host_.add(bytes);
  feed_reads();
}

void
EmulatedBoard::send_packet(const Bytes &packet)
{
  const std::lock_guard lock(mutex_);
  for_host_.add_packet(packet);
  feed_reads();
}

void
EmulatedBoard::fill_packets(std::size_t payload)
{
  const std::lock_guard lock(mutex_);
  for_host_.fill(payload);
}

void
EmulatedBoard::garble(std::function<void(Bytes &)> change)
{
  const std::lock_guard lock(mutex_);
  garble_ = std::move(change);
}

void
EmulatedBoard::say(Bytes reply)
{
  if (garble_)
    garble_(reply);
  if (!reply.empty())
    for_host_.add(reply);
}

void
EmulatedBoard::feed_reads()
{
  while (!reads_.empty() && !for_host_.empty()) {
    const Bytes bytes = for_host_.take();
    const Urb urb = reads_.front();
    reads_.pop_front();
    const std::size_t size = std::min(bytes.size(), urb.bytes().size());
    std::copy_n(bytes.begin(), size, urb.bytes().begin());
    nodes_.back().done(urb, size < bytes.size() ? -EOVERFLOW : 0, size);
  }
}

// ---- requests of the host

bool
EmulatedBoard::claim(const void *host, int interface)
{
  if (busy_)
    return false;
  hosts_.insert(host);
  usb_.bind(syspath_, interface, false);
  conversation_.push_back(format("claim %d", interface));
  return true;
}

/// The kernel's driver then sets 9600 baud, for which the chip resets its UART.
void
EmulatedBoard::give_back(int interface)
{
  conversation_.push_back(format("return %d", interface));
  usb_.bind(syspath_, interface, true);
  chip_.switch_line(Clock::now() + kernel_opens(description_));
}

void
EmulatedBoard::submit(const Urb &urb)
{
  if (urb.is_control()) {
    control(urb);
  } else if (write_failure_ != 0 && !urb.is_to_host()) {
    nodes_.back().done(urb, -std::exchange(write_failure_, 0), 0);
  } else if (failures_ > 0) {
    break_one(urb, urb.is_to_host() ? 0 : urb.bytes().size() / 2);
  } else if (urb.is_to_host()) {
    reads_.push_back(urb);
    feed_reads();
  } else {
    writes_.push_back(urb);
    most_writes_pending_ = std::max(most_writes_pending_, static_cast<int>(writes_.size()));
  }
}

std::optional<Urb>
EmulatedBoard::cancel(const void *host, gulong address)
{
  for (std::list<Urb> *pending : { &reads_, &writes_, &requests_ })
    for (auto urb = pending->begin(); urb != pending->end(); ++urb)
      if (urb->host == host && urb->urb->client_addr == address) {
        const Urb found = *urb;
        pending->erase(urb);
        return found;
      }
  return std::nullopt;
}

void
EmulatedBoard::host_left(const void *host)
{
  hosts_.erase(host);
  for (std::list<Urb> *pending : { &reads_, &writes_, &requests_ })
    std::erase_if(*pending, [host](const Urb &urb) {
      if (urb.host != host)
        return false;
      g_object_unref(urb.urb);
      return true;
    });
}

void
EmulatedBoard::control(const Urb &urb)
{
  const std::uint8_t *bytes = urb.bytes().data();
  const auto word = [&](int at) {
    return bytes[at] | bytes[at + 1] << 8;
  };
  const int length = word(6);
  const bool in = bytes[0] & 0x80;
  std::string request = format("%02x %02x %04x %04x", bytes[0], bytes[1], word(2), word(4));
  if (length > 0)
    request += in ? format(" %d bytes", length)
                  : " " + hex({ bytes + 8, static_cast<std::size_t>(length) });
  conversation_.push_back(request);
  if (ignore_requests_) {
    requests_.push_back(urb);
    return;
  }
  if (refuse_requests_) {
    nodes_.back().done(urb, -EPIPE, 0);
    return;
  }
  if (in)
    std::fill_n(urb.bytes().begin() + 8, length, 0x31);
  nodes_.back().done(urb, 0, static_cast<std::size_t>(length));
  // A rising DTR resets the board.
  const bool dtr = request.starts_with("21 22 0003") || request.starts_with("40 01 0101")
                   || request.starts_with("40 a4 ff9f");
  if (dtr && !dtr_ && !ignore_dtr_ && firmware_) {
    say(firmware_->reset());
    feed_reads();
  }
  const bool is_off = request.starts_with("21 22 0000") || request.starts_with("40 01 0100")
                      || request.starts_with("40 a4 ffff");
  dtr_ = (dtr_ || dtr) && !is_off;
}

// ---- the wire to the firmware

void
EmulatedBoard::run_wire()
{
  std::unique_lock lock(mutex_);
  while (!stop_) {
    let_out();
    std::optional<Clock::time_point> next = firmware_ ? firmware_->next() : std::nullopt;
    const std::optional<Clock::time_point> leaves = chip_.next();
    if (leaves)
      next = std::min(next.value_or(*leaves), *leaves);
    if (take_into_chip()) {
      changed_.notify_all();
    } else if (description_.chip == 0 && !stalled_ && !writes_.empty()) {
      carry(lock);
    } else if (!next) {
      changed_.wait(lock);
    } else if (Clock::now() < *next) {
      changed_.wait_until(lock, *next);
    } else if (!leaves || *next < *leaves) {
      firmware_->pass(*next);
      changed_.notify_all();
    }
  }
}

/// The next transfer, if there is room for it.
bool
EmulatedBoard::take_into_chip()
{
  if (stalled_ || writes_.empty() || !chip_.has_room_for(writes_.front().bytes().size()))
    return false;
  chip_.take(writes_.front().bytes(), Clock::now());
  const Urb whole = writes_.front();
  writes_.pop_front();
  nodes_.back().done(whole, 0, whole.bytes().size());
  return true;
}

/// Delivers the bytes that have left the chip.
void
EmulatedBoard::let_out()
{
  while (const std::optional<Received> one = chip_.let_out(Clock::now())) {
    to_firmware(one->byte, one->time);
    feed_reads();
    changed_.notify_all();
  }
}

/// Sends a transfer at the wire's rate. It completes when its last byte has left.
void
EmulatedBoard::carry(std::unique_lock<std::mutex> &lock)
{
  const UMockdevIoctlData *const urb = writes_.front().urb;
  const Bytes bytes(writes_.front().bytes().begin(), writes_.front().bytes().end());
  const Clock::duration byte_time = chip_.byte_time();
  const Clock::time_point begin = std::max(Clock::now(), wire_free_);
  const Clock::time_point end = begin + byte_time * bytes.size();
  const auto gone = [&] {
    return stop_ || stalled_ || writes_.empty() || writes_.front().urb != urb;
  };
  const bool cut = end > Clock::now() && changed_.wait_until(lock, end, gone);
  std::size_t carried = bytes.size();
  if (cut)
    carried = std::min(carried, static_cast<std::size_t>((Clock::now() - begin) / byte_time));
  for (std::size_t i = 0; i < carried; i++)
    to_firmware(bytes[i], begin + byte_time * (i + 1));
  wire_free_ = begin + byte_time * carried;
  if (!cut) {
    const Urb whole = writes_.front();
    writes_.pop_front();
    nodes_.back().done(whole, 0, bytes.size());
  }
  feed_reads();
  changed_.notify_all();
}

void
EmulatedBoard::to_firmware(std::uint8_t byte, Clock::time_point time)
{
  received_.push_back({ time, byte });
  if (!firmware_)
    return;
  if (Bytes answer = firmware_->receive(byte, time); !answer.empty())
    say(std::move(answer));
}

} // namespace usb_test
