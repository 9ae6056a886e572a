// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "files/regular_file.h"
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
/// Bytes of the largest that is read: some ten hours of film.
inline constexpr std::size_t kMostEntry = std::size_t{ 32 } << 20;

/// A film in the catalogue, to be written.
struct NewEntry
{
  std::string film{};       ///< its name
  std::string track_name{}; ///< name of the track's file, whose ending is its format
  std::string track{};      ///< its content
  Time duration{ 0 };       ///< of the film
  FilmSound sound{};
};

/// The file's content. The error says what was expected.
tl::expected<std::string, std::string> write_entry(const NewEntry &entry);

/// A film in the catalogue. Parts are read when they are needed; what a part of the file says is
/// believed within bounds alone.
class Entry
{
public:
  /// A file, which stays open. The error is one line, without its name.
  static tl::expected<Entry, std::string> open(const std::string &path);
  /// A file's content.
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
  /// None where the file has changed since.
  std::optional<std::string> track() const;
  /// Up to a rank.
  std::vector<RankedHash> hashes(unsigned rank) const;
  /// Steps from one on. Outside of the film they are 0. None where the file has changed since.
  std::optional<std::vector<std::uint8_t>> reference(std::int64_t from, std::size_t steps) const;

private:
  Entry() = default;
  tl::expected<void, std::string> read_head(std::size_t size);
  std::optional<std::string> read(std::size_t from, std::size_t count) const;

  files::File file_; ///< or
  std::string bytes_;
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
