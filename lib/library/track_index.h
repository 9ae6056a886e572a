// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace library {

/// The file of an index, in the folder of its tracks.
inline constexpr const char *kIndexName = "tracks.json";

/// A track of a library.
struct IndexEntry
{
  std::string file;                 ///< path below the index; parts are neither hidden nor ".."
  visuotactile::Time duration{ 0 }; ///< end of the track
  std::string film;                 ///< name of the film's file; empty: unknown
  std::string content;              ///< film_content(); empty: unknown
  std::string heard{}; ///< its entry of films by their sound, a path below the index; empty: none
  std::string heard_sum{}; ///< content_sum() of that
};

/// Reads an index: {"tracks": [{"file": "a.vtt", "duration": 12.5, "film": "a.mkv", "content":
/// "0f…", "heard": "a.heard", "heard_sum": "1e…"}]}, at most 8 MiB and 100 000 tracks. The
/// error says what was expected and where.
tl::expected<std::vector<IndexEntry>, std::string> read_index(std::string_view text);

/// Writes an index.
std::string write_index(const std::vector<IndexEntry> &entries);

/// Most bytes of an index.
inline constexpr std::size_t kMostIndex = std::size_t{ 8 } << 20;

} // namespace library
