// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/board_description.h"

#include "support/boards/hex.h"

#include <array>
#include <string_view>
#include <utility>

namespace usb_test {

namespace {

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

} // namespace

Bytes
usb_descriptors(Transport transport, std::optional<std::uint16_t> own_vendor)
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

Bytes
usb_descriptors(const BoardDescription &description)
{
  return description.descriptors.empty()
             ? usb_descriptors(description.transport, description.vendor)
             : description.descriptors;
}

std::string
usb_node(int bus, int address)
{
  return format("/dev/bus/usb/%03d/%03d", bus, address);
}

std::string
umockdev_entry(const BoardDescription &description, const std::string &syspath, int bus,
               int address)
{
  const Bytes descriptors = usb_descriptors(description);
  return "P: " + syspath + "\n"
         + format("E: DEVNAME=%s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=%03d\nE: "
                  "DEVNUM=%03d\n",
                  usb_node(bus, address).c_str(), bus, address)
         + format("A: busnum=%d\\n\nA: devnum=%d\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n",
                  bus, address)
         + "H: serial=" + hex(description.serial + "\n")
         + "\nH: product=" + hex(description.product + "\n") + "\nH: manufacturer="
         + hex(description.manufacturer + "\n") + "\nH: descriptors=" + hex(descriptors) + "\n";
}

std::chrono::microseconds
kernel_opens(const BoardDescription &description)
{
  // Not measured for ftdi_sio: the shortest of the others.
  constexpr std::array measured{ 1340, 1340, 1800 };
  return description.kernel_opens.value_or(
      std::chrono::microseconds(measured[static_cast<std::size_t>(description.transport)]));
}

} // namespace usb_test
