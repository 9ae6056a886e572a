// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/pipeline.h"
#include "follow/players/player.h"
#include "library/heard.h"
#include "listen/listener.h"

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

/// Reports, like a player, the film of the catalogue whose sound it detects. Sound is neither
/// stored nor sent. Thread of the main context in which it was made; a thread of its own analyzes
/// sound.
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
    /// The catalogue was loaded. It can be used by the next listener.
    std::function<void(std::shared_ptr<const listen::Catalogue>)> loaded;
    /// A file was heard to its end, or cannot be decoded: events.gone follows, for good.
    std::function<void()> ended;
  };

  /// Without a catalogue, one is loaded.
  FilmListener(Settings settings, follow::PlayerEvents events, Calls calls,
               std::shared_ptr<const listen::Catalogue> catalogue);
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

private:
  /// News from the listening thread for the main context's.
  struct News
  {
    std::optional<listen::Heard> heard{};
    std::string film{};
    std::shared_ptr<const tactile::Track> track{};
    std::shared_ptr<const listen::Catalogue> loaded{};
    bool lost = false;
    bool ended = false;
    std::string said{};
    std::string gone{};
  };

  void listen();
  void load();
  bool stops() const
  {
    return g_cancellable_is_cancelled(stop_) != FALSE;
  }
  void hear();
  void expect_source(GstBus *bus) const;
  void add(GstSample *sample, listen::Listener &listener);
  void post(News news);
  void take(const News &news);
  static gboolean on_news(gpointer self);

  const std::string name_;
  const Settings settings_;
  const follow::PlayerEvents events_;
  const Calls calls_;
  std::shared_ptr<const tactile::Track> track_;
  std::string film_;
  GMainContext *context_;
  GCancellable *stop_;
  std::mutex mutex_; ///< guards the next two
  std::vector<News> news_;
  GSource *source_ = nullptr; ///< until it was dispatched
  follow::Time base_{ 0 };    ///< local time of running time 0
  /// Of the listening thread, like the next.
  std::shared_ptr<const listen::Catalogue> catalogue_;
  bool listens_ = false; ///< sound has come
  bool knew_ = false;
  std::size_t film_number_ = 0;
  std::optional<std::size_t> changed_{}; ///< a film whose entry has changed, reported last
  std::shared_ptr<const tactile::Track> known_track_;
  std::thread thread_;
};
