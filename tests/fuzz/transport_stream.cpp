// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes TransportTrack: what it writes are whole packets.
#include "tracks/formats/transport_stream.h"
#include "fuzz.h"

#include <algorithm>
#include <vector>

namespace {

using tactile::TransportTrack;
using Bytes = std::vector<std::uint8_t>;

template <typename Visit>
void
for_each_packet(const Bytes &bytes, Visit visit)
{
  for (std::size_t at = 0; at + TransportTrack::kPacket <= bytes.size();
       at += TransportTrack::kPacket)
    visit(TransportTrack::Packet(bytes.data() + at, TransportTrack::kPacket));
}

/// Empty: no track can be added.
Bytes
with_track(const Bytes &film)
{
  std::deque<tactile::Cue> cues;
  for (int i = 0; i < 3; i++)
    cues.push_back({ std::chrono::seconds(i), std::chrono::seconds(i + 1), { 8, 8 } });
  TransportTrack track(cues, 90'000);
  for_each_packet(film, [&](TransportTrack::Packet packet) { track.scan(packet); });
  Bytes out;
  if (!track.check())
    return out;
  for_each_packet(film, [&](TransportTrack::Packet packet) { track.copy(packet, out); });
  track.finish(out);
  return out;
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const Bytes film(data, data + std::min(size, std::size_t{ 1 } << 20));
  const Bytes copy = with_track(film);
  if (copy.empty())
    return 0;
  expect(copy.size() % TransportTrack::kPacket == 0);
  for_each_packet(copy, [](TransportTrack::Packet packet) { expect(packet[0] == 0x47); });
  return 0;
}
