// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follower.h"

#include "film/command_line.h"
#include "follow/players/kodi_player.h"
#include "follow/players/mpris_player.h"
#include "follow/players/mpv_player.h"
#include "translation.h"

#include <glib-unix.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <utility>

using follow::Doing;
using follow::local_time;
using follow::Report;

namespace {

constexpr follow::Time kTick = std::chrono::milliseconds(20);
constexpr follow::Time kSlowTick = std::chrono::milliseconds(200); ///< only cues may be due
constexpr guint kLookEvery = 1500;                                 ///< ms
constexpr guint kListing = 1000;                                   ///< ms until all have answered
constexpr std::size_t kMostPlayers = 16;
constexpr const char *kMpv = "mpv";
constexpr const char *kKodi = "kodi";
constexpr const char *kSound = "listen";
constexpr std::chrono::milliseconds kGoodbye(1000);          ///< for the listening thread
constexpr double kNudge = 10;                                ///< ms, by a signal
constexpr follow::Time kPatience = std::chrono::seconds(30); ///< after a sleep

} // namespace

Follower::Follower(const FollowSettings &settings)
    : settings_(settings), loop_(g_main_loop_new(nullptr, FALSE)),
      timing_(PlayerTiming::usual_path()),
      film_track_(settings.track, { .found =
                                        [this](std::shared_ptr<const tactile::Draft> track) {
                                          change_track(std::move(track));
                                        },
                                    .chosen =
                                        [this] {
                                          if (current_ != nullptr)
                                            tell(current_->player->name() + " plays '"
                                                 + library::film_name(film_) + "' with "
                                                 + film_track_.what());
                                        },
                                    .probed = [this] { cues_.change_player(); },
                                    .told =
                                        [this](const std::string &text) {
                                          tell(text);
                                        } }),
      chair_(settings.sink, { .told = [this](const std::string &text) { tell(text); },
                              .failed =
                                  [this](const std::string &text) {
                                    chair_failed(text);
                                  } }),
      listens_(settings_.listens.has_value())
{
  if (settings_.server && !timing_.server(*settings_.server))
    throw std::runtime_error(in_text("expected server= and token= in the group [{}] of '{}'",
                                     name_of(*settings_.server), PlayerTiming::usual_path()));
  g_autoptr(GError) error = nullptr;
  bus_ = g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, &error);
  if (bus_ == nullptr && !settings_.mpris.empty()) {
    g_main_loop_unref(loop_);
    throw std::runtime_error(in_text("cannot reach the session bus: {}", error->message));
  }
  static GSourceFuncs ticks{ .dispatch
                             = +[](GSource *, GSourceFunc step, gpointer self) -> gboolean {
    return step(self);
  } };
  ticks_ = g_source_new(&ticks, sizeof(GSource));
  g_source_set_ready_time(ticks_, -1);
  g_source_set_callback(
      ticks_,
      +[](gpointer data) -> gboolean {
        auto *self = static_cast<Follower *>(data);
        g_source_set_ready_time(self->ticks_, -1);
        self->step();
        if (self->is_busy())
          self->wake();
        return G_SOURCE_CONTINUE;
      },
      this, nullptr);
  g_source_attach(ticks_, nullptr);
  if (bus_ != nullptr)
    g_dbus_connection_set_exit_on_close(bus_, FALSE);
  if (bus_ != nullptr && settings_.uses_bus) {
    g_signal_connect_swapped(
        bus_, "closed", G_CALLBACK(+[](Follower *self) { self->fail("the session bus is gone"); }),
        this);
    names_ = std::make_unique<follow::MprisBus>(
        bus_, settings_.mpris,
        follow::MprisBus::Events{ .appeared = [this](const std::string &name) { appeared(name); },
                                  .vanished =
                                      [this](const std::string &name) {
                                        gone(name, "it has left the bus");
                                      } });
  }
  if (!settings_.kodi.empty())
    kodi_ = std::make_unique<follow::KodiSearch>(
        settings_.kodi,
        follow::KodiSearch::Events{ .found = [this](auto *connection) { found_kodi(connection); },
                                    .missed =
                                        [this](const std::string &why, bool is_other) {
                                          missed_kodi(why, is_other);
                                        } });
  look_for_players();
  sources_.push_back(g_timeout_add(
      kLookEvery,
      +[](gpointer self) -> gboolean {
        static_cast<Follower *>(self)->look_around();
        return G_SOURCE_CONTINUE;
      },
      this));
  for (const int number : { SIGINT, SIGTERM, SIGHUP })
    sources_.push_back(g_unix_signal_add(
        number,
        +[](gpointer self) -> gboolean {
          g_main_loop_quit(static_cast<Follower *>(self)->loop_);
          return G_SOURCE_CONTINUE;
        },
        this));
  sources_.push_back(g_unix_signal_add(
      SIGUSR1, +[](gpointer self) { return static_cast<Follower *>(self)->nudged(kNudge); }, this));
  sources_.push_back(g_unix_signal_add(
      SIGUSR2, +[](gpointer self) { return static_cast<Follower *>(self)->nudged(-kNudge); },
      this));
}

