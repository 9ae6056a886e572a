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

/// A place of the heard sound in a film, as a search found it.
struct Place
{
  std::size_t film = 0;
  std::int64_t frame = 0; ///< of the film, at frame 0 of the heard sound; ± 2
  int votes = 0;          ///< hashes that fit it
};

/// Index of the hashes of all films, 4 bytes a hash. It reads the hashes twice, so that they are
/// never stored twice.
class HashIndex
{
public:
  using Read = std::function<std::vector<RankedHash>(std::size_t film, unsigned rank)>;

  /// `films`: their lengths in frames. The index keeps as many hashes of each second as
  /// `most_bytes` allows.
  HashIndex(const std::vector<std::int64_t> &films, const Read &read, std::size_t most_bytes);
  HashIndex() = default;

  struct Found
  {
    std::vector<Place> places{}; ///< the best first
    std::size_t votes = 0;       ///< of all places: the cost of the search
  };
  /// The places with the most votes, at most `most`.
  Found search(std::span<const Hash> heard, std::size_t most) const;

  /// Films that had room; the others are not found.
  std::size_t films() const
  {
    return starts_.size();
  }
  std::size_t bytes() const
  {
    return 4 * (begins_.size() + places_.size());
  }

private:
  static constexpr std::int64_t kUnit = 2;   ///< frames
  static constexpr std::int64_t kGap = 2048; ///< units between films: longer than the heard sound

  std::vector<std::uint32_t> starts_; ///< begins of the films, in units
  std::uint32_t end_ = 0;             ///< of the last film
  std::vector<std::uint32_t> begins_; ///< begins of each value's places in places_
  std::vector<std::uint32_t> places_; ///< units
  std::size_t common_ = 0;            ///< values with more places are skipped
};

/// The films that can be known by their sound. Any thread may search it.
class Catalogue
{
public:
  static constexpr std::size_t kMostBytes = std::size_t{ 900 } << 20;
  static constexpr std::size_t kMostFilms = 20'000;

  Catalogue() = default;
  /// `stops`: whether to give up; films are then missing or not found.
  explicit Catalogue(std::vector<Entry> films, std::size_t most_bytes = kMostBytes,
                     const std::function<bool()> &stops = {});

  const std::vector<Entry> &films() const
  {
    return films_;
  }
  const HashIndex &index() const
  {
    return index_;
  }
  /// Films that cannot be found, for the user.
  const std::vector<std::string> &complaints() const
  {
    return complaints_;
  }

private:
  void remove_copies(const std::function<bool()> &stops);

  std::vector<Entry> films_;
  std::vector<std::string> complaints_;
  HashIndex index_;
};

} // namespace listen
