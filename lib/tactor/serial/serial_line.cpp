// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/serial_line.h"

#include <algorithm>

namespace tactor {

namespace {

constexpr int kSmallestPacket = 8;
constexpr int kLargestPacket = 512;

} // namespace

bool
is_one_of(const libusb_device_descriptor &device, std::span<const UsbId> ids)
{
  return std::any_of(ids.begin(), ids.end(), [&](const UsbId &id) {
    return id.vendor == device.idVendor && (id.product == 0 || id.product == device.idProduct);
  });
}

std::optional<SerialLine>
bulk_line(const libusb_interface_descriptor &interface)
{
  if (!interface.endpoint) // libusb could not parse them
    return std::nullopt;
  SerialLine line;
  for (int i = 0; i < interface.bNumEndpoints; i++) {
    const libusb_endpoint_descriptor &endpoint = interface.endpoint[i];
    const int packet = endpoint.wMaxPacketSize;
    if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK
        || packet < kSmallestPacket || packet > kLargestPacket)
      continue;
    if ((endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_OUT) {
      if (line.out_endpoint == 0)
        line.out_endpoint = endpoint.bEndpointAddress;
    } else if (line.in_endpoint == 0) {
      line.in_endpoint = endpoint.bEndpointAddress;
      line.in_packet = packet;
    }
  }
  if (line.in_endpoint == 0 || line.out_endpoint == 0)
    return std::nullopt;
  line.interfaces = { interface.bInterfaceNumber };
  return line;
}

std::vector<const libusb_interface_descriptor *>
first_settings(const libusb_config_descriptor &config)
{
  std::vector<const libusb_interface_descriptor *> settings;
  for (int i = 0; i < config.bNumInterfaces; i++)
    if (config.interface[i].num_altsetting > 0)
      settings.push_back(&config.interface[i].altsetting[0]);
  return settings;
}

std::optional<SerialLine>
first_line(const libusb_device_descriptor &device, const libusb_config_descriptor &config,
           std::span<const UsbId> ids)
{
  if (!is_one_of(device, ids))
    return std::nullopt;
  const std::vector<const libusb_interface_descriptor *> interfaces = first_settings(config);
  return interfaces.empty() ? std::nullopt : bulk_line(*interfaces.front());
}

} // namespace tactor
