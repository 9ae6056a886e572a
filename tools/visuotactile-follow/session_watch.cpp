// SPDX-License-Identifier: LGPL-2.1-or-later
#include "session_watch.h"

#include <gio/gunixfdlist.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace {

constexpr const char *kLogind = "org.freedesktop.login1";
constexpr const char *kManager = "org.freedesktop.login1.Manager";
constexpr const char *kSession = "org.freedesktop.login1.Session";

constexpr const char *kSleep = "the computer goes to sleep";
constexpr const char *kLock = "the screen is locked";
constexpr const char *kSaver = "the screen saver is on";

/// The object manager's own name for the caller's session, or the user's.
constexpr const char *kMine = "auto";

/// Each desktop has its own.
constexpr const char *kSavers[]
    = { "org.freedesktop.ScreenSaver", "org.gnome.ScreenSaver", "org.cinnamon.ScreenSaver",
        "org.mate.ScreenSaver", "org.xfce.ScreenSaver" };

constexpr const char *kSaverPath = "/org/freedesktop/ScreenSaver";

bool
flag(GVariant *parameters)
{
  gboolean value = FALSE;
  if (g_variant_is_of_type(parameters, G_VARIANT_TYPE("(b)")))
    g_variant_get(parameters, "(b)", &value);
  return value != FALSE;
}

} // namespace

SessionWatch::SessionWatch(GDBusConnection *session, std::string program, Rests rests)
    : program_(std::move(program)), rests_(std::move(rests)), canceled_(g_cancellable_new()),
      session_(session)
{
  if (session_ != nullptr) {
    g_object_ref(session_);
    for (const char *saver : kSavers) {
      subscribe(
          session_, nullptr, saver, "ActiveChanged", nullptr,
          +[](GDBusConnection *, const gchar *, const gchar *, const gchar *interface,
              const gchar *, GVariant *parameters, gpointer self) {
            static_cast<SessionWatch *>(self)->set_saver(interface, flag(parameters));
          });
      names_.push_back(g_bus_watch_name_on_connection(
          session_, saver, G_BUS_NAME_WATCHER_FLAGS_NONE, on_saver, on_saver_gone, this, nullptr));
    }
  }
  g_bus_get(G_BUS_TYPE_SYSTEM, canceled_, on_system_bus, this);
}

SessionWatch::~SessionWatch()
{
  g_cancellable_cancel(canceled_);
  g_object_unref(canceled_);
  for (const guint name : names_)
    g_bus_unwatch_name(name);
  for (const auto &[bus, subscription] : subscriptions_)
    g_dbus_connection_signal_unsubscribe(bus, subscription);
  if (delay_ >= 0)
    close(delay_);
  g_clear_object(&session_);
  g_clear_object(&system_);
}

void
SessionWatch::subscribe(GDBusConnection *bus, const char *sender, const char *interface,
                        const char *signal, const char *path, GDBusSignalCallback callback)
{
  subscriptions_.emplace_back(
      bus, g_dbus_connection_signal_subscribe(bus, sender, interface, signal, path, nullptr,
                                              G_DBUS_SIGNAL_FLAGS_NONE, callback, this, nullptr));
}

/// Queries whether the saver is on already. By the bus's custom, its path follows from its name.
void
SessionWatch::on_saver(GDBusConnection *bus, const gchar *name, const gchar *, gpointer data)
{
  auto *self = static_cast<SessionWatch *>(data);
  std::string path = std::string("/") + name;
  std::ranges::replace(path, '.', '/');
  struct Asked
  {
    SessionWatch *watch;
    std::string saver;
  };
  g_dbus_connection_call(
      bus, name, path.c_str(), name, "GetActive", nullptr, G_VARIANT_TYPE("(b)"),
      G_DBUS_CALL_FLAGS_NO_AUTO_START, -1, self->canceled_,
      +[](GObject *source, GAsyncResult *result, gpointer asked) {
        const std::unique_ptr<Asked> mine(static_cast<Asked *>(asked));
        g_autoptr(GError) error = nullptr;
        g_autoptr(GVariant) answer
            = g_dbus_connection_call_finish(G_DBUS_CONNECTION(source), result, &error);
        if (answer != nullptr && flag(answer)) // if it was canceled, the watch is no more
          mine->watch->set_saver(mine->saver, true);
      },
      new Asked{ self, name });
}

void
SessionWatch::on_saver_gone(GDBusConnection *, const gchar *name, gpointer data)
{
  auto *self = static_cast<SessionWatch *>(data);
  if (self->savers_.contains(name))
    self->set_saver(name, false);
}

void
SessionWatch::set_saver(const std::string &saver, bool is_on)
{
  if (is_on)
    savers_.insert(saver);
  else
    savers_.erase(saver);
  set(kSaver, !savers_.empty());
  if (!is_on)
    somebody_is_there();
}

void
SessionWatch::keep_awake(bool keeps)
{
  if (std::exchange(keeps_awake_, keeps) == keeps || session_ == nullptr || asks_saver_)
    return;
  if (!keeps) {
    let_sleep();
    return;
  }
  asks_saver_ = true;
  g_dbus_connection_call(session_, kSavers[0], kSaverPath, kSavers[0], "Inhibit",
                         g_variant_new("(ss)", program_.c_str(), "A film plays on another screen"),
                         G_VARIANT_TYPE("(u)"), G_DBUS_CALL_FLAGS_NO_AUTO_START, -1, canceled_,
                         on_awake, this);
}

void
SessionWatch::on_awake(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer
      = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
    return; // the watch is no more
  auto *self = static_cast<SessionWatch *>(data);
  self->asks_saver_ = false;
  if (answer != nullptr) // a desktop without it has its own ways
    g_variant_get(answer, "(u)", &self->cookie_);
  if (!self->keeps_awake_)
    self->let_sleep();
}

