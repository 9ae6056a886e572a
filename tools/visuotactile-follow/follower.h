// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair.h"
#include "film_listener.h"
#include "film_track.h"
#include "follow_service.h"
#include "player_choice.h"
#include "player_timing.h"
#include "retry.h"
#include "session_watch.h"

#include "follow/players/kodi_player.h"
#include "follow/players/mpris_bus.h"
#include "follow/players/player.h"
#include "follow/position_estimator.h"
#include "follow/track_follower.h"

#include <map>
#include <memory>
#include <optional>
#include <string>

/// "plays"
const char *word(follow::Doing doing);

struct FollowSettings
{
  std::string mpv_socket;                          ///< empty: none
  bool insists_on_mpv = false;                     ///< prints a message while mpv is missing
  std::string kodi;                                ///< HOST[:PORT]; empty: none
  bool insists_on_kodi = false;                    ///< prints a message while Kodi is missing
  std::optional<follow::ServerKind> server{};      ///< only this media server
  bool uses_servers = true;                        ///< those of the user's settings
  std::optional<FilmListener::Settings> listens{}; ///< none: it does not
  bool uses_bus = true;
  std::string mpris; ///< only the player of that name; empty: any
  FilmTrack::Settings track{};
  std::string sink;                       ///< as on a launch line
  std::optional<SyncTo> sync_to{};        ///< none: as is set for each kind of player
  std::optional<double> screen_latency{}; ///< ms, of all players; none: as set for each kind
  std::optional<double> sound_latency{};  ///< ms; none: as set or measured for each kind
  bool once = false;                      ///< ends when a player is gone
  bool quiet = false;
};

/// Follows the player that PlayerChoice chooses. Main context's thread.
class Follower
{
public:
  /// Throws std::runtime_error.
  explicit Follower(const FollowSettings &settings);
  ~Follower();
  Follower(const Follower &) = delete;
  Follower &operator=(const Follower &) = delete;

  /// Until SIGINT or SIGTERM. Throws std::runtime_error with what fails.
  void run();

  /// Prints the players that are there.
  void list();

private:
  struct Followed
  {
    std::unique_ptr<follow::Player> player;
    follow::PositionEstimator estimator{};
    follow::Report last{};   ///< newest of its kind
    follow::Time found{ 0 }; ///< its newest report of a leap, or of a film found
    bool was_paused = false; ///< paused, and has not continued yet
    bool has_played = false; ///< since it appeared
    bool is_gone = false;
    std::string told{}; ///< its fault or remark, as printed last
  };

  void look_around();
  void look_for_players();
  void look_for_mpv();
  void look_for_sound();
  void look_for_servers();
  void found_kodi(GSocketConnection *connection);
  void missed_kodi(const std::string &why, bool is_other);
  void appeared(const std::string &bus_name);
  follow::PlayerEvents events_of(const std::string &key);
  void add(const std::string &key, std::unique_ptr<follow::Player> player);
  void reported(const std::string &key, const follow::Report &report);
  void gone(const std::string &key, const std::string &why);
  void choose();
  void change_film();
  void change_track(std::shared_ptr<const tactile::Draft> track);
  void open_chair();
  void chair_failed(const std::string &text);
  void rest(bool rests, const std::string &why);
  void update();
  void feel(const std::optional<follow::PositionEstimator::Estimate> &estimate, follow::Time now);
  std::optional<follow::PositionEstimator::Estimate> film_position(follow::Time now) const;
  double nudge(double by);
  double nudge_film(double by);
  gboolean nudged(double by);
  void set_delay();
  std::string no_position() const;
  void tell_of_player();
  SyncTo sync_to() const;
  double latency() const;
  FollowStatus status() const;
  void tell(const std::string &text);
  void fail(const std::string &text);
  void wake();
  bool any_leaves() const;
  bool is_busy() const;
  void step();

  const FollowSettings settings_;
  GMainLoop *loop_;
  GDBusConnection *bus_ = nullptr;
  std::unique_ptr<follow::MprisBus> names_;
  std::unique_ptr<follow::KodiSearch> kodi_;
  std::unique_ptr<FollowService> service_;
  std::unique_ptr<SessionWatch> session_;
  PlayerTiming timing_;
  std::map<std::string, Followed> players_;
  PlayerChoice choice_;
  Followed *current_ = nullptr;
  std::string film_;           ///< whose track is played or searched for
  follow::Time position_{ 0 }; ///< last known one of the film
  FilmTrack film_track_;
  std::shared_ptr<const tactile::Draft> track_; ///< what is felt
  Chair chair_;
  follow::TrackFollower cues_;
  bool rests_ = false; ///< nobody is in the chair
  bool opens_again_ = false;
  follow::Time patient_until_{ 0 };
  std::string failure_;
  std::vector<guint> sources_;
  GSource *ticks_;                    ///< has no ready time while none is needed
  follow::Time stepped_{ 0 };         ///< local time of the last tick
  follow::Time due_{ 0 };             ///< of the next cues
  std::vector<std::string> returned_; ///< names of players that came back before they were removed
  bool told_of_mpv_ = false;
  bool told_of_kodi_ = false;
  bool looks_for_kodi_ = true;
  bool told_of_token_ = false;
  bool listens_; ///< until a file has ended
  /// Of players that are tried again after they failed: the listener, servers.
  struct Attempts
  {
    Retry retry{};
    std::string failure{}; ///< the last one, as the user knows it
  };
  std::map<std::string, Attempts> attempts_;
  KnownFilms known_films_; ///< by their sound
  bool lists_ = false;     ///< the players, and follows none
};
