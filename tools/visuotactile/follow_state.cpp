// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow_state.h"

#include "translation.h"

namespace {

constexpr const char *kName = "org.visuotactile.Follow1";
constexpr const char *kPath = "/org/visuotactile/Follow1";

} // namespace

FollowState::FollowState(std::function<void()> changed) : changed_(std::move(changed))
{
  bus_ = g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, nullptr);
  if (bus_ == nullptr)
    return;
  watch_ = g_bus_watch_name_on_connection(
      bus_, kName, G_BUS_NAME_WATCHER_FLAGS_NONE,
      +[](GDBusConnection *, const gchar *, const gchar *, gpointer data) {
        auto *self = static_cast<FollowState *>(data);
        self->runs_ = true;
        self->look();
        self->timer_ = g_timeout_add_seconds(
            1,
            +[](gpointer own) -> gboolean {
              static_cast<FollowState *>(own)->look();
              return G_SOURCE_CONTINUE;
            },
            self);
      },
      +[](GDBusConnection *, const gchar *, gpointer data) {
        auto *self = static_cast<FollowState *>(data);
        self->runs_ = false;
        self->values_.clear();
        if (self->timer_ != 0)
          g_source_remove(self->timer_);
        self->timer_ = 0;
        self->changed_();
      },
      this, nullptr);
}

FollowState::~FollowState()
{
  g_cancellable_cancel(ended_);
  if (watch_ != 0)
    g_bus_unwatch_name(watch_);
  if (timer_ != 0)
    g_source_remove(timer_);
  g_clear_object(&bus_);
  g_object_unref(ended_);
}

void
FollowState::look()
{
  g_dbus_connection_call(
      bus_, kName, kPath, "org.freedesktop.DBus.Properties", "GetAll", g_variant_new("(s)", kName),
      G_VARIANT_TYPE("(a{sv})"), G_DBUS_CALL_FLAGS_NO_AUTO_START, -1, ended_,
      +[](GObject *bus, GAsyncResult *result, gpointer data) {
        g_autoptr(GError) error = nullptr;
        g_autoptr(GVariant) answer
            = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
        if (answer == nullptr)
          return; // `data` may be gone
        auto *self = static_cast<FollowState *>(data);
        g_autoptr(GVariant) all = g_variant_get_child_value(answer, 0);
        std::map<std::string, std::string> values;
        for (const char *key : { "Player", "State", "Film", "Track", "Fault" }) {
          const gchar *value = "";
          g_variant_lookup(all, key, "&s", &value);
          values[key] = value;
        }
        if (values == self->values_)
          return;
        self->values_ = values;
        self->changed_();
      },
      this);
}

std::string
FollowState::text() const
{
  if (!runs_)
    return _("The chair waits.");
  const auto value = [this](const char *key) {
    const auto found = values_.find(key);
    return found == values_.end() ? std::string() : found->second;
  };
  if (!value("Fault").empty())
    return value("Player") + ": " + value("Fault");
  if (value("Player").empty())
    return _("The chair waits for a player.");
  const std::string film = value("Film") + " (" + value("Player") + ")";
  return value("State") == "plays" ? in_text("The chair follows {}.", film)
                                   : in_text("The chair waits with {}.", film);
}
