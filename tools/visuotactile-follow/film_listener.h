// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/pipeline.h"
#include "follow/players/player.h"
#include "library/heard.h"
#include "listen/listener.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

/// The films that a listener knows, and the time of the last change of their folder.
struct KnownFilms
{
  std::shared_ptr<const listen::Catalogue> catalogue;
  std::filesystem::file_time_type changed;
};

/// Reports, like a player, the film of the catalogue whose sound it detects. Sound is neither
/// stored nor sent. Thread of the main context in which it was made; a thread of its own analyzes
/// sound. Its destructor does not wait for this thread, which a sound server may hold.
class FilmListener : public follow::Player
{
public:
  struct Settings
  {
    /// Empty: the microphone; "monitor": the sound that this computer plays; a path or URI of a
    /// sound, which is played silently; otherwise the name of a source of PulseAudio or PipeWire.
    std::string source{};
    std::string library{};     ///< folder or address of the catalogue
    follow::Time latency{ 0 }; ///< from a sound at the screen to its time stamp here
  };

  struct Calls
  {
    std::function<void(const std::string &)> said;
    /// The films were loaded. They can be used by the next listener.
    std::function<void(const KnownFilms &)> loaded;
    /// A file was heard to its end, or cannot be decoded: events.gone follows, for good.
    std::function<void()> ended;
  };

  /// Without a catalogue, one is loaded. When entries are added to the library's folder while no
  /// film is heard, it is loaded again.
  FilmListener(Settings settings, follow::PlayerEvents events, Calls calls, KnownFilms films);
  ~FilmListener() override;
  FilmListener(const FilmListener &) = delete;
  FilmListener &operator=(const FilmListener &) = delete;

  const std::string &name() const override
  {
    return name_;
  }
  follow::Habits habits() const override
  {
    return kHabits;
  }
  follow::Source source() const override
  {
    return follow::Source::listener;
  }
  bool is_announced() const override
  {
    return false;
  }
  std::shared_ptr<const tactile::Track> track() const override
  {
    return track_;
  }

  /// Largest error of a position in a room.
  static constexpr follow::Time kError = std::chrono::milliseconds(10);
  static constexpr follow::Habits kHabits{ .coarseness = 2 * kError };
  /// The report, at local time `now`, of a film that was heard. Habits round positions down, so it
  /// is early by kError.
  static follow::Report report(const listen::Heard &heard, std::string film, follow::Time latency,
                               follow::Time now);

  /// Its name for messages: "the microphone".
  static std::string source_name(const std::string &source);

  /// Whether the threads of all listeners that are no more have ended, after waiting at most so
  /// long.
  static bool have_ended(std::chrono::milliseconds within);

private:
  /// News from the listening thread for the main context's.
  struct News
  {
    std::optional<listen::Heard> heard{};
    std::string film{};
    std::shared_ptr<const tactile::Track> track{};
    std::optional<KnownFilms> loaded{};
    bool lost = false;
    bool ended = false;
    std::string said{};
    std::string gone{};
  };
  class Ear;

  void take(const News &news);

  const std::string name_;
  const follow::Time latency_;
  const follow::PlayerEvents events_;
  const Calls calls_;
  std::shared_ptr<const tactile::Track> track_;
  std::string film_;
  std::shared_ptr<Ear> ear_;
};
