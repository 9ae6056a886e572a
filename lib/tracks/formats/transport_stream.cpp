// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/transport_stream.h"

#include "tracks/klv.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tactile {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t kSync = 0x47;
constexpr int kPrograms = 0;               ///< PID of the program association table
constexpr std::uint8_t kProgramMap = 0x02; ///< table
constexpr std::uint8_t kPrivateData = 0x06;
constexpr std::int64_t kWrap = std::int64_t{ 1 } << 33; ///< of time stamps
constexpr std::int64_t kClock = 90'000;
constexpr std::size_t kLongestMap = 1021; ///< bytes that follow its length
constexpr std::size_t kChecksum = 4;

/// A cue precedes frames of its time by as much, since decoders hold frames up.
constexpr std::int64_t kLead = kClock / 5;

/// Registration descriptor of KLV (SMPTE RP 217).
constexpr std::array<std::uint8_t, 6> kKlvDescriptor = { 0x05, 4, 'K', 'L', 'V', 'A' };

int
pid_of(TransportTrack::Packet packet)
{
  return (packet[1] & 0x1f) << 8 | packet[2];
}

bool
begins_unit(TransportTrack::Packet packet)
{
  return (packet[1] & 0x40) != 0;
}

Bytes
payload_of(TransportTrack::Packet packet)
{
  if ((packet[3] & 0x10) == 0)
    return {};
  const std::size_t begin = (packet[3] & 0x20) != 0 ? std::size_t{ 5 } + packet[4] : 4;
  return begin < packet.size() ? Bytes(packet).subspan(begin) : Bytes();
}

std::size_t
length_at(Bytes bytes, std::size_t at)
{
  return static_cast<std::size_t>((bytes[at] & 0x0f) << 8 | bytes[at + 1]);
}

std::uint32_t
checksum(Bytes bytes)
{
  std::uint32_t sum = 0xffffffff;
  for (const std::uint8_t byte : bytes) {
    sum ^= std::uint32_t{ byte } << 24;
    for (int bit = 0; bit < 8; bit++)
      sum = sum << 1 ^ ((sum & 0x80000000) != 0 ? 0x04c11db7 : 0);
  }
  return sum;
}

bool
is_valid_map(Bytes section)
{
  return section.size() >= 16 && section[0] == kProgramMap && checksum(section) == 0
         && 12 + length_at(section, 10) + kChecksum <= section.size();
}

/// Calls with type, PID and all bytes of each stream in a valid program map.
template <typename Visit>
void
for_each_stream(Bytes section, Visit visit)
{
  const Bytes streams = section.first(section.size() - kChecksum);
  std::size_t at = 12 + length_at(section, 10);
  while (at + 5 <= streams.size()) {
    const std::size_t size = 5 + length_at(streams, at + 3);
    if (at + size > streams.size())
      break;
    visit(streams[at], static_cast<int>((streams[at + 1] & 0x1f) << 8 | streams[at + 2]),
          streams.subspan(at, size));
    at += size;
  }
}

/// MPEG-1, -2 and -4, AVC and its extensions, HEVC, VVC, AVS, Dirac, VC-1.
bool
is_picture(std::uint8_t type)
{
  constexpr std::array<std::uint8_t, 14> kTypes
      = { 0x01, 0x02, 0x10, 0x1b, 0x1f, 0x20, 0x24, 0x33, 0x42, 0xd1, 0xd2, 0xd4, 0xea, 0x80 };
  return std::ranges::find(kTypes, type) != kTypes.end();
}

/// The time stamp of decoding, else of presentation, of a PES packet.
std::optional<std::int64_t>
stamp_of(Bytes pes)
{
  if (pes.size() < 14 || pes[0] != 0 || pes[1] != 0 || pes[2] != 1 || (pes[7] & 0x80) == 0)
    return std::nullopt;
  const std::size_t at = (pes[7] & 0x40) != 0 && pes.size() >= 19 ? 14 : 9;
  return std::int64_t{ pes[at] & 0x0e } << 29 | std::int64_t{ pes[at + 1] } << 22
         | std::int64_t{ pes[at + 2] & 0xfe } << 14 | std::int64_t{ pes[at + 3] } << 7
         | pes[at + 4] >> 1;
}

/// The difference of two time stamps, of which one may have wrapped.
std::int64_t
between(std::int64_t from, std::int64_t to)
{
  const std::int64_t off = (to - from) & (kWrap - 1);
  return off < kWrap / 2 ? off : off - kWrap;
}

std::int64_t
ticks(Time time)
{
  return time.count() / 1'000'000 * 90 + time.count() % 1'000'000 * 90 / 1'000'000;
}

