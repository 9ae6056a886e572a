// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "library/film_content.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Files made of films, in a folder of the user's cache. A film is identified by the size of its
/// file and parts of the content, not by path or name.
class FilmCache
{
public:
  /// Beyond this, the least used files are deleted.
  static constexpr std::uintmax_t kMostBytes = std::uintmax_t{ 256 } << 20;

  /// $XDG_CACHE_HOME/visuotactile/`name`
  static std::string usual_folder(const char *name);

  /// `ending`: of the files' names, such as ".vtt".
  FilmCache(std::string folder, std::string ending, std::uintmax_t most_bytes = kMostBytes);

  /// Path of the film's file, which may not exist; empty: the film cannot be read. `made_with`: all
  /// that the file depends on but the film, such as a version.
  std::string path(const std::string &film, const std::string &made_with) const;

  /// The path if the file exists, which is then in use; else empty.
  std::string find(const std::string &film, const std::string &made_with) const;

  /// Throws std::runtime_error with the path, also if the film's file has changed since `made_of`.
  void keep(std::string_view bytes, const std::string &film,
            const std::optional<library::FileVersion> &made_of, const std::string &made_with) const;

private:
  void remove_old() const;

  std::string folder_;
  std::string ending_;
  std::uintmax_t most_bytes_;
};
