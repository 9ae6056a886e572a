// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Devices that are not known to be tactor boards, such as a 3D printer that prints from its card:
// what reaches them over USB. An emulated board records every claim, control request and byte.
#include "support/boards/emulated_board.h"

#include "tactor/drivers/auto_driver.h"
#include "tactor/drivers/firmata_driver.h"
#include "tactor/serial/usb_serial_bus.h"
#include "tactor/simulator.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "support/check_tests.h"
#include "support/contains.h"
#include "support/unwrap.h"

using namespace std::chrono_literals;
using namespace usb_test;
using tactor::DriverConfig;
using tactor::DriverError;
using tactor::FirmataDriver;

namespace {

/// A driver that gives up soon where it must.
std::unique_ptr<FirmataDriver>
make_firmata(tactor::Time answer = 1h)
{
  return std::make_unique<FirmataDriver>(
      FirmataDriver::Firmware::any, [] { return std::make_unique<tactor::UsbSerialBus>(); },
      FirmataDriver::Settings{ .patience = { .answer = answer, .ask_again = 2ms } });
}

std::unique_ptr<tactor::AutoDriver>
make_auto(tactor::Time answer = 1h)
{
  return std::make_unique<tactor::AutoDriver>(make_firmata(answer),
                                              std::make_unique<tactor::Simulator>());
}

/// Whether nothing at all reached it.
bool
is_untouched(const EmulatedBoard &board)
{
  return board.conversation().empty() && board.bytes().empty();
}

bool
was_given_dtr(const EmulatedBoard &board)
{
  return std::ranges::any_of(board.conversation(), [](const std::string &request) {
    return request.starts_with("21 22") || request.starts_with("40 01")
           || request.starts_with("40 a4");
  });
}

/// Vendors of boards with the communications class.
constexpr std::uint16_t kVendors[]
    = { 0x2341, 0x2a03, 0x16c0, 0x2e8a, 0x239a, 0x1b4f, 0x2886, 0x303a, 0x1209, 0x1a86 };

} // namespace

/// Of no vendor, at no play.
CHECK_TEST(test_auto_touches_none)
{
  std::vector<BoardDescription> strangers{ { .transport = Transport::ftdi },
                                           { .transport = Transport::ch340 } };
  for (const std::uint16_t vendor : kVendors)
    strangers.push_back({ .vendor = vendor });
  for (BoardDescription &description : strangers) {
    description.is_known = false;
    EmulatedUsb usb;
    EmulatedBoard printer(usb, description);
    for (int play = 0; play < 2; play++) {
      std::string told;
      const auto driver = make_auto(20ms);
      unwrap(driver->open({ .notify = [&](const tactor::DriverEvent &event) {
        told = event.text;
      } }));
      fail_unless(driver->status().board == "simulator");
      assert_contains(told, { "simulated", "not probed", "Mega 2560", "--device=1-1" });
    }
    fail_unless(is_untouched(printer), "%04x", description.vendor.value_or(0));
  }
}

/// A chair that has answered before is felt, and the stranger before it in the list never asked.
CHECK_TEST(test_a_chair_beside_it)
{
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard printer(usb, { .port = "1-1", .serial = "P", .is_known = false });
    EmulatedBoard chair(usb, { .transport = transport, .port = "1-2" },
                        std::make_shared<Firmware>());
    for (const bool is_auto : { true, false }) {
      const std::unique_ptr<tactor::Driver> driver
          = is_auto ? std::unique_ptr<tactor::Driver>(make_auto()) : make_firmata();
      unwrap(driver->open({}));
      fail_unless(driver->status().firmware == "StandardFirmata.ino 2.5");
    }
    fail_unless(is_untouched(printer));
  }
}

/// driver=firmata says that there is a board: the only device is asked, without DTR and RTS, and
/// not again if it is none.
CHECK_TEST(test_the_only_stranger)
{
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard printer(usb, { .transport = transport, .is_known = false });
    const DriverError error = refusal_of(make_firmata(20ms)->open({}));
    assert_contains(error.text, { "does not answer", "device=1-1" });
    fail_if(is_untouched(printer));
    fail_if(was_given_dtr(printer));
    const std::size_t before = printer.conversation().size();
    assert_contains(refusal_of(make_firmata()->open({})).text, { "not probed", "--device=1-1" });
    fail_unless(printer.conversation().size() == before);
    // Named, it is asked as a board.
    assert_contains(refusal_of(make_firmata(20ms)->open({ .device = "1-1" })).text,
                    { "does not answer" });
    fail_unless(was_given_dtr(printer));
  }
}

/// A board that answers is known from then on, and then it is reset, too.
CHECK_TEST(test_a_stranger_that_answers)
{
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard board(usb, { .transport = transport, .is_known = false },
                        std::make_shared<Firmware>());
    unwrap(make_firmata()->open({}));
    fail_if(was_given_dtr(board));
    unwrap(make_auto()->open({}));
    fail_unless(was_given_dtr(board));
  }
}

/// A device that tells nothing of itself is named by its place and ids.
CHECK_TEST(test_no_strings)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, { .serial = "", .manufacturer = "", .product = "", .is_known = false });
  tactor::UsbSerialBus bus;
  fail_unless(unwrap(bus.list()).at(0).name == "USB device 2341:0042");
  DriverConfig config;
  config.asks_a_stranger = false;
  assert_contains(refusal_of(make_firmata()->open(config)).text,
                  { "USB device 2341:0042 (at 1-1)", "--device=1-1" });
  board.use_by_another(true);
  assert_contains(refusal_of(make_firmata()->open({ .device = "1-1" })).text,
                  { "USB device 2341:0042 at USB 1-1 is in use" });
}

CHECK_MAIN_AFTER(strangers, -1, begin_emulation())
