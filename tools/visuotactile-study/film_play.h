// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_window.h"

#include "film/pipeline.h"
#include "study/participant.h"

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// The levels of the chair.
struct ChairLevels
{
  unsigned rows = 0;
  unsigned columns = 0;
  std::vector<float> levels; ///< 0 to 1
  double position = 0;       ///< s of the film
};

/// Film and chair of a session; their sinks are in sync. Main context's thread.
class FilmPlay
{
public:
  struct Order
  {
    std::string film; ///< path
    study::Settings settings;
    std::string trace; ///< path
    bool window = false;
    std::optional<Monitor> screen; ///< which the window covers; none: the window is the film's
  };
  /// Begins to play. Throws std::runtime_error if that fails. `ended` is called once, from the main
  /// loop, when motors are at zero and the trace is complete.
  FilmPlay(const Order &order, std::function<void(const study::Play &result)> ended);
  ~FilmPlay();
  FilmPlay(const FilmPlay &) = delete;
  FilmPlay &operator=(const FilmPlay &) = delete;

  /// Ends it early; `ended` is called before it returns.
  void stop(const std::string &why);

  ChairLevels levels() const;

private:
  bool is_picture(GstObject *object) const;
  gboolean on_message(GstMessage *message);
  void on_map(GstPad *pad, GstBuffer *map);
  void end(study::Play::Outcome outcome, const std::string &text);
  void count_frames();

  std::function<void(const study::Play &)> ended_;
  std::string trace_;
  bool is_audio_;
  float intensity_;
  study::Play result_;
  std::string told_; ///< the last message of the chair
  guint watch_ = 0;
  mutable std::mutex mutex_;
  ChairLevels levels_;                 ///< a streaming thread writes them
  std::unique_ptr<FilmWindow> window_; ///< longer than what shows pictures in it
  Pipeline noise_;
  Pipeline pipeline_;
  Owned<GstElement> chair_;
};

/// Throws std::runtime_error if a film of these settings cannot be played at all.
void expect_playable(const std::string &film, const study::Settings &settings);

/// The user's settings (visuotactile-settings) that a session may have. Prints a line for each
/// entry that cannot be read.
study::Settings user_defaults(const char *program);

/// Adds what the settings of a session leave open. What belongs to the user's driver is left out if
/// the session has another.
void add_defaults(study::Settings &settings, const study::Settings &defaults);

/// Whether a window can show films here.
bool can_show_films();