Follower::~Follower()
{
  chair_.close(); // before anything else
  for (const guint source : sources_)
    g_source_remove(source);
  g_source_destroy(ticks_);
  g_source_unref(ticks_);
  players_.clear();
  FilmListener::have_ended(kGoodbye);
  names_.reset();
  kodi_.reset();
  service_.reset();
  session_.reset();
  if (bus_ != nullptr) {
    g_signal_handlers_disconnect_by_data(bus_, this);
    g_object_unref(bus_);
  }
  g_main_loop_unref(loop_);
}

void
Follower::run()
{
  session_ = std::make_unique<SessionWatch>(
      bus_, "visuotactile-follow",
      [this](bool rests, const std::string &why) { rest(rests, why); });
  if (bus_ != nullptr)
    service_ = std::make_unique<FollowService>(
        bus_, FollowService::Calls{ .status = [this] { return status(); },
                                    .nudge = [this](double by) { return nudge(by); },
                                    .nudge_film = [this](double by) { return nudge_film(by); },
                                    .pass_over =
                                        [this] {
                                          film_track_.pass_over();
                                          wake();
                                        },
                                    .told =
                                        [this](const std::string &text) {
                                          tell(text);
                                        } });
  if (failure_.empty())
    g_main_loop_run(loop_);
  chair_.close();
  if (!failure_.empty())
    throw std::runtime_error(failure_);
}

void
Follower::list()
{
  lists_ = true;
  sources_.push_back(g_timeout_add(
      kListing,
      +[](gpointer self) -> gboolean {
        g_main_loop_quit(static_cast<Follower *>(self)->loop_);
        return G_SOURCE_CONTINUE;
      },
      this));
  g_main_loop_run(loop_);
  const bool is_any = std::ranges::any_of(players_, [](const auto &one) {
    return one.second.player->is_announced() || one.second.last.received > follow::Time(0);
  });
  if (!is_any)
    std::puts("No player is there.");
  for (const auto &[key, followed] : players_) {
    if (!followed.player->is_announced() && followed.last.received == follow::Time(0))
      continue; // it may not exist
    const auto estimate = followed.estimator.at(local_time());
    std::printf("%s: %s", followed.player->name().c_str(), word(followed.last.doing));
    if (!followed.last.film.empty())
      std::printf(" '%s'", library::film_name(followed.last.film).c_str());
    if (estimate)
      std::printf(" at %.1f s", static_cast<double>(estimate->position.count()) / 1e9);
    std::printf("\n");
  }
}

void
Follower::look_around()
{
  look_for_players();
  if (std::exchange(opens_again_, false)) {
    chair_.close();
    open_chair();
  }
  if (g_source_get_ready_time(ticks_) < 0)
    step();
  if (is_busy())
    wake();
}

void
Follower::look_for_players()
{
  look_for_mpv();
  if (kodi_ && looks_for_kodi_ && !players_.contains(kKodi))
    kodi_->look();
  look_for_servers();
  look_for_sound();
}

