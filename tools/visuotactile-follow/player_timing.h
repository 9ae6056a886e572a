// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "server_player.h"

#include <glib.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>

/// The kind of a player by its name: "vlc" of "vlc.instance123", "mpv" of "mpv at /run/…".
std::string player_kind(const std::string &name);

/// The part of a film with which the chair is in sync.
enum class SyncTo
{
  screen,
  sound,
};
std::optional<SyncTo> sync_of(std::string_view name);
const char *name_of(SyncTo sync);

/// The user's settings for each kind of player, in a key file. Times are in ms, from −kMost to
/// kMost; other values count as not set.
///
///     [vlc]
///     sync-to=sound
///     screen-latency=40
///     sound-latency=120
///     offset=10
///
/// the offset with one film, `[film Big%20Buck%20Bunny.mkv]`, and how media servers are reached:
///
///     [jellyfin]
///     server=http://192.168.1.10:8096
///     token=0123456789abcdef
///     device=Television
class PlayerTiming
{
public:
  static constexpr double kMost = 5000; ///< ms

  /// $XDG_CONFIG_HOME/visuotactile/follow.conf
  static std::string usual_path();

  /// A file that does not exist is empty. Throws std::runtime_error, with the path, if it is no key
  /// file or larger than a MiB.
  explicit PlayerTiming(std::string path);

  std::optional<SyncTo> sync_to(const std::string &kind) const;
  /// Delay from the player's picture on this computer's screen until it is seen.
  std::optional<double> screen_latency(const std::string &kind) const;
  /// Delay from there until its sound is heard.
  std::optional<double> sound_latency(const std::string &kind) const;

  /// None: it has no address, or no token.
  std::optional<ServerSettings> server(follow::ServerKind kind) const;

  /// Whether other users can read the file, in which a token may be.
  bool is_public() const;

  /// Delay from there until the vibration is felt.
  double offset(const std::string &kind) const;
  /// Additional delay with one film, by its name.
  double film_offset(const std::string &film) const
  {
    return offset(film_group(film));
  }

  /// Limits the offset to kMost, and writes the file at once. Changes by the user in the meantime
  /// are kept, and apply from then on. Only the user can read the file then. Throws
  /// std::runtime_error with the path.
  void set_offset(const std::string &kind, double offset);
  void set_film_offset(const std::string &film, double offset)
  {
    set_offset(film_group(film), offset);
  }

private:
  static std::string film_group(const std::string &film);
  void read();
  std::optional<double> number(const std::string &kind, const char *key) const;

  std::string path_;
  std::unique_ptr<GKeyFile, void (*)(GKeyFile *)> file_;
};
