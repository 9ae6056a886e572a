// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The Firmata driver over each transport, with replies that are lost or damaged.
#include "support/boards/emulated_board.h"

#include "tactor/drivers/firmata_driver.h"
#include "tactor/serial/usb_serial_bus.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "support/check_tests.h"
#include "support/unwrap.h"

using namespace std::chrono_literals;
using namespace usb_test;
using tactor::DriverError;
using tactor::FirmataDriver;

namespace {

/// A Mega and a driver with long timeouts that retries immediately.
struct UsbRig
{
  explicit UsbRig(Transport transport, tactor::Time answer = 1h)
      : board(usb, { .transport = transport }, firmware),
        driver(FirmataDriver::Firmware::any,
               [] { return std::make_unique<tactor::UsbSerialBus>(); },
               { .patience = { .answer = answer, .ask_again = 2ms } })
  {
  }

  /// Whether written levels reach the motors.
  bool obeys()
  {
    const std::vector<double> volts{ 3.0, 1.5, 0.75 };
    unwrap(driver.write(volts, 0s));
    return board.wait_until([&] {
      for (int i = 0; i < 3; i++)
        if (firmware->duty(2 + i) != std::lround(volts[static_cast<std::size_t>(i)] / 3.0 * 255))
          return false;
      return true;
    });
  }

  EmulatedUsb usb;
  std::shared_ptr<Firmware> firmware = std::make_shared<Firmware>();
  EmulatedBoard board;
  FirmataDriver driver;
};

const std::vector<int> kPins{ 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46 };

} // namespace

/// The first replies are lost, truncated or corrupted. The driver retries and identifies the board.
CHECK_TEST(test_garbled_replies)
{
  for (const Transport transport : kTransports)
    for (unsigned seed = 0; seed < 12; seed++) {
      UsbRig rig(transport);
      std::mt19937 random(seed);
      unsigned bad = 1 + seed % 5;
      unsigned said = 0;
      rig.board.garble([&](Bytes &reply) {
        said++;
        if (bad == 0 || reply.empty())
          return;
        bad--;
        switch (random() % 3) {
        case 0:
          reply.clear();
          break;
        case 1:
          reply.resize(random() % reply.size());
          break;
        default:
          // Not F7, which would complete the message.
          reply[1 + random() % (reply.size() - 1)]
              = static_cast<std::uint8_t>(0x80 + random() % 0x70);
        }
      });
      unwrap(rig.driver.open({}));
      fail_unless(rig.driver.status().pins == kPins);
      fail_unless(rig.driver.status().firmware == "StandardFirmata.ino 2.5");
      fail_unless(rig.obeys());
      rig.driver.close();
      fail_if(rig.firmware->any_motor_on());
      fail_unless_equals_int(bad, 0);
      fail_unless(said > 1 + seed % 5);
    }
}

/// A long reply in packets of one byte, which chips may send.
CHECK_TEST(test_replies_in_short_packets)
{
  for (const Transport transport : kTransports) {
    UsbRig rig(transport);
    rig.board.fill_packets(1);
    unwrap(rig.driver.open({}));
    fail_unless(rig.driver.status().pins == kPins);
    fail_unless(rig.obeys());
  }
}

/// No reply is ever complete. The error names the step, and the board is released.
CHECK_TEST(test_replies_always_cut_short)
{
  constexpr std::uint8_t kCapabilities = 0x6c;
  for (const Transport transport : kTransports)
    for (const bool knows_firmware : { false, true }) {
      // Where a machine is too slow to get to that step, the driver gets twice the time.
      bool gets_there = false;
      for (auto answer = 50ms; !gets_there; answer *= 2) {
        fail_unless(answer < 1min);
        UsbRig rig(transport, answer);
        int replies = 0; // the first two are banners: of the plug, and of the port that is opened
        rig.board.garble([&](Bytes &reply) {
          const bool tells_pins = reply.size() > 1 && reply[1] == kCapabilities;
          gets_there |= tells_pins || (!knows_firmware && ++replies > 2);
          if (!knows_firmware || tells_pins)
            reply.resize(reply.size() / 2);
        });
        const auto &[kind, why] = refusal_of(rig.driver.open({}));
        fail_unless(kind == DriverError::Kind::failed);
        fail_unless(rig.board.conversation().back() == "return 0");
        fail_if(rig.firmware->any_motor_on());
        const char *const step
            = knows_firmware ? "does not say what its pins can do" : "is not Firmata";
        // A reply may have left the board too late for the driver to hear it.
        gets_there &= why.find("it does not answer") == std::string::npos;
        if (gets_there)
          fail_unless(why.find(step) != std::string::npos, "%s", why.c_str());
      }
    }
}

/// Noise on an open line does not change the motors.
CHECK_TEST(test_noise_while_playing)
{
  for (const Transport transport : kTransports) {
    UsbRig rig(transport);
    unwrap(rig.driver.open({}));
    std::mt19937 random(9);
    for (int i = 0; i < 200; i++) {
      Bytes noise(random() % 100);
      for (std::uint8_t &byte : noise)
        byte = static_cast<std::uint8_t>(random());
      rig.board.send(noise);
    }
    fail_unless(rig.obeys());
    fail_unless(rig.driver.status().is_there);
  }
}

