// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/enumeration.h"

#include "tactor/serial/cdc_acm.h"
#include "tactor/serial/ch340.h"
#include "tactor/serial/ftdi.h"
#include "tactor/serial/legible.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>

namespace tactor {

namespace {

constexpr std::size_t kMostPorts = 7;     // USB 3.2, 8.9: tiers of hubs
constexpr std::size_t kLongestText = 378; // 126 × 3 bytes in UTF-8 of the longest string descriptor

using Place = std::pair<std::uint8_t, std::vector<std::uint8_t>>; ///< bus and ports

Place
place(libusb_device *device)
{
  std::array<std::uint8_t, kMostPorts> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  return { libusb_get_bus_number(device), { ports.begin(), ports.begin() + std::max(count, 0) } };
}

/// The kernel's name, "1-2.3".
std::string
bus_path(const Place &place)
{
  std::string path = std::to_string(place.first);
  char separator = '-';
  for (const std::uint8_t port : place.second) {
    path += separator + std::to_string(port);
    separator = '.';
  }
  return path;
}

std::string
attribute(const std::string &bus_path, const char *name)
{
  std::ifstream file("/sys/bus/usb/devices/" + bus_path + "/" + name);
  std::array<char, kLongestText> text{};
  file.read(text.data(), text.size());
  return legible({ text.data(), static_cast<std::size_t>(file.gcount()) });
}

/// Manufacturer and product; the ids of a device that reports neither.
std::string
name(const std::string &bus_path, const libusb_device_descriptor &descriptor)
{
  const std::string manufacturer = attribute(bus_path, "manufacturer");
  const std::string product = attribute(bus_path, "product");
  if (!manufacturer.empty() || !product.empty())
    return manufacturer + (manufacturer.empty() || product.empty() ? "" : " ") + product;
  std::array<char, 32> ids{};
  std::snprintf(ids.data(), ids.size(), "USB device %04x:%04x", descriptor.idVendor,
                descriptor.idProduct);
  return ids.data();
}

tl::unexpected<DriverError>
failure(const char *what, int error)
{
  return tl::unexpected(
      DriverError{ DriverError::Kind::failed,
                   what + std::string(libusb_strerror(static_cast<libusb_error>(error))) });
}

std::optional<SerialLine>
serial_line(libusb_device *device, const libusb_device_descriptor &descriptor)
{
  libusb_config_descriptor *config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != LIBUSB_SUCCESS)
    return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> owner(
      config, libusb_free_config_descriptor);
  for (const auto transport : { ftdi_line, ch340_line, cdc_acm_line })
    if (std::optional<SerialLine> line = transport(descriptor, *config))
      return line;
  return std::nullopt;
}

} // namespace

tl::expected<UsbContext, DriverError>
UsbContext::create()
{
  libusb_context *context = nullptr;
  if (const int error = libusb_init(&context); error != LIBUSB_SUCCESS)
    return failure("USB cannot be used: ", error);
  return UsbContext(context);
}

tl::expected<std::vector<UsbSerialDevice>, DriverError>
find_serial_devices(const UsbContext &context)
{
  libusb_device **all = nullptr;
  const ssize_t count = libusb_get_device_list(context.get(), &all);
  if (count < 0)
    return failure("USB devices cannot be listed: ", static_cast<int>(count));
  std::vector<std::unique_ptr<libusb_device, DeviceUnref>> devices(all, all + count);
  libusb_free_device_list(all, 0);

  std::stable_sort(devices.begin(), devices.end(),
                   [](const auto &a, const auto &b) { return place(a.get()) < place(b.get()); });
  std::vector<UsbSerialDevice> found;
  for (auto &device : devices) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device.get(), &descriptor) != LIBUSB_SUCCESS)
      continue;
    std::optional<SerialLine> line = serial_line(device.get(), descriptor);
    if (!line)
      continue;
    const std::string path = bus_path(place(device.get()));
    SerialDevice described{ .serial = attribute(path, "serial"),
                            .bus_path = path,
                            .name = name(path, descriptor),
                            .vendor = descriptor.idVendor,
                            .product = descriptor.idProduct,
                            .transport = std::string(line->transport) };
    const std::uint8_t address = libusb_get_device_address(device.get());
    found.push_back({ std::move(device), std::move(described), *std::move(line), address });
  }
  return found;
}

} // namespace tactor