std::vector<std::uint8_t>
pes_of(const Cue &cue, std::int64_t stamp)
{
  const std::vector<std::uint8_t> klv = write_klv(cue.map, cue.end - cue.begin);
  const std::size_t length = 8 + klv.size();
  std::vector<std::uint8_t> pes = { 0, 0, 1, 0xbd }; // private stream 1
  const auto add = [&pes](std::size_t value) {
    pes.push_back(static_cast<std::uint8_t>(value & 0xff));
  };
  const auto time = static_cast<std::size_t>(stamp);
  add(length >> 8);
  add(length);
  for (const std::size_t value : { 0x84U, 0x80U, 5U }) // aligned; with a time stamp; its size
    add(value);
  add(0x21 | (time >> 29 & 0x0e));
  add(time >> 22);
  add(time >> 14 | 1);
  add(time >> 7);
  add(time << 1 | 1);
  pes.insert(pes.end(), klv.begin(), klv.end());
  return pes;
}

/// Appends packets that have `unit`. Tables are filled up with 0xff, others by adaptation fields.
void
append_packets(std::vector<std::uint8_t> &out, int pid, std::uint8_t &counter, Bytes unit,
               bool is_table)
{
  constexpr std::size_t kRoom = TransportTrack::kPacket - 4;
  for (std::size_t at = 0; at < unit.size();) {
    const std::size_t size = std::min(unit.size() - at, kRoom);
    const std::size_t fill = is_table ? 0 : kRoom - size;
    out.push_back(kSync);
    out.push_back(static_cast<std::uint8_t>((at == 0 ? 0x40 : 0) | pid >> 8));
    out.push_back(static_cast<std::uint8_t>(pid));
    out.push_back(static_cast<std::uint8_t>((fill > 0 ? 0x30 : 0x10) | (counter++ & 0x0f)));
    if (fill > 0)
      out.push_back(static_cast<std::uint8_t>(fill - 1));
    if (fill > 1) {
      out.push_back(0);
      out.insert(out.end(), fill - 2, 0xff);
    }
    const auto from = unit.begin() + static_cast<std::ptrdiff_t>(at);
    out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(size));
    if (is_table)
      out.insert(out.end(), kRoom - size, 0xff);
    at += size;
  }
}

} // namespace

std::vector<std::vector<std::uint8_t>>
TransportSections::take(Bytes payload, bool begins)
{
  std::vector<std::vector<std::uint8_t>> complete;
  if (payload.empty())
    return complete;
  const auto drain = [&] {
    while (held_.size() >= 3 && held_[0] != 0xff) {
      const std::size_t size = 3 + length_at(held_, 1);
      if (held_.size() < size)
        return;
      const auto end = held_.begin() + static_cast<std::ptrdiff_t>(size);
      complete.emplace_back(held_.begin(), end);
      held_.erase(held_.begin(), end);
    }
    if (!held_.empty() && held_[0] == 0xff) // filled up
      held_.clear();
  };
  if (begins) {
    const std::size_t pointer = std::min(std::size_t{ payload[0] }, payload.size() - 1);
    if (is_in_step_) { // what precedes the pointer ends a section
      const Bytes rest = payload.subspan(1, pointer);
      held_.insert(held_.end(), rest.begin(), rest.end());
      drain();
    }
    held_.clear();
    payload = payload.subspan(1 + pointer);
    is_in_step_ = true;
  }
  if (is_in_step_) {
    held_.insert(held_.end(), payload.begin(), payload.end());
    drain();
  }
  return complete;
}

TransportTrack::TransportTrack(std::deque<Cue> cues, std::int64_t zero)
    : cues_(std::move(cues)), zero_(zero)
{
}

void
TransportTrack::scan(Packet packet)
{
  is_aligned_ = is_aligned_ && packet[0] == kSync;
  const int pid = pid_of(packet);
  used_.set(static_cast<std::size_t>(pid));
  if (pid == kPrograms) {
    for (const auto &section : programs_.take(payload_of(packet), begins_unit(packet)))
      for (std::size_t at = 8; section[0] == 0 && at + 4 + kChecksum <= section.size(); at += 4)
        if (section[at] != 0 || section[at + 1] != 0) // 0: no program
          maps_[(section[at + 2] & 0x1f) << 8 | section[at + 3]];
  } else if (const auto map = maps_.find(pid); map != maps_.end()) {
    for (const auto &section : map->second.take(payload_of(packet), begins_unit(packet)))
      if (is_valid_map(section))
        scan_map(pid, section);
  } else if (klv_.contains(pid)) {
    scan_for_track(packet, pid);
  }
}

