// SPDX-License-Identifier: LGPL-2.1-or-later
#include "emulated_board.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace usb_test {

namespace {

constexpr int kBitsPerByte = 10; // 8N1
/// From when the kernel's driver has a board back to when its line is switched off, as measured of cdc_acm.
constexpr auto kKernelOpens = std::chrono::microseconds(1340);
constexpr std::array<std::uint8_t, 2> kStatus{ 0x01,
                                               0x60 }; // FT232R: nothing to tell; sender empty
constexpr std::size_t kLongestRead = 512;              // of the host's transfers

std::string
hex(std::span<const std::uint8_t> bytes)
{
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    text += digits;
  }
  return text;
}

std::string
hex(const std::string &text)
{
  return hex(std::span(reinterpret_cast<const std::uint8_t *>(text.data()), text.size()));
}

Bytes
from_hex(std::string_view text)
{
  Bytes bytes;
  std::string digits;
  for (const char c : text) {
    if (c != ' ')
      digits += c;
    if (digits.size() == 2)
      bytes.push_back(std::stoi(std::exchange(digits, {}), nullptr, 16));
  }
  return bytes;
}

std::string
format(const char *pattern, auto... values)
{
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

} // namespace

Bytes
EmulatedBoard::descriptors(Transport transport, std::optional<std::uint16_t> own_vendor)
{
  struct Model
  {
    unsigned vendor, product, device_class, interfaces;
    std::string body; ///< what follows the configuration's header
  };
  const Model models[] = {
    // Mega 2560 R3: the abstract control model with its functional descriptors, then data.
    { 0x2341, 0x0042, 0x02, 2,
      "090400000102020100 0524001001 04240206 0524060001 070582030800ff"
      "09040100020a000000 07050402400001 07058302400001" },
    { 0x0403, 0x6001, 0x00, 1, "0904000002ffffff02 07058102400000 07050202400000" },
    { 0x1a86, 0x7523, 0xff, 1, "0904000003ff010200 07058202200000 07050202200000 07058103080001" },
  };
  const Model &model = models[static_cast<int>(transport)];
  const unsigned vendor = own_vendor.value_or(model.vendor);
  const auto length = static_cast<unsigned>(9 + from_hex(model.body).size());
  return from_hex(
      format("12010002%02x000008 %02x%02x %02x%02x 0001 010203 01", model.device_class,
             vendor & 0xff, vendor >> 8, model.product & 0xff, model.product >> 8)
      + format("0902 %02x%02x %02x 01 00 80 32", length & 0xff, length >> 8, model.interfaces)
      + model.body);
}

EmulatedBoard::EmulatedBoard(EmulatedUsb &usb, BoardDescription description,
                             std::shared_ptr<Firmware> firmware)
    : usb_(usb), description_(std::move(description)), firmware_(std::move(firmware)),
      packet_(description_.transport == Transport::ch340 ? 32 : 64),
      status_bytes_(description_.transport == Transport::ftdi ? 2 : 0),
      payload_(packet_ - status_bytes_), wire_(&EmulatedBoard::run_wire, this)
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
  nodes_.clear(); // they call
}

void
EmulatedBoard::plug()
{
  const std::lock_guard lock(mutex_);
  const int bus = std::atoi(description_.port.c_str());
  const int address = usb_.next_address();
  const std::string node = format("/dev/bus/usb/%03d/%03d", bus, address);
  syspath_ = format("/devices/usb%d/%s", bus, description_.port.c_str());
  // Before the device is announced.
  UsbfsNode::Device &self = *this;
  nodes_.emplace_back(usb_, node, mutex_, self);

  plugged_ = true;
  dtr_ = false;
  const Bytes descriptors
      = description_.descriptors.empty()
            ? EmulatedBoard::descriptors(description_.transport, description_.vendor)
            : description_.descriptors;
  const std::string device
      = "P: " + syspath_ + "\n"
        + format("E: DEVNAME=%s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=%03d\nE: "
                 "DEVNUM=%03d\n",
                 node.c_str(), bus, address)
        + format("A: busnum=%d\\n\nA: devnum=%d\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n",
                 bus, address)
        + "H: serial=" + hex(description_.serial + "\n")
        + "\nH: product=" + hex(description_.product + "\n") + "\nH: manufacturer="
        + hex(description_.manufacturer + "\n") + "\nH: descriptors=" + hex(descriptors) + "\n";
  GError *error = nullptr;
  if (!umockdev_testbed_add_from_string(usb_.testbed(), device.c_str(), &error))
    throw std::runtime_error(error->message);
  bind(0, true);
}

