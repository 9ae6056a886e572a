// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes USB descriptors as libusb parses them, which checks only lengths: a line has bulk
// endpoints of legal size, and a printed name is printable. Input: two bytes each of vendor and
// product, then per interface class, subclass, number of endpoints (0xff: libusb could not parse
// them), and four bytes per endpoint. The rest is the name.
#include "fuzz.h"
#include "tactor/serial/cdc_acm.h"
#include "tactor/serial/ch340.h"
#include "tactor/serial/ftdi.h"
#include "tactor/serial/legible.h"

#include <glib.h>

#include <array>
#include <span>
#include <vector>

using namespace tactor;

namespace {

constexpr std::size_t kMostInterfaces = 8;
constexpr std::uint8_t kNoEndpoints = 0xff;

/// Reads bytes. Zeros after the end.
class Bytes
{
public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes)
  {
  }

  std::uint8_t take()
  {
    if (left_.empty())
      return 0;
    const std::uint8_t byte = left_.front();
    left_ = left_.subspan(1);
    return byte;
  }

  std::uint16_t take_two()
  {
    const unsigned low = take();
    return static_cast<std::uint16_t>(low | unsigned{ take() } << 8);
  }

  std::string_view left() const
  {
    return { reinterpret_cast<const char *>(left_.data()), left_.size() };
  }

private:
  std::span<const std::uint8_t> left_;
};

struct Interface
{
  libusb_interface_descriptor setting{};
  std::vector<libusb_endpoint_descriptor> endpoints{};
};

void
fill(Interface &interface, Bytes &bytes, std::size_t number)
{
  interface.setting.bInterfaceNumber = static_cast<std::uint8_t>(number);
  interface.setting.bInterfaceClass = bytes.take();
  interface.setting.bInterfaceSubClass = bytes.take();
  const std::uint8_t count = bytes.take();
  interface.setting.bNumEndpoints = count % 32;
  if (count == kNoEndpoints)
    return;
  interface.endpoints.resize(interface.setting.bNumEndpoints);
  for (libusb_endpoint_descriptor &endpoint : interface.endpoints) {
    endpoint.bEndpointAddress = bytes.take();
    endpoint.bmAttributes = bytes.take();
    endpoint.wMaxPacketSize = bytes.take_two();
  }
  interface.setting.endpoint = interface.endpoints.data();
}

void
check_line(const SerialLine &line)
{
  expect(!line.transport.empty() && !line.interfaces.empty());
  expect((line.in_endpoint & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN);
  expect(line.out_endpoint != 0
         && (line.out_endpoint & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_OUT);
  expect(line.in_packet > line.status_bytes && line.in_packet >= 8 && line.in_packet <= 512);
  expect(!line.set_up.empty() && line.set_up.size() <= 6);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  Bytes bytes({ data, size });
  libusb_device_descriptor device{};
  device.idVendor = bytes.take_two();
  device.idProduct = bytes.take_two();
  std::array<Interface, kMostInterfaces> interfaces;
  std::array<libusb_interface, kMostInterfaces> listed{};
  const std::size_t count = bytes.take() % (kMostInterfaces + 1);
  for (std::size_t i = 0; i < count; i++) {
    fill(interfaces[i], bytes, i);
    listed[i] = { .altsetting = &interfaces[i].setting, .num_altsetting = bytes.take() % 2 };
  }
  libusb_config_descriptor config{};
  config.bNumInterfaces = static_cast<std::uint8_t>(count);
  config.interface = listed.data();
  for (const auto transport : { ftdi_line, ch340_line, cdc_acm_line })
    if (const std::optional<SerialLine> line = transport(device, config))
      check_line(*line);

  const std::string name = legible(bytes.left());
  expect(g_utf8_validate(name.data(), static_cast<gssize>(name.size()), nullptr));
  expect(g_utf8_strlen(name.data(), static_cast<gssize>(name.size())) <= 126);
  expect(legible(name) == name);
  return 0;
}