void
SessionWatch::let_sleep()
{
  if (const guint32 cookie = std::exchange(cookie_, 0); cookie != 0)
    g_dbus_connection_call(session_, kSavers[0], kSaverPath, kSavers[0], "UnInhibit",
                           g_variant_new("(u)", cookie), nullptr, G_DBUS_CALL_FLAGS_NO_AUTO_START,
                           -1, nullptr, nullptr, nullptr);
}

void
SessionWatch::call_logind(const char *method, GVariant *arguments, GAsyncReadyCallback callback)
{
  g_dbus_connection_call_with_unix_fd_list(system_, kLogind, "/org/freedesktop/login1", kManager,
                                           method, arguments, nullptr, G_DBUS_CALL_FLAGS_NONE, -1,
                                           nullptr, canceled_, callback, this);
}

/// Without a system bus or logind, as in a container, nothing notifies of sleep.
void
SessionWatch::on_system_bus(GObject *, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  GDBusConnection *bus = g_bus_get_finish(result, &error);
  if (bus == nullptr) // also if it was canceled: this is no more
    return;
  auto *self = static_cast<SessionWatch *>(data);
  self->system_ = bus;
  g_dbus_connection_set_exit_on_close(bus, FALSE);
  self->subscribe(
      bus, kLogind, kManager, "PrepareForSleep", "/org/freedesktop/login1",
      +[](GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *,
          GVariant *parameters, gpointer watch) {
        auto *mine = static_cast<SessionWatch *>(watch);
        const bool sleeps = flag(parameters);
        mine->set(kSleep, sleeps);
        if (!sleeps)
          mine->delay_sleep();
        else if (mine->delay_ >= 0)
          close(std::exchange(mine->delay_, -1));
      });
  self->delay_sleep();
  self->call_logind("GetSession", g_variant_new("(s)", kMine), on_session);
}

void
SessionWatch::delay_sleep()
{
  if (delay_ < 0)
    call_logind("Inhibit",
                g_variant_new("(ssss)", "sleep", program_.c_str(),
                              "Motors of the chair are brought to zero", "delay"),
                on_delay);
}

void
SessionWatch::on_delay(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GUnixFDList) files = nullptr;
  g_autoptr(GVariant) answer = g_dbus_connection_call_with_unix_fd_list_finish(
      G_DBUS_CONNECTION(bus), &files, result, &error);
  gint32 index = -1;
  if (answer == nullptr || files == nullptr || !g_variant_is_of_type(answer, G_VARIANT_TYPE("(h)")))
    return;
  g_variant_get(answer, "(h)", &index);
  const int file = g_unix_fd_list_get(files, index, nullptr);
  auto *self = static_cast<SessionWatch *>(data);
  if (self->delay_ < 0 && !self->reasons_.contains(kSleep))
    self->delay_ = file;
  else if (file >= 0)
    close(file);
}

void
SessionWatch::on_session(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer = g_dbus_connection_call_with_unix_fd_list_finish(
      G_DBUS_CONNECTION(bus), nullptr, result, &error);
  if (answer == nullptr || !g_variant_is_of_type(answer, G_VARIANT_TYPE("(o)")))
    return;
  const gchar *path = nullptr;
  g_variant_get(answer, "(&o)", &path);
  auto *self = static_cast<SessionWatch *>(data);
  const auto changes = [&](const char *signal, GDBusSignalCallback callback) {
    self->subscribe(self->system_, kLogind, kSession, signal, path, callback);
  };
  changes(
      "Lock",
      +[](GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *, GVariant *,
          gpointer watch) { static_cast<SessionWatch *>(watch)->set(kLock, true); });
  // Most lockers report their end here, few by the signal.
  self->subscribe(
      self->system_, kLogind, "org.freedesktop.DBus.Properties", "PropertiesChanged", path,
      +[](GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *,
          GVariant *parameters, gpointer watch) {
        if (!g_variant_is_of_type(parameters, G_VARIANT_TYPE("(sa{sv}as)")))
          return;
        gboolean locked = FALSE;
        g_autoptr(GVariant) changed = g_variant_get_child_value(parameters, 1);
        if (g_variant_lookup(changed, "LockedHint", "b", &locked))
          static_cast<SessionWatch *>(watch)->set(kLock, locked != FALSE);
      });
  g_dbus_connection_call(self->system_, kLogind, path, "org.freedesktop.DBus.Properties", "Get",
                         g_variant_new("(ss)", kSession, "LockedHint"), G_VARIANT_TYPE("(v)"),
                         G_DBUS_CALL_FLAGS_NONE, -1, self->canceled_, on_locked, self);
  changes(
      "Unlock",
      +[](GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *, GVariant *,
          gpointer watch) { static_cast<SessionWatch *>(watch)->set(kLock, false); });
}

/// Receives whether the screen is locked already.
void
SessionWatch::on_locked(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer
      = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
  if (answer == nullptr)
    return;
  g_autoptr(GVariant) value = nullptr;
  g_variant_get(answer, "(v)", &value);
  if (g_variant_is_of_type(value, G_VARIANT_TYPE_BOOLEAN) && g_variant_get_boolean(value) != FALSE)
    static_cast<SessionWatch *>(data)->set(kLock, true);
}

void
SessionWatch::somebody_is_there()
{
  set(kLock, false);
}

void
SessionWatch::set(const std::string &reason, bool holds)
{
  const bool before = !reasons_.empty();
  if (holds)
    reasons_.insert(reason);
  else
    reasons_.erase(reason);
  if (before != !reasons_.empty())
    rests_(!before, reason);
}
