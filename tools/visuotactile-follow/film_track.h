// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_probe.h"
#include "library_search.h"

#include "film/analysis.h"
#include "film/draft_cache.h"
#include "follow/ahead_reader.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

/// Finds the track of a film: the first that exists of a file beside the film, the film's own file,
/// the user's library, an earlier draft, and a draft that is made ahead of the position while the
/// film plays. A faulty track ends the search, and nothing is felt until its file changes or is
/// skipped. Main context's thread, which it does not block.
class FilmTrack
{
public:
  struct Settings
  {
    std::string library; ///< a folder or address of tracks; empty: none
    bool makes_drafts = true;
    AnalysisSettings analysis{};
    std::string cache = DraftCache::usual_folder(); ///< of drafts
  };
  struct Events
  {
    /// Called with the track that is felt from now on; parts of it may become known later.
    std::function<void(std::shared_ptr<const tactile::Draft>)> found;
    std::function<void()> chosen;                  ///< what() is decided
    std::function<void()> probed;                  ///< told_at_start() is known
    std::function<void(const std::string &)> told; ///< message for the user
  };

  FilmTrack(Settings settings, Events events);

  /// Drops the track, and searches for that of `film`, the name that a player reports; empty: none.
  /// `known`: the track, if the player has it.
  void open(const std::string &film, const std::shared_ptr<const tactile::Track> &known = nullptr);

  /// The film's length, as the player reports it, by which a film without a file is found in the
  /// library.
  void take_length(follow::Time length);

  /// Skips the film's faulty track until its file changes, and continues the search. Throws
  /// std::runtime_error if there is none.
  void pass_over();

  /// Continues searching and reading. `position`: of the film.
  void step(follow::Time position, follow::Time now);

  /// Whether a track may still be found, or more of it become known.
  bool is_looking() const
  {
    return probe_ != nullptr || search_ != nullptr || reader_ != nullptr;
  }
  /// Whether step() has something to do at a position that stands.
  bool is_busy(follow::Time position) const
  {
    return probe_ != nullptr || search_ != nullptr
           || (reader_ != nullptr && !reader_->is_far_ahead(position));
  }
  /// The source of the track, such as "a draft"; empty: none.
  const std::string &what() const
  {
    return what_;
  }
  /// The position of a player at the film's 0:00, if it counts from elsewhere; 0: unknown.
  follow::Time told_at_start() const
  {
    return file_.start.told;
  }
  /// The fault of a track that is therefore not felt; empty: none.
  const std::string &fault() const
  {
    return fault_;
  }
  /// End of the known part from a position on; none: all is known.
  std::optional<follow::Time> known_until(follow::Time position) const;

private:
  void look_again(follow::Time now);
  void probe();
  void play(const library::FoundTrack &found);
  void stop_at(const library::FoundTrack &faulty);
  bool has_changed(const std::string &path) const;
  void look_in_file();
  void look_in_library();
  void take(const LibrarySearch::Result &found);
  void choose(std::string what);
  void read(std::unique_ptr<follow::MapSource> source, const std::string &what);
  void make_draft();
  void fail(std::string why);
  void complete();

  const Settings settings_;
  const Events events_;
  const library::Library library_;
  const DraftCache cache_;
  std::optional<library::FileVersion> made_of_; ///< the file of the draft's film
  std::string film_;
  std::string path_; ///< on this computer; empty: elsewhere
  std::string complaint_;
  std::string what_;
  std::string fault_;
  std::string faulty_;                                                  ///< the file
  std::map<std::string, std::optional<library::FileVersion>> versions_; ///< of faulty tracks
  library::Library::Skipped passed_over_;
  follow::Time looked_at_{ 0 }; ///< time of the last look at the faulty file, or the library
  std::filesystem::file_time_type library_changed_{}; ///< at that time, if it is a folder
  std::string told_;                                  ///< why there is no track
  std::unique_ptr<FilmProbe> probe_;
  std::unique_ptr<LibrarySearch> search_;
  AnalysisSettings analysis_; ///< of this film
  FilmProbe::Result file_;    ///< contents of the film's file
  std::unique_ptr<follow::AheadReader> reader_;
  bool is_beside_ = false;  ///< the track is a file beside the film
  bool reads_file_ = false; ///< reader_ reads the track in the film's file
  bool told_too_slow_ = false;
};
