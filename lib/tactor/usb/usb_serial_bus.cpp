// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/usb/usb_serial_bus.h"

#include "tactor/driver.h"
#include "tactor/usb/enumeration.h"
#include "tactor/usb/usb_serial_port.h"

#include <atomic>
#include <sys/time.h>
#include <thread>
#include <utility>

namespace tactor {

/// Looks again after every event from udevd, and now and then where none runs.
class UsbSerialBus::Watch
{
public:
  Watch(std::function<void()> changed, std::chrono::milliseconds look)
      : changed_(std::move(changed)), look_(look)
  {
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG))
      libusb_hotplug_register_callback(
          context_.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
          LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
          [](libusb_context *, libusb_device *, libusb_hotplug_event, void *) {
            return 0; // the thread is awake, which is enough
          },
          nullptr, nullptr);
    seen_ = look_now();
    thread_ = std::thread(&Watch::run, this);
  }

  ~Watch()
  {
    stop_ = true;
    libusb_interrupt_event_handler(context_.get());
    thread_.join();
  }

private:
  /// With its address: a board that comes back to the same place is another one.
  using Seen = std::vector<std::pair<SerialDevice, std::uint8_t>>;

  static Seen look_now()
  {
    const UsbContext context;
    Seen seen;
    for (UsbSerialDevice &found : find_serial_devices(context))
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
      try {
        if (Seen now = look_now(); now != seen_) {
          seen_ = std::move(now);
          changed_();
        }
      } catch (const DriverError &) {
        // Not now; there is another look.
      }
    }
  }

  UsbContext context_;
  const std::function<void()> changed_;
  const std::chrono::milliseconds look_;
  Seen seen_;
  std::atomic<bool> stop_{ false };
  std::thread thread_;
};

UsbSerialBus::UsbSerialBus(UsbPatience patience) : patience_(patience)
{
}

UsbSerialBus::~UsbSerialBus() = default;

std::vector<SerialDevice>
UsbSerialBus::list()
{
  const UsbContext context;
  std::vector<SerialDevice> devices;
  for (UsbSerialDevice &found : find_serial_devices(context))
    devices.push_back(std::move(found.device));
  return devices;
}

std::unique_ptr<SerialPort>
UsbSerialBus::open(const SerialDevice &device, SerialPort::Events events)
{
  return std::make_unique<UsbSerialPort>(device, std::move(events), patience_);
}

void
UsbSerialBus::watch(std::function<void()> changed)
{
  watch_.reset();
  if (changed)
    watch_ = std::make_unique<Watch>(std::move(changed), patience_.look);
}

} // namespace tactor
