// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/usb_serial_bus.h"

#include "tactor/serial/enumeration.h"
#include "tactor/serial/tty_use.h"
#include "tactor/serial/usb_serial_port.h"
#include "tactor/thread.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <sys/time.h>
#include <thread>
#include <utility>

namespace tactor {

namespace {

/// The interface that has the kernel's line; none if the device is gone.
std::optional<int>
first_interface(const SerialDevice &device)
{
  const tl::expected<UsbContext, DriverError> context = UsbContext::create();
  if (!context)
    return std::nullopt;
  const tl::expected<std::vector<UsbSerialDevice>, DriverError> all = find_serial_devices(*context);
  if (!all)
    return std::nullopt;
  const auto found = std::ranges::find(*all, device, &UsbSerialDevice::device);
  return found == all->end() ? std::nullopt : std::optional(found->line.interfaces.front());
}

} // namespace

/// Lists devices after each event from udevd, and at intervals in case none runs.
class UsbSerialBus::Watch
{
public:
  static tl::expected<std::unique_ptr<Watch>, DriverError> create(std::function<void()> changed,
                                                                  std::chrono::milliseconds look)
  {
    tl::expected<UsbContext, DriverError> context = UsbContext::create();
    if (!context)
      return tl::unexpected(context.error());
    auto watch = std::make_unique<Watch>(std::move(*context), std::move(changed), look);
    tl::expected<Seen, DriverError> seen = look_now();
    if (!seen)
      return tl::unexpected(seen.error());
    watch->seen_ = std::move(*seen);
    tl::expected<Thread, DriverError> thread
        = Thread::start([looking = watch.get()] { looking->run(); });
    if (!thread)
      return tl::unexpected(thread.error());
    watch->thread_ = std::move(*thread);
    return watch;
  }

  /// For create().
  Watch(UsbContext context, std::function<void()> changed, std::chrono::milliseconds look)
      : context_(std::move(context)), changed_(std::move(changed)), look_(look)
  {
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG))
      libusb_hotplug_register_callback(
          context_.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
          LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
          [](libusb_context *, libusb_device *, libusb_hotplug_event, void *) {
            return 0; // it has woken the thread
          },
          nullptr, nullptr);
  }

  ~Watch()
  {
    if (!thread_)
      return;
    stop_ = true;
    libusb_interrupt_event_handler(context_.get());
    thread_.join();
  }

private:
  /// With the address, which differs if a board comes back to the same place.
  using Seen = std::vector<std::pair<SerialDevice, std::uint8_t>>;

  static tl::expected<Seen, DriverError> look_now()
  {
    const tl::expected<UsbContext, DriverError> context = UsbContext::create();
    if (!context)
      return tl::unexpected(context.error());
    tl::expected<std::vector<UsbSerialDevice>, DriverError> devices = find_serial_devices(*context);
    if (!devices)
      return tl::unexpected(devices.error());
    Seen seen;
    for (UsbSerialDevice &found : *devices)
      seen.emplace_back(std::move(found.device), found.address);
    return seen;
  }

  void run()
  {
    while (!stop_) {
      timeval wait{ .tv_sec = look_.count() / 1000, .tv_usec = look_.count() % 1000 * 1000 };
      if (libusb_handle_events_timeout_completed(context_.get(), &wait, nullptr) != LIBUSB_SUCCESS)
        std::this_thread::sleep_for(look_);
      if (stop_)
        return;
      // After an error it looks again.
      if (tl::expected<Seen, DriverError> now = look_now(); now && *now != seen_) {
        seen_ = std::move(*now);
        changed_();
      }
    }
  }

  UsbContext context_;
  const std::function<void()> changed_;
  const std::chrono::milliseconds look_;
  Seen seen_;
  std::atomic<bool> stop_{ false };
  Thread thread_;
};

UsbSerialBus::UsbSerialBus(UsbPatience patience, SystemRoots roots)
    : patience_(patience), roots_(std::move(roots))
{
}

UsbSerialBus::~UsbSerialBus() = default;

tl::expected<std::vector<SerialDevice>, DriverError>
UsbSerialBus::list()
{
  const tl::expected<UsbContext, DriverError> context = UsbContext::create();
  if (!context)
    return tl::unexpected(context.error());
  tl::expected<std::vector<UsbSerialDevice>, DriverError> found = find_serial_devices(*context);
  if (!found)
    return tl::unexpected(found.error());
  std::vector<SerialDevice> devices;
  for (UsbSerialDevice &each : *found)
    devices.push_back(std::move(each.device));
  return devices;
}

tl::expected<std::unique_ptr<SerialPort>, DriverError>
UsbSerialBus::open(const SerialDevice &device, SerialPort::Events events, std::stop_token stop)
{
  return UsbSerialPort::open(device, std::move(events), patience_, stop);
}

tl::expected<void, DriverError>
UsbSerialBus::reset(const SerialDevice &device)
{
  const tl::expected<UsbContext, DriverError> context = UsbContext::create();
  if (!context)
    return tl::unexpected(context.error());
  return ClaimedDevice::open(*context, device, true, patience_.request, {})
      .and_then([&](const ClaimedDevice &claimed) {
        return claimed.pulse_dtr(*context, device, patience_.request);
      });
}

tl::expected<void, DriverError>
UsbSerialBus::watch(std::function<void()> changed)
{
  watch_.reset();
  if (!changed)
    return {};
  tl::expected<std::unique_ptr<Watch>, DriverError> watch
      = Watch::create(std::move(changed), patience_.look);
  if (!watch)
    return tl::unexpected(watch.error());
  watch_ = std::move(*watch);
  return {};
}

LineUse
UsbSerialBus::use(const SerialDevice &device)
{
  const std::optional<int> interface = first_interface(device);
  return interface ? tty_use(device.bus_path, *interface, roots_) : LineUse{};
}

bool
UsbSerialBus::is_left(const SerialDevice &device)
{
  const std::optional<int> interface = first_interface(device);
  return interface && has_no_driver(device.bus_path, *interface, roots_);
}

} // namespace tactor
