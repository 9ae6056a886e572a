// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace tactile {

/// Collects the sections (tables) of one PID of an MPEG transport stream.
class TransportSections
{
public:
  /// Takes a packet's payload, which `begins` one or not; returns the sections that are complete.
  std::vector<std::vector<std::uint8_t>> take(std::span<const std::uint8_t> payload, bool begins);

private:
  std::vector<std::uint8_t> held_;
  bool is_in_step_ = false;
};

/// Adds a track to an MPEG transport stream (ISO/IEC 13818-1) as KLV with times. Nothing else is
/// touched: all other packets stay as they are and in their order, but for the program map, which
/// names the new stream, and the packets of older tracks, which are left out. FFmpeg 5.1 and newer
/// write KLV without times.
///
/// First scan() takes all packets, then copy() takes them again.
class TransportTrack
{
public:
  static constexpr std::size_t kPacket = 188;
  using Packet = std::span<const std::uint8_t, kPacket>;

  /// `zero`: the time stamp of the film's time 0, in units of 1 / 90 000 s.
  TransportTrack(std::deque<Cue> cues, std::int64_t zero);

  void scan(Packet packet);

  /// After scan(): whether there is a program with a picture, to which the track can be added.
  tl::expected<void, std::string> check() const;

  /// After scan(): the PIDs of older tracks.
  const std::set<int> &old_tracks() const
  {
    return old_tracks_;
  }

  /// Appends to `out` what the packet becomes: itself, cues before it, or nothing.
  void copy(Packet packet, std::vector<std::uint8_t> &out);

  /// After the last packet: appends what is left.
  void finish(std::vector<std::uint8_t> &out);

private:
  void scan_map(int pid, std::span<const std::uint8_t> section);
  void scan_for_track(Packet packet, int pid);
  std::vector<std::uint8_t> map_with_track(std::span<const std::uint8_t> section) const;
  void add_cues(std::int64_t until, std::vector<std::uint8_t> &out);

  std::deque<Cue> cues_; ///< that are still to come
  const std::int64_t zero_;

  std::bitset<8192> used_; ///< PIDs
  TransportSections programs_;
  std::map<int, TransportSections> maps_; ///< by PID
  std::set<int> klv_;                     ///< PIDs of KLV
  std::set<int> old_tracks_;              ///< of these, tracks
  bool is_aligned_ = true;                ///< each packet begins with the sync byte
  bool is_full_ = false;                  ///< the program map has no room
  int program_ = -1;
  int map_pid_ = -1;
  int video_ = -1;
  int pid_ = -1; ///< of the track

  std::optional<TransportSections> map_; ///< what is copied
  bool has_map_ = false;                 ///< the map with the track is written
  std::uint8_t map_counter_ = 0;
  std::uint8_t counter_ = 0;
  std::optional<std::int64_t> stamp_; ///< of the last frame
  std::int64_t time_ = 0;             ///< its film time
};

} // namespace tactile
