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
  std::string path; ///< or an address
  tactile::Track track{};
  std::string fault{};                  ///< why it cannot be read; empty: it can
  std::optional<FileVersion> version{}; ///< of a faulty file, before it was read
};

/// Where tracks of films are: beside the film, and in what the user named: a folder, whose index
/// (library/track_index.h) is used where there is one, or such a folder on a web server, which has
/// an index. Any thread may call it.
class Library
{
public:
  /// By which the end of a film and that of its track may differ.
  static constexpr tactile::Time kSameEnd = std::chrono::seconds(2);

  explicit Library(std::string where);

  /// Files that are passed over.
  using Skipped = std::set<std::string>;

  /// Searches take a while: of a server, requests of library::kPatience each.
  bool is_on_server() const;

  // `film` is what a player says: a path, a URI or a title. A track of the right name is found even
  // if it is faulty: it is somebody's own. Subtitles of that name are passed over, with a
  // complaint.

  /// The track beside a film on this computer.
  std::optional<FoundTrack> beside(const std::string &film, const Skipped &skipped,
                                   std::string &complaint) const;

  /// Why there is no track that could be one.
  struct Complaints
  {
    std::string library; ///< of its index, its server or subtitles
    std::string alike;   ///< of a faulty track that may be the film's
  };
  /// The film's track in what the user named. In a folder, of these the first: the one of its name;
  /// the one of its content, by the index; the one that ends when the film does, and each word of
  /// whose name is in the film's name, with the most words. On a server, content comes before the
  /// name, as people name films alike.
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