void
Follower::look_for_servers()
{
  if (!settings_.uses_servers || players_.size() >= kMostPlayers)
    return;
  for (const follow::ServerKind kind : follow::kServerKinds) {
    const std::string key = name_of(kind);
    if ((settings_.server && *settings_.server != kind) || players_.contains(key))
      continue;
    if (const auto server = timing_.server(kind);
        server && attempts_[key].retry.is_due(local_time())) {
      if (timing_.is_public() && !std::exchange(told_of_token_, true))
        tell("others can read the token in '" + PlayerTiming::usual_path() + "': chmod 600 it");
      add(key, std::make_unique<ServerPlayer>(*server, events_of(key),
                                              [this](const std::string &text) { tell(text); }));
    }
  }
}

/// Does nothing while nobody is in the chair.
void
Follower::look_for_sound()
{
  if (!listens_ || rests_ || lists_ || players_.contains(kSound) || players_.size() >= kMostPlayers
      || !attempts_[kSound].retry.is_due(local_time())
      || !FilmListener::have_ended(std::chrono::milliseconds(0))) // the last one may hang
    return;
  FilmListener::Calls calls{ .said = [this](const std::string &text) { tell(text); },
                             .loaded = [this](const KnownFilms &films) { known_films_ = films; },
                             .ended =
                                 [this] {
                                   listens_ = false;
                                   known_films_ = {};
                                 } };
  add(kSound, std::make_unique<FilmListener>(*settings_.listens, events_of(kSound),
                                             std::move(calls), known_films_));
}

void
Follower::found_kodi(GSocketConnection *connection)
{
  add(kKodi, follow::open_kodi(connection, events_of(kKodi)));
}

void
Follower::missed_kodi(const std::string &why, bool is_other)
{
  if (!settings_.insists_on_kodi) {
    looks_for_kodi_ = !is_other; // who is left alone
    return;
  }
  if (!std::exchange(told_of_kodi_, true))
    tell("cannot reach Kodi at '" + settings_.kodi + "': " + why
         + "; is 'Allow remote control' switched on in its settings? It is waited for.");
}

void
Follower::look_for_mpv()
{
  if (settings_.mpv_socket.empty() || players_.contains(kMpv) || players_.size() >= kMostPlayers)
    return;
  auto player = follow::open_mpv(settings_.mpv_socket, events_of(kMpv));
  if (player)
    add(kMpv, *std::move(player));
  else if (settings_.insists_on_mpv && !std::exchange(told_of_mpv_, true))
    tell(player.error() + " It is waited for.");
}

void
Follower::appeared(const std::string &bus_name)
{
  const auto known = players_.find(bus_name);
  if (known != players_.end() && known->second.is_gone)
    returned_.push_back(bus_name); // ticks run
  else if (known == players_.end())
    add(bus_name, follow::open_mpris(bus_, bus_name, events_of(bus_name)));
}

follow::PlayerEvents
Follower::events_of(const std::string &key)
{
  return { .reported = [this, key](const Report &report) { reported(key, report); },
           .gone =
               [this, key](const std::string &why) {
                 gone(key, why);
               } };
}

void
Follower::add(const std::string &key, std::unique_ptr<follow::Player> player)
{
  if (players_.size() >= kMostPlayers)
    return;
  if (player->is_announced())
    tell(player->name() + " is there");
  const follow::Habits habits = player->habits();
  players_[key] = { .player = std::move(player),
                    .estimator = follow::PositionEstimator({ .habits = habits }) };
}

void
Follower::reported(const std::string &key, const Report &report)
{
  const auto found = players_.find(key);
  if (found == players_.end() || found->second.is_gone)
    return;
  found->second.estimator.report(report);
  // Only a paused film that continues ends a lock: not the next film of a list, nor a music player
  // behind the locked screen.
  Followed &player = found->second;
  const bool goes_on = &player == current_ && player.was_paused && report.doing == Doing::playing;
  const bool begins = !player.has_played && report.doing == Doing::playing;
  player.has_played = player.has_played || begins;
  if (report.doing != Doing::stalled)
    player.was_paused = player.has_played && report.doing == Doing::paused;
  if (report.sought)
    player.found = report.received;
  if (const auto attempts = attempts_.find(key); attempts != attempts_.end()) {
    attempts->second.retry.worked();
    attempts->second.failure.clear();
  }
  player.last = report;
  if (goes_on && session_)
    session_->somebody_is_there();
  update();
  wake();
  if (begins && &player == current_)
    open_chair();
}

