// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/firmata_protocol.h"

#include "support/boards/firmata_model.h"

#include <algorithm>
#include <random>
#include <utility>

#include "support/check_tests.h"

using namespace tactor::firmata;

namespace {

using Bytes = std::vector<std::uint8_t>;

void
assert_bytes(const Encoder &encoder, const Bytes &expected)
{
  fail_unless(encoder.bytes() == expected);
}

/// The events of bytes that arrive in pieces of the given length.
std::vector<Event>
decode(const Bytes &bytes, std::size_t piece = 1 << 20, std::uint64_t *damaged = nullptr)
{
  Decoder decoder;
  std::vector<Event> events;
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    decoder.feed(std::span(bytes).subspan(i, std::min(piece, bytes.size() - i)),
                 [&](const Event &event) { events.push_back(event); });
  if (damaged)
    *damaged = decoder.damaged();
  return events;
}

std::vector<Event>
only(const Event &event)
{
  return { event };
}

/// A board's reply.
Bytes
reply(const Layout &layout, const Bytes &question)
{
  FirmataModel model(layout);
  model.restart({});
  model.replies.clear();
  for (const std::uint8_t byte : question)
    model.receive(byte, {});
  return { model.replies.begin(), model.replies.end() };
}

Bytes
join(std::initializer_list<Bytes> parts)
{
  Bytes all;
  for (const Bytes &part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

const Bytes kVersionBytes{ 0xf9, 2, 5 };
const Bytes kFirmwareBytes{ 0xf0, 0x79, 2, 5, 'a', 0, 'B', 0, 0xf7 };
const Event kVersionEvent = VersionReport{ 2, 5 };
const Event kFirmwareEvent = FirmwareReport{ 2, 5, "aB" };

} // namespace

/// Bytes verified with StandardFirmata on an emulated ATmega2560.
CHECK_TEST(test_bytes_to_the_board)
{
  assert_bytes(Encoder().ask_version(), { 0xf9 });
  assert_bytes(Encoder().ask_firmware(), { 0xf0, 0x79, 0xf7 });
  assert_bytes(Encoder().ask_capabilities(), { 0xf0, 0x6b, 0xf7 });
  assert_bytes(Encoder().set_mode(3, kPwm), { 0xf4, 0x03, 0x03 });
  assert_bytes(Encoder().set_value(3, 192), { 0xe3, 0x40, 0x01 });
  assert_bytes(Encoder().set_value(15, 16383), { 0xef, 0x7f, 0x7f });
  assert_bytes(Encoder().set_value(44, 128), { 0xf0, 0x6f, 0x2c, 0x00, 0x01, 0xf7 });
  assert_bytes(Encoder().set_value(16, 0), { 0xf0, 0x6f, 0x10, 0x00, 0x00, 0xf7 });
  assert_bytes(Encoder().set_value(3, 65535), { 0xf0, 0x6f, 0x03, 0x7f, 0x7f, 0x03, 0xf7 });
  assert_bytes(Encoder().reset(), { 0xff });
  assert_bytes(Encoder().keepalive(), { 0xf0, 0x01, 0xf7 });
  assert_bytes(Encoder().set_value(2, 0).set_value(3, 1).reset(), { 0xe2, 0, 0, 0xe3, 1, 0, 0xff });
  // 9 tactors take 27 bytes.
  Encoder nine;
  for (int pin = 2; pin < 11; pin++)
    nine.set_value(pin, 255);
  ck_assert_uint_eq(nine.bytes().size(), 27);
}

/// No byte within a message can be taken for the beginning of another, whatever the pin and the
/// value.
CHECK_TEST(test_every_pin_and_value)
{
  for (int pin = -3; pin < 140; pin++)
    for (const unsigned value : { 0u, 1u, 127u, 128u, 255u, 300u, 16383u, 16384u, ~0u }) {
      const Bytes bytes = Encoder().set_value(pin, value).bytes();
      ck_assert_uint_le(bytes.size(), Encoder::kLongest);
      const std::size_t inner_end = bytes.back() == 0xf7 ? bytes.size() - 1 : bytes.size();
      fail_unless(bytes.front() >= 0x80);
      for (std::size_t i = 1; i < inner_end; i++)
        fail_unless(bytes[i] < 0x80);
    }
}

CHECK_TEST(test_bytes_from_the_board)
{
  fail_unless(decode(kVersionBytes) == std::vector{ kVersionEvent });
  fail_unless(decode(kFirmwareBytes) == std::vector{ kFirmwareEvent });
  fail_unless(decode({ 0xf0, 0x6c, 0x7f, 0, 1, 1, 1, 3, 8, 0x7f, 0x7f, 0xf7 })
              == only(CapabilityReport{ { {}, { { 0, 1 }, { 1, 1 }, { 3, 8 } }, {} } }));
  // Inputs, text and sysex messages of others are ignored and do not count as damage.
  std::uint64_t damaged = 1;
  fail_unless(
      decode({ 0x91, 1, 0, 0xe0, 5, 6, 0xf0, 0x71, 'h', 0, 0xf7, 0xf0, 0x0f, 0xf7 }, 100, &damaged)
          .empty());
  ck_assert_uint_eq(damaged, 0);
}

/// A Mega's reply has 683 bytes (measured on an emulated chip). Its PWM pins are those of its data
/// sheet.
CHECK_TEST(test_capabilities_of_boards)
{
  const Bytes mega = reply(kMega, { 0xf0, 0x6b, 0xf7 });
  ck_assert_uint_eq(mega.size(), 683);
  for (const auto &[layout, bytes] :
       { std::pair(kMega, mega), std::pair(kUno, reply(kUno, { 0xf0, 0x6b, 0xf7 })) }) {
    const std::vector<Event> events = decode(bytes);
    ck_assert_uint_eq(events.size(), 1);
    const auto &report = std::get<CapabilityReport>(events[0]);
    ck_assert_uint_eq(report.pins.size(), static_cast<std::size_t>(layout.pins));
    std::set<int> pwm;
    for (std::size_t pin = 0; pin < report.pins.size(); pin++)
      if (std::ranges::count(report.pins[pin], PinMode{ kPwm, 8 }) == 1)
        pwm.insert(static_cast<int>(pin));
    fail_unless(pwm == layout.pwm);
  }
}

CHECK_TEST(test_split_anywhere)
{
  const Bytes bytes = join({ { 5, 0xf7 },
                             kVersionBytes,
                             reply(kMega, { 0xf0, 0x6b, 0xf7 }),
                             { 0xf0, 0x6c, 1, 0x7f, 0xf7, 0xf9, 1 },
                             kFirmwareBytes,
                             { 0xe0, 1, 2, 0xf0, 0x6e, 3, 3, 0x40, 1, 0xf7 } });
  std::uint64_t damaged = 0;
  const std::vector<Event> whole = decode(bytes, bytes.size(), &damaged);
  ck_assert_uint_eq(whole.size(), 3);
  ck_assert_uint_eq(damaged, 4); // 5, F7, the odd list, the truncated version
  for (std::size_t cut = 0; cut <= bytes.size(); cut++) {
    Decoder decoder;
    std::vector<Event> events;
    const auto keep = [&](const Event &event) {
      events.push_back(event);
    };
    decoder.feed(std::span(bytes).first(cut), keep);
    decoder.feed(std::span(bytes).subspan(cut), keep);
    fail_unless(events == whole, "cut at %zu", cut);
    ck_assert_uint_eq(decoder.damaged(), damaged);
  }
  for (std::size_t piece = 1; piece < 64; piece++)
    fail_unless(decode(bytes, piece) == whole);
}

/// After any damage the next whole message is found.
CHECK_TEST(test_damage)
{
  const Bytes damages[] = {
    { 0xf0 },
    { 0xf0, 0x79 },
    { 0xf0, 0x79, 2, 0xf7 },
    { 0xf0, 0x79, 2, 5, 'x', 0xf7 },
    { 0xf0, 0x6c, 0xf7 },
    { 0xf0, 0x6c, 3, 8, 0xf7 },
    { 0xf0, 0x6c, 3, 0x7f, 0xf7 },
    join({ { 0xf0, 0x6c }, Bytes(129, 0x7f), { 0xf7 } }),
    { 0xf9, 2 },
    { 0xe3 },
    { 0xf0, 0x6c, 3, 0xff },
    Bytes(10'000, 0x11),
    Bytes(10'000, 0xf0),
    join({ { 0xf0, 0x79 }, Bytes(2 * Decoder::kMaxSysex, 1), { 0xf7 } }),
    join({ { 0xf0, 0x6c }, Bytes(2 * Decoder::kMaxSysex, 1) }),
  };
  for (const Bytes &damage : damages)
    for (const std::size_t piece : { std::size_t{ 1 }, std::size_t{ 1 } << 20 }) {
      std::uint64_t damaged = 0;
      const std::vector<Event> events
          = decode(join({ damage, kFirmwareBytes, kVersionBytes }), piece, &damaged);
      fail_unless(events == (std::vector{ kFirmwareEvent, kVersionEvent }), "%02x %02x, %zu bytes",
                  damage[0], damage.size() > 1 ? damage[1] : 0, damage.size());
      ck_assert_uint_ge(damaged, 1);
    }
}

/// A firmware's name may contain any bytes, and appears in messages on a terminal.
CHECK_TEST(test_name_of_the_firmware)
{
  const Bytes odd{ 0xf0, 0x79, 2, 5, 'a', 0, 27, 0, 'b', 1, 'c', 0, 0x7f, 0, 0xf7 };
  fail_unless(decode(odd) == only(FirmwareReport{ 2, 5, "a??c?" }));
  Bytes longest{ 0xf0, 0x79, 2, 5 };
  for (int i = 0; i < 1000; i++)
    longest = join({ longest, { 'x', 0 } });
  longest.push_back(0xf7);
  fail_unless(decode(longest) == only(FirmwareReport{ 2, 5, std::string(64, 'x') }));
  fail_unless(decode({ 0xf0, 0x79, 2, 5, 0xf7 }) == only(FirmwareReport{ 2, 5, "" }));
}

/// Random bytes, of all values and of those that a board uses: sizes stay bounded, and the events
/// do not depend on how the bytes are split.
CHECK_TEST(test_noise)
{
  std::mt19937 random(7);
  const Bytes likely{ 0xf0, 0xf7, 0xf9, 0x79, 0x6c, 0x6a, 0x6e, 0x7f, 0, 1, 3, 8, 0xe3, 0xff };
  for (int round = 0; round < 400; round++) {
    Bytes bytes(2000);
    for (std::uint8_t &byte : bytes)
      byte
          = round % 2 == 0 ? static_cast<std::uint8_t>(random()) : likely[random() % likely.size()];
    const std::vector<Event> whole = decode(bytes);
    fail_unless(decode(bytes, 1 + random() % 9) == whole);
    for (const Event &event : whole)
      if (const auto *report = std::get_if<CapabilityReport>(&event))
        fail_unless(report->pins.size() <= kMaxPins);
    // A sane board afterwards is understood.
    const std::vector<Event> after = decode(join({ bytes, { 0xf7 }, kFirmwareBytes }));
    fail_unless(!after.empty() && after.back() == kFirmwareEvent);
  }
}

CHECK_MAIN(firmata_protocol)
