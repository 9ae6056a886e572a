// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"

#include <optional>
#include <string>

/// The track of a film as a file of text cues in the film's stream time, which is removed with the
/// object.
class StoredTrack
{
public:
  /// Searches beside the film, then in a library (lib/library). None: there is no track;
  /// prints why files were skipped or the library cannot be read. Throws std::runtime_error if the
  /// track is faulty.
  static std::optional<StoredTrack> find(const Film &film, const std::string &tracks);

  StoredTrack(StoredTrack &&other) noexcept;
  StoredTrack &operator=(StoredTrack &&) = delete;
  ~StoredTrack();

  /// The file.
  const std::string &path() const;
  /// Where the track was found.
  const std::string &source() const;

private:
  StoredTrack(std::string path, std::string source);

  std::string path_;
  std::string source_;
};
