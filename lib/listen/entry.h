// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/film_sound.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace listen {

/// The ending of an entry's file.
inline constexpr const char *kEntryEnding = ".heard";
/// Most bytes of an entry: some ten hours of film.
inline constexpr std::size_t kMostEntry = std::size_t{ 32 } << 20;

/// A film in the catalogue, to be written.
struct NewEntry
{
  std::string film{};       ///< name of the film
  std::string track_name{}; ///< name of the track's file, whose ending is its format
  std::string track{};      ///< content of the track's file
  Time duration{ 0 };       ///< of the film
  FilmSound sound{};
};

/// The content of the entry's file. The error says what was expected.
tl::expected<std::string, std::string> write_entry(const NewEntry &entry);

/// A film in the catalogue. Parts of its file are read on demand, and their values bounded.
class Entry
{
public:
  /// Opens a file. Each read opens it again: a catalogue has more files than a process may have
  /// open. The error is one line without the file's name.
  static tl::expected<Entry, std::string> open(const std::string &path);
  /// Reads the content of a file.
  static tl::expected<Entry, std::string> of(std::string bytes);

  const std::string &film() const
  {
    return film_;
  }
  const std::string &track_name() const
  {
    return track_name_;
  }
  Time duration() const
  {
    return duration_;
  }
  /// Steps of the reference.
  std::size_t steps() const
  {
    return steps_;
  }
  /// Content of the track's file; none: the entry's file has changed.
  std::optional<std::string> track() const;
  /// Hashes up to a rank, of each second no more than kOfRank of it.
  std::vector<RankedHash> hashes(unsigned rank) const;
  /// Steps of the reference from step `from` on, 0 outside of the film; none: the entry's file has
  /// changed.
  std::optional<std::vector<std::uint8_t>> reference(std::int64_t from, std::size_t steps) const;

private:
  /// A file's content that does not change.
  struct Version
  {
    std::uint64_t device = 0;
    std::uint64_t number = 0; ///< of the inode
    std::int64_t size = 0;
    std::int64_t changed = 0; ///< ns
    bool operator==(const Version &) const = default;
  };

  Entry() = default;
  static Version version(int descriptor);
  tl::expected<void, std::string> read_head(std::size_t size);
  std::optional<std::string> read(std::size_t from, std::size_t count) const;

  std::string path_; ///< empty: bytes_ has the content
  std::string bytes_;
  Version version_{};
  std::string film_;
  std::string track_name_;
  Time duration_{ 0 };
  std::size_t track_at_ = 0;
  std::size_t track_size_ = 0;
  std::size_t hashes_at_ = 0;
  std::size_t hash_count_ = 0;
  std::size_t reference_at_ = 0;
  std::size_t steps_ = 0;
};

} // namespace listen
