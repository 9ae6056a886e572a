// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "draft_cache.h"

#include "tracks/track.h"

#include <optional>
#include <set>
#include <string>

/// A film's track, and where it was found.
struct FoundTrack
{
  std::string path;
  tactile::Track track{};
  std::string fault{};                          ///< why it cannot be read; empty: it can
  std::optional<DraftCache::Version> version{}; ///< of a faulty file, before it was read
};

/// Where tracks of films are: beside the film, and in the user's folder of tracks, which may be
/// empty.
class Library
{
public:
  /// By which the end of a film and that of its track may differ.
  static constexpr tactile::Time kSameEnd = std::chrono::seconds(2);

  explicit Library(std::string folder) : folder_(std::move(folder))
  {
  }

  /// Files that are passed over.
  using Skipped = std::set<std::string>;

  // `film` is what a player says: a path, a URI or a title. A track of the right name is found even
  // if it is faulty: it is somebody's own. Subtitles of that name are passed over, with a
  // complaint.

  /// The track beside a film on this computer.
  std::optional<FoundTrack> beside(const std::string &film, const Skipped &skipped,
                                   std::string &complaint) const;
  /// The track of this name in the folder.
  std::optional<FoundTrack> named(const std::string &film, const Skipped &skipped,
                                  std::string &complaint) const;
  /// The track in the folder that ends when the film does, and each word of whose name is in the
  /// film's name. The one with the most words. Faulty ones, which have no end, are complained of.
  std::optional<FoundTrack> alike(const std::string &film, tactile::Time duration,
                                  std::string &complaint) const;

  /// What the first two look for, for messages.
  std::string expected(const std::string &film) const;

private:
  std::string folder_;
};

/// The path of a film on this computer; empty: it has none.
std::string local_path(const std::string &film);

/// What to call a film.
std::string film_name(const std::string &film);
