// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <functional>
#include <string>

namespace follow {

inline constexpr const char *kMprisPrefix = "org.mpris.MediaPlayer2.";

/// Players as they come to the session bus and leave it. Calls back in the main context in which it
/// was made.
class MprisBus
{
public:
  struct Events
  {
    std::function<void(const std::string &bus_name)> appeared;
    std::function<void(const std::string &bus_name)> vanished;
  };

  MprisBus(GDBusConnection *bus, Events events);
  ~MprisBus();
  MprisBus(const MprisBus &) = delete;
  MprisBus &operator=(const MprisBus &) = delete;

private:
  static void on_owner(GDBusConnection *bus, const gchar *sender, const gchar *path,
                       const gchar *interface, const gchar *signal, GVariant *parameters,
                       gpointer data);
  static void on_names(GObject *bus, GAsyncResult *result, gpointer data);

  const Events events_;
  GDBusConnection *bus_;
  GCancellable *canceled_;
  guint subscription_;
};

} // namespace follow
