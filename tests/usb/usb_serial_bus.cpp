// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listener.h"

#include <algorithm>
#include <filesystem>
#include <stop_token>
#include <sys/fsuid.h>
#include <thread>
#include <unistd.h>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using namespace usb_test;

CHECK_TEST(test_conversations)
{
  const std::vector<std::string> expected[] = {
    { "claim 0", "claim 1", "21 20 0000 0000 00e10000000008", "21 22 0003 0000", "release 1",
      "return 1", "release 0", "return 0" },
    { "claim 0", "40 00 0000 0000", "40 03 c034 0000", "40 04 0008 0000", "40 09 0001 0000",
      "40 01 0101 0000", "40 01 0202 0000", "release 0", "return 0" },
    { "claim 0", "c0 5f 0000 0000 2 bytes", "40 a1 0000 0000", "40 9a 1312 9883", "40 9a 0f2c 0010",
      "40 9a 2518 00c3", "40 a4 ff9f 0000", "release 0", "return 0" },
  };
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard board(usb, { .transport = transport });
    UsbSerialBus bus;
    Listener listener;
    open_only(bus, listener).reset();
    fail_unless(board.conversation() == expected[static_cast<int>(transport)]);
    fail_unless_equals_int(board.transfers_pending(), 0);
    fail_unless(listener.lost().empty());
  }
}

CHECK_TEST(test_list)
{
  EmulatedUsb usb;
  EmulatedBoard far_away(usb, { .transport = Transport::ch340, .port = "1-10", .serial = "" });
  EmulatedBoard modem(usb, { .port = "1-3", .vendor = 0x12d1 });
  EmulatedBoard board(usb, { .port = "1-2" });
  EmulatedBoard clone(usb, { .transport = Transport::ftdi, .port = "1-1", .manufacturer = "" });
  UsbSerialBus bus;
  const std::vector<SerialDevice> expected{
    { "75833353035351F0C0A1", "1-1", "Mega 2560", 0x0403, 0x6001, "ftdi" },
    { "75833353035351F0C0A1", "1-2", "Arduino (www.arduino.cc) Mega 2560", 0x2341, 0x0042,
      "cdc-acm" },
    { "", "1-10", "Arduino (www.arduino.cc) Mega 2560", 0x1a86, 0x7523, "ch340" },
  };
  fail_unless(unwrap(bus.list()) == expected);
  // Listing opens nothing.
  fail_unless(board.conversation().empty());
}

CHECK_TEST(test_strings_that_are_none)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, { .serial = "a\x1b[31m\nb\xff\xc0\xaf"
                                       "c",
                             .manufacturer = std::string(5000, 'x'),
                             .product = std::string("\0\0", 2) });
  UsbSerialBus bus;
  const std::vector<SerialDevice> devices = unwrap(bus.list());
  fail_unless_equals_int(devices.size(), 1);
  const std::string unfit = "\xef\xbf\xbd";
  fail_unless(devices[0].serial
              == "a" + unfit + "[31m" + unfit + "b" + unfit + unfit + unfit + "c");
  fail_unless(devices[0].name == std::string(126, 'x'));
}

/// Truncated, garbled or false descriptors: the device is left out, or its values are within
/// bounds.
CHECK_TEST(test_descriptors_that_lie)
{
  std::mt19937 random(1);
  UsbSerialBus bus;
  EmulatedUsb usb;
  for (int i = 0; i < 90; i++) {
    const Transport transport = kTransports[i % 3];
    Bytes descriptors = usb_descriptors(transport);
    if (i < 60) {
      for (int flip = 0; flip < 1 + i / 10; flip++)
        descriptors[18 + random() % (descriptors.size() - 18)]
            = static_cast<std::uint8_t>(random());
    } else {
      descriptors.resize(1 + random() % descriptors.size());
    }
    EmulatedBoard board(usb, { .transport = transport, .descriptors = descriptors });
    for (const SerialDevice &device : unwrap(bus.list()))
      fail_unless_equals_string(device.bus_path.c_str(), "1-1");
  }
  // Lines that cannot carry a byte: no endpoints, or packets of 0 bytes.
  Bytes no_endpoints = usb_descriptors(Transport::ftdi);
  no_endpoints[18 + 9 + 4] = 0;
  Bytes no_packets = usb_descriptors(Transport::ch340);
  no_packets[18 + 9 + 9 + 4] = 0;
  for (const Bytes &descriptors : { no_endpoints, no_packets }) {
    EmulatedBoard board(
        usb, { .transport = descriptors == no_endpoints ? Transport::ftdi : Transport::ch340,
               .descriptors = descriptors });
    fail_unless(unwrap(bus.list()).empty());
  }
}