/// The zeros of four and nine motors take 2.3 and 4.9 ms on the line. The kernel's driver gets the
/// board back only after they arrived.
CHECK_TEST(test_motors_stand_when_released)
{
  for (const Transport transport : kTransports)
    for (const std::size_t motors : { std::size_t{ 4 }, std::size_t{ 9 } })
      for (const bool seat : { false, true })
        for (const bool is_heard : { true, false }) {
          EmulatedUsb usb;
          const auto firmware = std::make_shared<Firmware>(kMega, seat);
          EmulatedBoard board(usb, { .transport = transport, .baud = 57600, .chip = 128 },
                              firmware);
          FirmataDriver driver(FirmataDriver::Firmware::any,
                               [] { return std::make_unique<tactor::UsbSerialBus>(); });
          unwrap(driver.open({}));
          // The driver turns off motors whose levels are not repeated.
          fail_unless(board.wait_until([&] {
            unwrap(driver.write(std::vector<double>(motors, 3.0), 0s));
            for (std::size_t i = 0; i < motors; i++)
              if (firmware->duty(2 + static_cast<int>(i)) != 255)
                return false;
            return true;
          }));
          if (!is_heard)
            board.garble([](Bytes &reply) { reply.clear(); });
          driver.close();
          board.with_firmware([&] { fail_if(firmware->any_motor_on()); });
          ck_assert_uint_eq(board.cut_off(), 0);
        }
}

namespace {

constexpr std::uint8_t kReset = 0xff;

/// A board whose motors a killed host left on, with a slow chip and a kernel that acts immediately:
/// the emulated kernel otherwise takes longer than the few bytes of a query.
struct LeftOn
{
  explicit LeftOn(Transport transport, const Layout &layout = kMega)
      : firmware(std::make_shared<Firmware>(layout)), board(usb,
                                                            { .transport = transport,
                                                              .baud = 57600,
                                                              .chip = 128,
                                                              .chip_time = 1900us,
                                                              .kernel_opens = 0us },
                                                            firmware)
  {
    FirmataDriver before(FirmataDriver::Firmware::any, make_bus);
    unwrap(before.open({})); // resets the board
    before.close();
    board.with_firmware([&] {
      for (const int pin : layout.pwm) {
        for (const int byte : { 0xf4, pin, 3, 0xf0, 0x6f, pin, 0x7f, 1, 0xf7 })
          firmware->receive(static_cast<std::uint8_t>(byte), Clock::now());
        fail_unless_equals_int(firmware->duty(pin), 255);
      }
    });
    told_before = board.bytes().size();
  }

  static std::unique_ptr<tactor::SerialBus> make_bus()
  {
    return std::make_unique<tactor::UsbSerialBus>();
  }

  /// Whether the kernel's driver has the board and no byte was lost in the chip.
  bool was_released_whole() const
  {
    return board.conversation().back() == "return 0" && board.cut_off() == 0
           && board.wait_until([this] { return board.in_chip() == 0; });
  }
  bool was_reset() const
  {
    const Bytes told = board.bytes();
    return std::find(told.begin() + static_cast<std::ptrdiff_t>(told_before), told.end(), kReset)
           != told.end();
  }
  bool motors_stand() const
  {
    bool stand = false;
    board.with_firmware([&] { stand = !firmware->any_motor_on(); });
    return stand;
  }

  EmulatedUsb usb;
  std::shared_ptr<Firmware> firmware;
  EmulatedBoard board;
  std::size_t told_before = 0;
};

bool
is_version(const Bytes &reply)
{
  return !reply.empty() && reply[0] == 0xf9;
}

} // namespace

/// A board with too few pins, or without watchdog, is refused and released like one that played.
CHECK_TEST(test_refused_boards_stand_when_released)
{
  for (const Transport transport : kTransports)
    for (const bool has_too_few : { true, false })
      for (const bool is_heard : { true, false }) {
        LeftOn left(transport, has_too_few ? kUno : kMega);
        if (!is_heard)
          left.board.garble([](Bytes &reply) {
            if (is_version(reply)) // the last reply
              reply.clear();
          });
        FirmataDriver driver(has_too_few ? FirmataDriver::Firmware::any
                                         : FirmataDriver::Firmware::with_watchdog,
                             LeftOn::make_bus);
        const auto refusal = refusal_of(driver.open({ .min_tactors = has_too_few ? 9 : 1 }));
        fail_unless(refusal.kind == DriverError::Kind::settings, "%s", refusal.text.c_str());
        fail_unless(left.was_released_whole());
        const Bytes told = left.board.bytes();
        fail_unless(told[told.size() - 2] == kReset && is_version({ told.back() }));
        fail_unless(left.motors_stand());
      }
}

/// Opening is interrupted, or the line breaks, as soon as the chip has the bytes of the firmware
/// query or the reset. Repeated, because the emulated kernel is not always quick enough to cut them
/// off.
CHECK_TEST(test_interrupted_opening_cuts_nothing_off)
{
  for (const Transport transport : kTransports)
    for (const bool is_known : { false, true })
      for (const bool breaks : { false, true }) {
        LeftOn left(transport);
        bool has_answered = false;
        left.board.garble([&](Bytes &reply) {
          has_answered = is_known && !is_version(reply);
          if (!is_known)
            reply.clear();
        });
        for (int i = 0; i < 8; i++) {
          left.board.with_firmware([&] { has_answered = false; });
          FirmataDriver driver(FirmataDriver::Firmware::any, LeftOn::make_bus);
          std::stop_source stop;
          std::thread opening([&] { refusal_of(driver.open({ .stop = stop.get_token() })); });
          fail_unless(left.board.wait_until(
              [&] { return left.board.in_chip() > 0 && has_answered == is_known; }));
          if (breaks)
            left.board.break_transfers(EmulatedBoard::kAll);
          else
            stop.request_stop();
          opening.join();
          left.board.break_transfers(0);
          fail_unless(left.was_released_whole());
          fail_unless(left.was_reset() == is_known);
          fail_unless(left.motors_stand() == is_known);
        }
      }
}

CHECK_MAIN_AFTER(firmata_usb, -1, begin_emulation())