/// As in sysfs: an interface has a driver, or it has none.
void
EmulatedBoard::bind(int interface, bool has_driver)
{
  namespace fs = std::filesystem;
  const std::string name = format("%s:1.%d", description_.port.c_str(), interface);
  const fs::path folder = usb_.path("/sys" + syspath_ + "/" + name);
  fs::create_directories(folder);
  fs::remove(folder / "driver");
  if (has_driver)
    fs::create_directory_symlink("/sys/bus/usb/drivers/serial", folder / "driver");
  const fs::path link = usb_.path("/sys/bus/usb/devices/" + name);
  fs::remove(link);
  fs::create_directory_symlink(folder, link);
}

void
EmulatedBoard::unplug()
{
  const std::lock_guard lock(mutex_);
  if (!plugged_)
    return;
  plugged_ = false;
  // The event needs the properties in sysfs.
  umockdev_testbed_uevent(usb_.testbed(), ("/sys" + syspath_).c_str(), "remove");
  umockdev_testbed_remove_device(usb_.testbed(), ("/sys" + syspath_).c_str());
  for (std::list<Urb> *pending : { &reads_, &writes_, &requests_ })
    for (; !pending->empty(); pending->pop_front())
      nodes_.back().done(pending->front(), -ESHUTDOWN, 0);
  nodes_.back().unplug();
  for_host_.clear();
  in_chip_.clear(); // no power
  changed_.notify_all();
}

// ---- what came

std::vector<EmulatedBoard::Received>
EmulatedBoard::received() const
{
  const std::lock_guard lock(mutex_);
  return received_;
}

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

