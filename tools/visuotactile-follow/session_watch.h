// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

/// Notifies of times at which nobody can be in the chair: the screen is locked, or the computer
/// sleeps. Uses logind on the system bus and screen savers on the session bus. Main context's
/// thread.
class SessionWatch
{
public:
  /// Called when the first reason begins and when the last one ends. The computer sleeps only after
  /// it has returned (five seconds later at the latest, by logind's default).
  using Rests = std::function<void(bool rests, const std::string &why)>;

  /// `session`: the session bus, or nullptr. logind names `program` to the user as the reason for a
  /// delayed sleep.
  SessionWatch(GDBusConnection *session, std::string program, Rests rests);
  ~SessionWatch();
  SessionWatch(const SessionWatch &) = delete;
  SessionWatch &operator=(const SessionWatch &) = delete;

  /// Ends all reasons: the screen is not locked any more. Not every locker reports its end.
  void somebody_is_there();

  /// While a film plays on another screen, prevents this computer's saver from starting.
  void keep_awake(bool keeps);

private:
  void subscribe(GDBusConnection *bus, const char *sender, const char *interface,
                 const char *signal, const char *path, GDBusSignalCallback callback);
  void call_logind(const char *method, GVariant *arguments, GAsyncReadyCallback callback);
  void delay_sleep();
  void set(const std::string &reason, bool holds);
  void set_saver(const std::string &saver, bool is_on);
  void let_sleep();

  static void on_system_bus(GObject *source, GAsyncResult *result, gpointer self);
  static void on_session(GObject *bus, GAsyncResult *result, gpointer self);
  static void on_locked(GObject *bus, GAsyncResult *result, gpointer self);
  static void on_saver(GDBusConnection *bus, const gchar *name, const gchar *owner, gpointer self);
  static void on_saver_gone(GDBusConnection *bus, const gchar *name, gpointer self);
  static void on_awake(GObject *bus, GAsyncResult *result, gpointer self);
  static void on_delay(GObject *bus, GAsyncResult *result, gpointer self);

  const std::string program_;
  const Rests rests_;
  GCancellable *canceled_;
  GDBusConnection *session_ = nullptr;
  GDBusConnection *system_ = nullptr;
  std::vector<std::pair<GDBusConnection *, guint>> subscriptions_;
  std::vector<guint> names_; ///< that are watched
  std::set<std::string> reasons_;
  std::set<std::string> savers_; ///< that are on
  bool keeps_awake_ = false;
  bool asks_saver_ = false; ///< until it answers
  guint32 cookie_ = 0;      ///< of the saver, while it is prevented
  int delay_ = -1; ///< file descriptor; the computer waits with sleeping until it is closed
};