/// FT2232: two lines. The first is number 1.
CHECK_TEST(test_chip_with_two_lines)
{
  Bytes descriptors = usb_descriptors(Transport::ftdi);
  descriptors[10] = 0x10;
  descriptors[11] = 0x60;
  const Bytes second{ 9, 4,  1, 0, 2, 255, 255,  255, 2,  7, 5, 0x83,
                      2, 64, 0, 0, 7, 5,   0x04, 2,   64, 0, 0 };
  descriptors.insert(descriptors.end(), second.begin(), second.end());
  descriptors[18 + 2] += static_cast<std::uint8_t>(second.size());
  descriptors[18 + 4] = 2;
  EmulatedUsb usb;
  EmulatedBoard board(usb, { .transport = Transport::ftdi, .descriptors = descriptors });
  UsbSerialBus bus;
  Listener listener;
  const auto port = open_only(bus, listener);
  const std::vector<std::string> expected{ "claim 0",         "40 00 0000 0001", "40 03 c034 0001",
                                           "40 04 0008 0001", "40 09 0001 0001", "40 01 0101 0001",
                                           "40 01 0202 0001" };
  fail_unless(board.conversation() == expected);
}

CHECK_TEST(test_boards_that_cannot_be_opened)
{
  using Kind = DriverError::Kind;
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus({ .request = 20ms });
  const SerialDevice device = unwrap(bus.list()).at(0);
  const auto open = [&] {
    return refusal_of(bus.open(device, {}));
  };

  board.use_by_another(true);
  fail_unless(open().kind == Kind::busy);
  board.use_by_another(false);

  board.refuse_requests(true);
  fail_unless(open().kind == Kind::failed);
  board.refuse_requests(false);

  board.ignore_requests(true);
  fail_unless(open().kind == Kind::failed);
  board.ignore_requests(false);

  // Claimed interfaces were released.
  std::vector<std::string> conversation = board.conversation();
  fail_unless_equals_int(std::count(conversation.begin(), conversation.end(), "claim 0"), 2);
  fail_unless_equals_int(std::count(conversation.begin(), conversation.end(), "return 0"), 2);
  fail_unless_equals_int(board.transfers_pending(), 0);

  board.unplug();
  fail_unless(open().kind == Kind::not_found);
  board.plug();
  SerialDevice another = device;
  another.serial = "another";
  fail_unless(refusal_of(bus.open(another, {})).kind == Kind::not_found);
  unwrap(bus.open(device, {}));
}

/// open() of a board that answers no request is interrupted. The timeout would be an hour.
CHECK_TEST(test_set_up_is_interrupted)
{
  for (const Transport transport : kTransports) {
    EmulatedUsb usb;
    EmulatedBoard board(usb, { .transport = transport });
    board.ignore_requests(true);
    UsbSerialBus bus({ .request = 1h });
    const SerialDevice device = unwrap(bus.list()).at(0);
    std::stop_source stop;
    std::thread other([&] {
      fail_unless(board.wait_for_ignored_request());
      stop.request_stop();
    });
    const DriverError error = refusal_of(bus.open(device, {}, stop.get_token()));
    other.join();
    fail_unless(error.kind == DriverError::Kind::failed, "%s", error.text.c_str());
    fail_unless_equals_int(board.transfers_pending(), 0);
    board.ignore_requests(false);
    // Also before it starts.
    fail_unless(refusal_of(bus.open(device, {}, stop.get_token())).kind
                == DriverError::Kind::failed);
    unwrap(bus.open(device, {}));
  }
}

