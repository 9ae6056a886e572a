// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <functional>
#include <string>

/// The state of a follower.
struct FollowStatus
{
  std::string player{};       ///< empty: none
  std::string state = "idle"; ///< idle, stopped, paused, waits, plays, lost or rests
  std::string film{};
  std::string track{};    ///< its source; empty: none
  std::string library{};  ///< folder or address of tracks; empty: none
  std::string fault{};    ///< of a track that is therefore not felt; empty: none
  double position = -1;   ///< s; < 0: unknown
  double ahead = -1;      ///< s of the track known from the position on; < 0: all
  std::string sync_to{};  ///< screen or sound
  double latency = 0;     ///< ms: of the screen, or of the sound
  double offset = 0;      ///< ms of delay on top of it
  double film_offset = 0; ///< ms of delay with this film on top of that
};

/// A running follower on the session bus: org.visuotactile.Follow1 at /org/visuotactile/Follow1. Of
/// the main context's thread.
class FollowService
{
public:
  struct Calls
  {
    std::function<FollowStatus()> status;
    std::function<double(double by)>
        nudge; ///< returns the offset, in ms. Throws std::runtime_error.
    std::function<double(double by)> nudge_film; ///< likewise
    std::function<void()> pass_over;             ///< a faulty track. Throws std::runtime_error.
    std::function<void(const std::string &)> told;
  };

  FollowService(GDBusConnection *bus, Calls calls);
  ~FollowService();
  FollowService(const FollowService &) = delete;
  FollowService &operator=(const FollowService &) = delete;

private:
  static void on_call(GDBusConnection *bus, const gchar *sender, const gchar *path,
                      const gchar *interface, const gchar *method, GVariant *arguments,
                      GDBusMethodInvocation *invocation, gpointer self);
  static GVariant *on_get(GDBusConnection *bus, const gchar *sender, const gchar *path,
                          const gchar *interface, const gchar *property, GError **error,
                          gpointer self);

  const Calls calls_;
  GDBusConnection *bus_;
  guint object_ = 0;
  guint name_ = 0;
};

/// The state of the running follower. Throws std::runtime_error if there is none.
FollowStatus ask_status();
/// Moves the vibration, and returns the offset of the player, or of the film, in ms. Throws
/// std::runtime_error.
double send_nudge(double by, bool of_film);
/// Skips a faulty track. Throws std::runtime_error.
void send_pass_over();
