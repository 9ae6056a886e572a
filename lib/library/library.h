// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "library/film_content.h"
#include "tracks/track.h"

#include <gio/gio.h>

#include <optional>
#include <set>
#include <string>

namespace library {

/// A film's track, and where it was found.
struct FoundTrack
{
  std::string path; ///< path or address of the track
  tactile::Track track{};
  std::string fault{};                  ///< why it cannot be read; empty: it can
  std::optional<FileVersion> version{}; ///< of a faulty file, before it was read
};

/// Finds tracks: beside the film, and in the place that the user named, which is a folder with or
/// without an index (library/track_index.h), or such a folder with an index on a web server. Any
/// thread may call it.
class Library
{
public:
  /// Largest difference between the ends of a film and its track.
  static constexpr tactile::Time kSameEnd = std::chrono::seconds(2);

  explicit Library(std::string where);

  /// Files to skip.
  using Skipped = std::set<std::string>;

  /// Whether the library is on a server: each request of a search then waits up to
  /// library::kPatience.
  bool is_on_server() const;

  // `film` is the name that a player reports: a path, a URI or a title. A faulty track of the right
  // name is found, too, because a user put it there. Subtitles of that name are skipped, with a
  // complaint.

  /// The track beside a film on this computer.
  std::optional<FoundTrack> beside(const std::string &film, const Skipped &skipped,
                                   std::string &complaint) const;

  /// Reasons for which files are not used.
  struct Complaints
  {
    std::string library; ///< of its index, its server or subtitles
    std::string alike;   ///< of a faulty track that may be the film's
  };
  /// The film's track in the place that the user named. In a folder, the first that exists of: the
  /// track of the film's name; of its content, by the index; of its end, with a name whose words
  /// are all in the film's name, and as many as possible. On a server, content comes before the
  /// name, because different films have one name.
  std::optional<FoundTrack> stored(const std::string &film,
                                   const std::optional<tactile::Time> &duration,
                                   const Skipped &skipped, Complaints &complaints,
                                   GCancellable *stop = nullptr) const;

  /// Names of the files that a search by name looks for, for messages.
  std::string expected(const std::string &film) const;

private:
  std::optional<FoundTrack> alike(const std::string &film, tactile::Time duration,
                                  std::string &complaint) const;
  std::optional<FoundTrack> on_server(const std::string &film,
                                      const std::optional<tactile::Time> &duration,
                                      Complaints &complaints, GCancellable *stop) const;

  std::string where_; ///< a folder or an address; empty: none
};

/// The path of a film on this computer; empty: it has none.
std::string local_path(const std::string &film);

/// The name of a track's file without its ending; empty: it has no ending of a film's track.
std::string track_stem(const std::string &name);

/// The name to call a film by.
std::string film_name(const std::string &film);

} // namespace library