CHECK_TEST(test_permission_denied)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus;
  const SerialDevice device = unwrap(bus.list()).at(0);
  board.forbid();
  // Root may open everything, so this thread changes its file system user. The test bed and
  // umockdev's sockets stay accessible.
  for (const auto &entry : std::filesystem::recursive_directory_iterator(usb.path("/")))
    if (!entry.is_symlink())
      std::filesystem::permissions(entry.path(), std::filesystem::perms(0777));
  std::filesystem::permissions(usb.path("/"), std::filesystem::perms(0777));
  const uid_t user = static_cast<uid_t>(setfsuid(geteuid() == 0 ? 65534 : geteuid()));
  const DriverError error = refusal_of(bus.open(device, {}));
  setfsuid(user);
  fail_unless(error.kind == DriverError::Kind::permission, "%s", error.text.c_str());
  const std::string what = error.text;
  fail_unless(what.find("70-visuotactile.rules") != std::string::npos);
  fail_unless(what.find("udevadm control --reload") != std::string::npos);
  fail_unless(what.find("Mega 2560") != std::string::npos);
}

CHECK_TEST(test_two_boards)
{
  EmulatedUsb usb;
  EmulatedBoard first(usb, { .port = "1-1" });
  EmulatedBoard second(usb, { .transport = Transport::ch340, .port = "1-2" });
  UsbSerialBus bus;
  const std::vector<SerialDevice> devices = unwrap(bus.list());
  fail_unless_equals_int(devices.size(), 2);
  Listener listeners[2];
  auto port = unwrap(bus.open(devices[0], listeners[0].events()));
  const auto other = unwrap(bus.open(devices[1], listeners[1].events()));
  const Bytes one{ 1 }, two{ 2 };
  fail_unless(port->write(one));
  fail_unless(other->write(two));
  first.send(one);
  second.send(two);
  for (int i = 0; i < 2; i++) {
    fail_unless(listeners[i].wait_for_written(1));
    fail_unless(listeners[i].wait_for_bytes(1));
  }
  fail_unless(first.bytes() == one && listeners[0].received() == one);
  fail_unless(second.bytes() == two && listeners[1].received() == two);
  // A failure of one board does not affect the other.
  first.unplug();
  fail_unless(listeners[0].wait_for_loss());
  port.reset();
  fail_unless(other->write(two));
  fail_unless(listeners[1].wait_for_written(2));
  fail_unless(listeners[1].lost().empty());
}

/// A second board is plugged in, and the first is unplugged and plugged in again. False if no event
/// came.
static bool
is_told(bool udev)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus({ .look = udev ? 10s : 20ms });
  Listener listener;
  Counter changes;
  bus.watch([&] { changes.count(); });
  if (!udev)
    usb.stop_udev();
  EmulatedBoard other(usb, { .transport = Transport::ftdi, .port = "1-2" });
  if (!changes.wait_for(1))
    return false;
  fail_unless_equals_int(unwrap(bus.list()).size(), 2);
  // Unplugged and plugged in again, the board can be opened.
  auto port = unwrap(bus.open(unwrap(bus.list()).at(0), listener.events()));
  board.unplug();
  fail_unless(listener.wait_for_loss());
  if (!udev && !changes.wait_for(2))
    return false;
  board.plug();
  if (!changes.wait_for(udev ? 2 : 3))
    return false;
  port = unwrap(bus.open(unwrap(bus.list()).at(0), listener.events()));
  const Bytes bytes{ 1 };
  fail_unless(port->write(bytes));
  fail_unless(board.wait_for_bytes(1));
  port.reset();
  // No more calls after this.
  bus.watch(nullptr);
  return true;
}

/// With udevd the bus need not poll often; without it must. On a busy machine, libusb's thread that
/// listens to the emulated udevd sometimes ends for an unknown reason. Then the next poll finds the
/// change, or the test is repeated. So this does not prove that udev events arrive.
CHECK_TEST(test_watch)
{
  for (const bool udev : { true, false })
    fail_unless(is_told(udev) || is_told(udev) || is_told(udev));
}

CHECK_TEST(test_watch_ends)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, {});
  UsbSerialBus bus({ .look = 1ms });
  for (int i = 0; i < 20; i++) {
    auto alive = std::make_unique<int>(0);
    bus.watch([&] { ++*alive; });
    board.unplug();
    board.plug();
    bus.watch(nullptr);
    alive.reset();
  }
}

CHECK_MAIN_AFTER(usb_serial_bus, -1, begin_emulation())
