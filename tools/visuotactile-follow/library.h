// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <optional>
#include <string>

/// A film's track, and where it was found.
struct FoundTrack
{
  std::string path;
  tactile::Track track;
};

/// Where tracks of films are: beside the film, then in the user's folder of tracks, which may be
/// empty.
class Library
{
public:
  explicit Library(std::string folder) : folder_(std::move(folder))
  {
  }

  /// `film` is what a player says: a path, a URI or a title. A file of the right name that is no
  /// track, such as subtitles, is passed over, with a complaint.
  std::optional<FoundTrack> find(const std::string &film, std::string &complaint) const;

  /// What find() looks for, for messages.
  std::string expected(const std::string &film) const;

private:
  std::string folder_;
};

/// What to call a film.
std::string film_name(const std::string &film);