/// A function of the player calls this; therefore the next tick removes the player.
void
Follower::gone(const std::string &key, const std::string &why)
{
  const auto found = players_.find(key);
  if (found == players_.end() || found->second.is_gone)
    return;
  found->second.is_gone = true;
  const auto attempts = attempts_.find(key);
  if (attempts != attempts_.end())
    attempts->second.retry.failed(local_time());
  if (attempts == attempts_.end() || std::exchange(attempts->second.failure, why) != why)
    tell(found->second.player->name() + " is gone: " + why);
  update();
  wake();
}

void
Follower::choose()
{
  if (current_ != nullptr && current_->is_gone)
    current_ = nullptr;
  std::vector<Followed *> players;
  std::vector<PlayerChoice::Candidate> candidates;
  std::optional<std::size_t> current;
  for (auto &[key, followed] : players_) {
    if (followed.is_gone)
      continue;
    if (&followed == current_)
      current = players.size();
    players.push_back(&followed);
    candidates.push_back({ .doing = followed.last.doing,
                           .is_faulty = !followed.player->fault().empty(),
                           .source = followed.player->source(),
                           .found = followed.found });
  }
  const auto best = choice_.choose(candidates, current, local_time());
  Followed *chosen = best ? players[*best] : nullptr;
  if (std::exchange(current_, chosen) != chosen && chosen != nullptr) {
    cues_.change_player();
    set_delay();
  }
}

void
Follower::change_film()
{
  const std::string film
      = current_ != nullptr && current_->last.doing != Doing::stopped ? current_->last.film : "";
  if (film == film_) {
    if (current_ != nullptr && current_->last.length)
      film_track_.take_length(*current_->last.length);
    return;
  }
  film_ = film;
  position_ = follow::Time(0);
  if (current_ != nullptr)
    set_delay();
  // Motors first: a slow disk may take its time.
  track_.reset();
  cues_.set_track(nullptr);
  feel({}, local_time());
  if (current_ != nullptr)
    film_track_.open(film, current_->player->track(), current_->last.length);
  else
    film_track_.open(film);
}

void
Follower::change_track(std::shared_ptr<const tactile::Draft> track)
{
  track_ = std::move(track);
  cues_.set_track(track_);
  open_chair();
}

void
Follower::open_chair()
{
  // Until the film plays, others may have the chair.
  if (!track_ || rests_ || current_ == nullptr || !current_->has_played)
    return;
  try {
    chair_.open(track_->rows(), track_->columns());
  } catch (const std::runtime_error &error) {
    chair_failed(error.what());
  }
}

/// After a sleep, a board or a gamepad may take its time to come back.
void
Follower::chair_failed(const std::string &text)
{
  if (local_time() >= patient_until_) {
    fail(text);
    return;
  }
  if (!std::exchange(opens_again_, true))
    tell("the chair is not there yet: " + text);
}

/// Silences the chair while nobody is in it.
void
Follower::rest(bool rests, const std::string &why)
{
  rests_ = rests;
  opens_again_ = false;
  if (rests) {
    chair_.close(); // motors at zero when it returns
    if (const auto sound = players_.find(kSound); sound != players_.end()) {
      if (current_ == &sound->second)
        current_ = nullptr;
      players_.erase(sound);
    }
    known_films_ = {}; // they may have changed when somebody returns
    tell("nothing is felt: " + why);
  } else {
    tell("the chair is used again");
    patient_until_ = local_time() + kPatience;
    open_chair();
  }
  cues_.set_track(rests ? nullptr : track_);
  wake();
}

void
Follower::update()
{
  if (lists_ || rests_)
    return;
  choose();
  change_film();
  const follow::Time now = local_time();
  const auto estimate = film_position(now);
  if (estimate)
    position_ = estimate->position;
  feel(estimate, now);
}

