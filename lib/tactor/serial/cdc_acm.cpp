// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/cdc_acm.h"

namespace tactor {

namespace {

constexpr std::uint8_t kAbstractControlModel = 0x02;
constexpr std::uint8_t kToInterface = 0x21; // host to device, class, interface
constexpr std::uint8_t kSetLineCoding = 0x20;
constexpr std::uint8_t kSetControlLineState = 0x22;

} // namespace

std::optional<SerialLine>
cdc_acm_line(const libusb_device_descriptor &device, const libusb_config_descriptor &config)
{
  if (!is_one_of(device, kCdcAcmDevices))
    return std::nullopt;
  const libusb_interface_descriptor *control = nullptr;
  for (const libusb_interface_descriptor *interface : first_settings(config)) {
    if (!control && interface->bInterfaceClass == LIBUSB_CLASS_COMM
        && interface->bInterfaceSubClass == kAbstractControlModel)
      control = interface;
    if (!control || interface->bInterfaceClass != LIBUSB_CLASS_DATA)
      continue;
    if (std::optional<SerialLine> line = bulk_line(*interface)) {
      const std::uint16_t index = control->bInterfaceNumber;
      line->transport = "cdc-acm";
      // The data interface is released first: the kernel's driver binds both when the control
      // interface is released.
      line->interfaces = { control->bInterfaceNumber, interface->bInterfaceNumber };
      line->set_up = {
        // PSTN 1.2, table 17: baud rate in 32 bits, 1 stop bit, no parity, 8 bits.
        { kToInterface, kSetLineCoding, 0, index, { 0x00, 0xe1, 0x00, 0x00, 0x00, 0x00, 0x08 } },
      };
      line->ready = { { kToInterface, kSetControlLineState, 0x0003, index } };
      if (is_one_of(device, kDtrResets))
        line->hang_up = { { kToInterface, kSetControlLineState, 0x0000, index } };
      return line;
    }
  }
  return std::nullopt;
}

} // namespace tactor
