// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/entry.h"
#include "listen/hashes.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace listen {

/// Where a film may be.
struct Place
{
  std::size_t film = 0;
  std::int64_t frame = 0; ///< of the film, at frame 0 of what is heard; ± 2
  int votes = 0;          ///< hashes that say so
};

/// Hashes of all films → where each of them is: 4 bytes a hash. The films' hashes are read
/// twice, so that they are never held twice.
class HashIndex
{
public:
  using Read = std::function<std::vector<RankedHash>(std::size_t film, unsigned rank)>;

  /// The films, by their frames. Of each second as many hashes are kept as `most_bytes` allows.
  HashIndex(const std::vector<std::int64_t> &films, const Read &read, std::size_t most_bytes);
  HashIndex() = default;

  /// The places with the most votes, at most `most`, the best first.
  std::vector<Place> search(std::span<const Hash> heard, std::size_t most) const;

  std::size_t bytes() const
  {
    return 4 * (begins_.size() + places_.size());
  }

private:
  static constexpr std::int64_t kUnit = 2;   ///< frames
  static constexpr std::int64_t kGap = 2048; ///< units between films: more than is heard at once

  std::vector<std::uint32_t> starts_; ///< units, of the films
  std::vector<std::uint32_t> begins_; ///< of each value's places
  std::vector<std::uint32_t> places_; ///< units
  std::size_t common_ = 0;            ///< values with more places say nothing
};

/// The films that can be known by their sound. Any thread may search it.
class Catalogue
{
public:
  static constexpr std::size_t kMostBytes = std::size_t{ 900 } << 20;
  static constexpr std::size_t kMostFilms = 20'000;

  Catalogue() = default;
  explicit Catalogue(std::vector<Entry> films, std::size_t most_bytes = kMostBytes);

  const std::vector<Entry> &films() const
  {
    return films_;
  }
  const HashIndex &index() const
  {
    return index_;
  }

private:
  std::vector<Entry> films_;
  HashIndex index_;
};

} // namespace listen