void
TransportTrack::scan_map(int pid, Bytes section)
{
  const int program = section[3] << 8 | section[4];
  if (program_ >= 0 && (program != program_ || pid != map_pid_))
    return;
  int video = -1;
  for_each_stream(section, [&](std::uint8_t type, int of, Bytes stream) {
    used_.set(static_cast<std::size_t>(of));
    if (is_picture(type) && video < 0)
      video = of;
    // clang 14, of the fuzzers, knows no std::ranges::search.
    if (type == kPrivateData
        && std::search(stream.begin(), stream.end(), kKlvDescriptor.begin(), kKlvDescriptor.end())
               != stream.end())
      klv_.insert(of);
  });
  if (video < 0)
    return;
  program_ = program;
  map_pid_ = pid;
  video_ = video;
  is_full_ = is_full_ || section.size() - 3 + 5 + kKlvDescriptor.size() > kLongestMap;
}

void
TransportTrack::scan_for_track(Packet packet, int pid)
{
  const Bytes payload = payload_of(packet);
  if (begins_unit(packet) && payload.size() > 9
      && payload.size() >= 9U + payload[8] + kKlvKey.size()
      && std::ranges::equal(payload.subspan(9U + payload[8], kKlvKey.size()), kKlvKey))
    old_tracks_.insert(pid);
}

tl::expected<void, std::string>
TransportTrack::check() const
{
  if (!is_aligned_)
    return tl::unexpected(std::string("its packets are not of 188 bytes"));
  if (video_ < 0)
    return tl::unexpected(std::string("no program of it has a picture"));
  if (is_full_ || used_.count() + 64 > used_.size())
    return tl::unexpected(std::string("its program map has no room for another stream"));
  return {};
}

std::vector<std::uint8_t>
TransportTrack::map_with_track(Bytes section) const
{
  const auto streams = static_cast<std::ptrdiff_t>(12 + length_at(section, 10));
  std::vector<std::uint8_t> map = { 0 }; // the section follows at once
  map.insert(map.end(), section.begin(), section.begin() + streams);
  for_each_stream(section, [&](std::uint8_t, int pid, Bytes stream) {
    if (!old_tracks_.contains(pid))
      map.insert(map.end(), stream.begin(), stream.end());
  });
  map.push_back(kPrivateData);
  map.push_back(static_cast<std::uint8_t>(0xe0 | pid_ >> 8));
  map.push_back(static_cast<std::uint8_t>(pid_));
  map.push_back(0xf0);
  map.push_back(static_cast<std::uint8_t>(kKlvDescriptor.size()));
  std::ranges::copy(kKlvDescriptor, std::back_inserter(map)); // GCC 14 warns of insert() here
  const std::size_t length = map.size() - 4 + kChecksum;
  map[2] = static_cast<std::uint8_t>((map[2] & 0xf0) | length >> 8);
  map[3] = static_cast<std::uint8_t>(length);
  const std::uint32_t sum = checksum(Bytes(map).subspan(1));
  for (int shift = 24; shift >= 0; shift -= 8)
    map.push_back(static_cast<std::uint8_t>(sum >> shift));
  return map;
}

/// Up to the film time `until`.
void
TransportTrack::add_cues(std::int64_t until, std::vector<std::uint8_t> &out)
{
  for (; !cues_.empty() && ticks(cues_.front().begin) <= until; cues_.pop_front()) {
    const std::int64_t stamp = (zero_ + ticks(cues_.front().begin)) & (kWrap - 1);
    append_packets(out, pid_, counter_, pes_of(cues_.front(), stamp), false);
  }
}

void
TransportTrack::copy(Packet packet, std::vector<std::uint8_t> &out)
{
  if (!map_) {
    map_.emplace();
    pid_ = video_;
    do
      pid_ = (pid_ + 1) & 0x1fff;
    while (used_.test(static_cast<std::size_t>(pid_)) || pid_ < 0x20 || pid_ > 0x1ffa);
  }
  const int pid = pid_of(packet);
  if (old_tracks_.contains(pid))
    return;
  if (pid == map_pid_ && !payload_of(packet).empty()) {
    for (const auto &section : map_->take(payload_of(packet), begins_unit(packet))) {
      const bool is_ours = is_valid_map(section) && (section[3] << 8 | section[4]) == program_;
      std::vector<std::uint8_t> table = { 0 };
      table.insert(table.end(), section.begin(), section.end());
      append_packets(out, map_pid_, map_counter_, is_ours ? map_with_track(section) : table, true);
      has_map_ = has_map_ || is_ours;
    }
    return;
  }
  if (pid == video_ && begins_unit(packet)) {
    if (const auto stamp = stamp_of(payload_of(packet))) {
      time_ += between(stamp_.value_or(zero_ & (kWrap - 1)), *stamp);
      stamp_ = stamp;
    }
    if (has_map_ && stamp_)
      add_cues(time_ + kLead, out);
  }
  out.insert(out.end(), packet.begin(), packet.end());
}

void
TransportTrack::finish(std::vector<std::uint8_t> &out)
{
  if (!cues_.empty() && pid_ >= 0)
    add_cues(ticks(cues_.back().begin), out);
}

} // namespace tactile
