// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <functional>
#include <map>
#include <string>

namespace follow {

inline constexpr const char *kMprisPrefix = "org.mpris.MediaPlayer2.";

/// Notifies of players that come to the session bus and leave it. If a player has several names, as
/// VLC has, the first wanted one counts. Calls back in the main context in which it was made.
class MprisBus
{
public:
  struct Events
  {
    std::function<void(const std::string &bus_name)> appeared;
    std::function<void(const std::string &bus_name)> vanished;
  };

  /// `wanted`: only the player of that name; empty: all.
  MprisBus(GDBusConnection *bus, const std::string &wanted, Events events);
  ~MprisBus();
  MprisBus(const MprisBus &) = delete;
  MprisBus &operator=(const MprisBus &) = delete;

private:
  bool is_wanted(const std::string &name) const;
  void ask_for_owner(const std::string &name);
  void has_owner(const std::string &name, const std::string &owner);
  static void on_owner(GDBusConnection *bus, const gchar *sender, const gchar *path,
                       const gchar *interface, const gchar *signal, GVariant *parameters,
                       gpointer data);
  static void on_names(GObject *bus, GAsyncResult *result, gpointer data);
  static void on_name_owner(GObject *bus, GAsyncResult *result, gpointer data);

  const std::string wanted_; ///< with its prefix; empty: all
  const Events events_;
  GDBusConnection *bus_;
  GCancellable *canceled_;
  guint subscription_;
  std::map<std::string, std::string> told_; ///< a player's unique name, by the notified name
};

} // namespace follow
