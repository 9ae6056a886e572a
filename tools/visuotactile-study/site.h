// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_play.h"

#include "study/folder.h"
#include "study/page.h"
#include "web/events.h"
#include "web/site.h"

#include <memory>
#include <string>
#include <string_view>

/// Serves the pages of a study and runs the session. Main context's thread.
class StudySite : public Site
{
public:
  struct Settings
  {
    std::string page;         ///< folder
    std::string experimenter; ///< begins the paths of the experimenter's page, such as "KEY/"
    bool window = false;
    std::optional<Monitor> screen; ///< for films in a window
    study::Settings defaults;      ///< of the user, below the study's
    study::Settings overrides;     ///< for all sessions
  };
  StudySite(study::Folder &folder, Settings settings);
  ~StudySite() override;

  std::string methods(const std::string &path) const override;
  void answer(SoupServerMessage *message, const std::string &path) override;

  /// Ends the film that plays.
  void stop_film(const std::string &why);

private:
  using Handler = void (StudySite::*)(SoupServerMessage *, std::string_view body);
  struct Route
  {
    bool of_experimenter;
    const char *path;
    const char *methods;
    Handler handler;
  };
  static const Route kRoutes[];
  /// The route of a path, whose role's beginning is cut off; null: a file of the page.
  const Route *find(const std::string &path, bool &of_experimenter, std::string &rest) const;

  void state(SoupServerMessage *message, std::string_view body);
  void overview(SoupServerMessage *message, std::string_view body);
  void events(SoupServerMessage *message, std::string_view body);
  void all_events(SoupServerMessage *message, std::string_view body);
  void step(SoupServerMessage *message, std::string_view body);
  void play(SoupServerMessage *message, std::string_view body);
  void play_film(SoupServerMessage *message, std::string_view body);
  void act(SoupServerMessage *message, std::string_view body);

  study::Phase phase() const;
  /// Writes an event; answers with an error, and returns false, if that fails.
  bool add(SoupServerMessage *message, const study::Event &event);
  void played(const study::Play &result);
  std::string state_json() const;
  std::string chair_json() const;
  std::string overview_json() const;
  void tell();

  study::Folder &folder_;
  Settings settings_;
  study::Participant *active_ = nullptr;
  std::unique_ptr<FilmPlay> play_;
  std::unique_ptr<FilmPlay> over_; ///< the play that ended last
  std::string step_played_;        ///< the step of the last play
  Events events_; ///< of the participant's page: no condition, nothing of the chair
  Events of_experimenter_;
  guint tick_;
};