/// Sends the cues that are due now, and reports when the next ones are, or silence is.
void
Follower::feel(const std::optional<follow::PositionEstimator::Estimate> &estimate, follow::Time now)
{
  const follow::Time ahead = chair_.ahead();
  const auto step = cues_.step(estimate, now, ahead);
  chair_.take(step);
  due_ = now + kSlowTick;
  if (step.until) // the film may be put right by playing faster
    due_ = now + (*step.until - now - ahead) * 10 / 12;
  if (const auto known = current_ != nullptr ? current_->estimator.known_until() : std::nullopt)
    due_ = std::min(due_, *known + std::chrono::milliseconds(1));
}

/// Where the film is, from its 0:00 on.
std::optional<follow::PositionEstimator::Estimate>
Follower::film_position(follow::Time now) const
{
  auto estimate
      = current_ != nullptr && !current_->is_gone ? current_->estimator.at(now) : std::nullopt;
  if (estimate && !current_->player->counts_from_start())
    estimate->position
        = std::max(estimate->position - film_track_.told_at_start(), follow::Time(0));
  return estimate;
}

/// Sets the time of the next tick. They end by themselves when a second between them is enough.
void
Follower::wake()
{
  constexpr auto kLeast = std::chrono::milliseconds(5);
  const bool hurries = !is_busy() || any_leaves() || film_track_.is_busy(position_)
                       || (current_ != nullptr && current_->estimator.asks_again());
  const follow::Time next = hurries ? stepped_ + kTick : std::min(stepped_ + kSlowTick, due_);
  const follow::Time earliest = local_time() + kLeast;
  const gint64 ready
      = std::chrono::duration_cast<std::chrono::microseconds>(std::max(next, earliest)).count();
  // Reports in quick succession do not put a step off.
  if (const gint64 known = g_source_get_ready_time(ticks_); known < 0 || ready < known)
    g_source_set_ready_time(ticks_, ready);
}

bool
Follower::any_leaves() const
{
  return !returned_.empty()
         || std::ranges::any_of(players_, [](const auto &one) { return one.second.is_gone; });
}

/// Whether anything can change within a second without a report.
bool
Follower::is_busy() const
{
  if (rests_ || any_leaves())
    return any_leaves();
  return film_track_.is_busy(position_) || (current_ != nullptr && current_->estimator.asks_again())
         || std::ranges::any_of(players_, [](const auto &one) {
              return one.second.last.doing == Doing::playing
                     || one.second.last.doing == Doing::stalled;
            });
}

void
Follower::step()
{
  stepped_ = local_time();
  update();
  if (current_ != nullptr)
    tell_of_player();
  if (session_)
    session_->keep_awake(!rests_ && current_ != nullptr && !current_->is_gone
                         && current_->player->source() != follow::Source::player
                         && current_->last.doing == Doing::playing);
  if (!rests_)
    film_track_.step(position_, local_time());
  if (!track_ && !film_track_.is_looking())
    chair_.close();
  if (current_ != nullptr && current_->estimator.asks_again())
    current_->player->ask();
  if (current_ != nullptr && current_->is_gone)
    current_ = nullptr;
  const bool others_play = std::ranges::any_of(players_, [](const auto &one) {
    return one.first != kSound && !one.second.is_gone && one.second.has_played;
  });
  const bool has_left = std::ranges::any_of(players_, [&](const auto &one) {
    // A listener or a server that failed is tried again. A file that has ended is the end unless a
    // player has played, too.
    return one.second.is_gone
           && (!attempts_.contains(one.first)
               || (one.first == kSound && !listens_ && !others_play));
  });
  std::erase_if(players_, [](const auto &one) { return one.second.is_gone; });
  if (has_left && settings_.once)
    g_main_loop_quit(loop_);
  for (const std::string &name : std::exchange(returned_, {}))
    appeared(name);
}

void
Follower::tell(const std::string &text)
{
  if (!settings_.quiet)
    print_error("visuotactile-follow", text);
}

void
Follower::fail(const std::string &text)
{
  if (failure_.empty())
    failure_ = text;
  g_main_loop_quit(loop_);
}
