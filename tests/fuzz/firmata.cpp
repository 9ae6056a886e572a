// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes a board's replies: the decoder's events do not depend on how bytes are split, and the
// conversation keeps its limits and terminates.
#include "fuzz.h"
#include "tactor/drivers/firmata_board.h"
#include "tactor/serial/serial_port.h"

#include <algorithm>
#include <optional>
#include <vector>

using namespace tactor;

namespace {

void
check_decoder(std::span<const std::uint8_t> bytes)
{
  std::vector<firmata::Event> whole;
  std::vector<firmata::Event> pieces;
  firmata::Decoder at_once;
  firmata::Decoder bytewise;
  at_once.feed(bytes, [&](const firmata::Event &event) { whole.push_back(event); });
  for (std::size_t i = 0; i < bytes.size(); i++)
    bytewise.feed(bytes.subspan(i, 1),
                  [&](const firmata::Event &event) { pieces.push_back(event); });
  expect(whole == pieces && at_once.damaged() == bytewise.damaged());
  for (const firmata::Event &event : whole) {
    if (const auto *report = std::get_if<firmata::CapabilityReport>(&event))
      expect(!report->pins.empty() && report->pins.size() <= firmata::kMaxPins);
    if (const auto *report = std::get_if<firmata::FirmwareReport>(&event))
      expect(report->name.size() <= 64
             && std::ranges::all_of(report->name, [](char c) { return c >= ' ' && c <= '~'; }));
  }
}

/// Sends the pending bytes and checks them. Levels are refreshed meanwhile.
void
turn(FirmataBoard &board, Time now)
{
  const std::vector<double> levels(firmata::kMaxPins, 0.7);
  board.set_levels(levels, now);
  const std::vector<std::uint8_t> out = board.next(now);
  expect(out.size() <= SerialPort::kMaxWrite);
  expect(out.empty() || out[0] >= 0x80);
  if (!out.empty()) {
    expect(board.next(now).empty());
    board.written();
  }
}

void
check_board(std::span<const std::uint8_t> bytes)
{
  Time now{ 0 };
  FirmataBoard board(now);
  // The first byte of each piece encodes its length and how much time passes.
  while (!bytes.empty()) {
    const std::size_t length = std::min<std::size_t>(bytes[0], bytes.size());
    turn(board, now);
    board.received(bytes.first(length));
    bytes = bytes.subspan(std::max<std::size_t>(length, 1));
    now += std::chrono::milliseconds(length);
  }
  const std::vector<int> pins = board.pins();
  expect(pins.size() <= firmata::kMaxPins && std::ranges::is_sorted(pins));
  expect(board.state() != FirmataBoard::State::running || !board.firmware().empty());
  board.close(now);
  // Zeros for 128 pins and a reset, without an answer: ends by its deadlines.
  const FirmataPatience patience;
  const Time latest = now + patience.drain + patience.acknowledge
                      + FirmataBoard::kPacket * FirmataBoard::kByteTime;
  turn(board, now);
  while (board.state() == FirmataBoard::State::closing) {
    const std::optional<Time> deadline = board.deadline();
    expect(deadline && *deadline > now && *deadline <= latest);
    now = *deadline;
    turn(board, now);
  }
  expect(board.state() == FirmataBoard::State::closed
         || board.state() == FirmataBoard::State::failed);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  check_decoder({ data, size });
  check_board({ data, size });
  return 0;
}