std::vector<std::string>
EmulatedBoard::conversation() const
{
  const std::lock_guard lock(mutex_);
  return conversation_;
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

std::size_t
EmulatedBoard::hosts() const
{
  return hosts_.size();
}

int
EmulatedBoard::most_writes_pending() const
{
  const std::lock_guard lock(mutex_);
  return most_writes_pending_;
}

std::size_t
EmulatedBoard::cut_off() const
{
  const std::lock_guard lock(mutex_);
  return cut_off_;
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
  for (const std::uint8_t byte : urb.bytes().first(taken))
    to_firmware(byte, Clock::now());
  nodes_.back().done(urb, -failure_, taken);
}

void
EmulatedBoard::ignore_requests(bool on)
{
  const std::lock_guard lock(mutex_);
  ignore_requests_ = on;
}

void
EmulatedBoard::refuse_requests(bool on)
{
  const std::lock_guard lock(mutex_);
  refuse_requests_ = on;
}

void
EmulatedBoard::use_by_another(bool on)
{
  const std::lock_guard lock(mutex_);
  busy_ = on;
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
  queue_for_host(bytes);
  feed_reads();
}

void
EmulatedBoard::send_packet(const Bytes &packet)
{
  const std::lock_guard lock(mutex_);
  for_host_.push_back(packet);
  feed_reads();
}

void
EmulatedBoard::fill_packets(std::size_t payload)
{
  const std::lock_guard lock(mutex_);
  payload_ = payload;
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
    queue_for_host(reply);
}

/// Cuts into what one transfer of the host can take: whole packets, the last one of any length.
void
EmulatedBoard::queue_for_host(std::span<const std::uint8_t> bytes)
{
  do {
    Bytes transfer;
    for (bool full = true; full && transfer.size() + packet_ <= kLongestRead;) {
      const std::size_t payload = std::min(bytes.size(), payload_);
      if (payload == 0 && !transfer.empty())
        break;
      if (status_bytes_ > 0)
        transfer.insert(transfer.end(), kStatus.begin(), kStatus.end());
      transfer.insert(transfer.end(), bytes.begin(), bytes.begin() + payload);
      bytes = bytes.subspan(payload);
      full = payload == packet_ - status_bytes_;
    }
    for_host_.push_back(std::move(transfer));
  } while (!bytes.empty());
}

void
EmulatedBoard::feed_reads()
{
  while (!reads_.empty() && !for_host_.empty()) {
    const Bytes bytes = std::move(for_host_.front());
    for_host_.pop_front();
    const Urb urb = reads_.front();
    reads_.pop_front();
    const std::size_t size = std::min(bytes.size(), urb.bytes().size());
    std::copy_n(bytes.begin(), size, urb.bytes().begin());
    nodes_.back().done(urb, size < bytes.size() ? -EOVERFLOW : 0, size);
  }
}

// ---- what the host does

bool
EmulatedBoard::claim(const void *host, int interface)
{
  if (busy_)
    return false;
  hosts_.insert(host);
  bind(interface, false);
  conversation_.push_back(format("claim %d", interface));
  return true;
}

void
EmulatedBoard::release(int interface)
{
  conversation_.push_back(format("release %d", interface));
}

/// The kernel's driver takes it, sets 9600 baud 1.34 ms later (cdc_acm; ch341 1.8), and the chip switches its serial line off and on: what it
/// has not let out by then arrives garbled, here not at all.
void
EmulatedBoard::give_back(int interface)
{
  conversation_.push_back(format("return %d", interface));
  bind(interface, true);
  const Clock::time_point off = Clock::now() + kKernelOpens;
  cut_off_ += std::erase_if(in_chip_, [off](const Received &one) { return one.time > off; });
}

void
EmulatedBoard::submit(const Urb &urb)
{
  if (urb.is_control()) {
    control(urb);
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
EmulatedBoard::changed()
{
  changed_.notify_all();
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
  // The board is reset when DTR rises.
  const bool dtr = request.starts_with("21 22 0003") || request.starts_with("40 01 0101")
                   || request.starts_with("40 a4 ff9f");
  if (dtr && !dtr_ && firmware_) {
    say(firmware_->reset());
    feed_reads();
  }
  dtr_ = dtr_ || dtr;
}

// ---- the wire to the firmware

void
EmulatedBoard::run_wire()
{
  std::unique_lock lock(mutex_);
  while (!stop_) {
    let_out();
    std::optional<Clock::time_point> next = firmware_ ? firmware_->next() : std::nullopt;
    if (!in_chip_.empty())
      next = std::min(next.value_or(in_chip_.front().time), in_chip_.front().time);
    if (take_into_chip()) {
      changed_.notify_all();
    } else if (description_.chip == 0 && !stalled_ && !writes_.empty()) {
      carry(lock);
    } else if (!next) {
      changed_.wait(lock);
    } else if (Clock::now() < *next) {
      changed_.wait_until(lock, *next);
    } else if (in_chip_.empty() || *next < in_chip_.front().time) {
      firmware_->pass(*next);
      changed_.notify_all();
    }
  }
}

/// The next transfer, if there is one and room for it.
bool
EmulatedBoard::take_into_chip()
{
  if (stalled_ || writes_.empty()
      || in_chip_.size() + writes_.front().bytes().size() > description_.chip)
    return false;
  const auto byte_time = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(kBitsPerByte / description_.baud));
  wire_free_ = std::max(Clock::now(), wire_free_);
  for (const std::uint8_t byte : writes_.front().bytes())
    in_chip_.push_back({ wire_free_ += byte_time, byte });
  const Urb whole = writes_.front();
  writes_.pop_front();
  nodes_.back().done(whole, 0, whole.bytes().size());
  return true;
}

/// What has left the chip by now.
void
EmulatedBoard::let_out()
{
  for (; !in_chip_.empty() && in_chip_.front().time <= Clock::now(); in_chip_.pop_front()) {
    to_firmware(in_chip_.front().byte, in_chip_.front().time);
    feed_reads();
    changed_.notify_all();
  }
}

/// One transfer: its bytes one after another at the wire's rate. A transfer is done when its last byte has left.
void
EmulatedBoard::carry(std::unique_lock<std::mutex> &lock)
{
  const UMockdevIoctlData *const urb = writes_.front().urb;
  const Bytes bytes(writes_.front().bytes().begin(), writes_.front().bytes().end());
  const auto byte_time = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
      description_.baud > 0 ? kBitsPerByte / description_.baud : 0.0));
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
