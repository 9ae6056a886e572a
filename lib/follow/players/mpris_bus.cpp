// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpris_bus.h"

#include <string_view>
#include <utility>

namespace follow {

namespace {

constexpr const char *kBus = "org.freedesktop.DBus";

bool
is_player(std::string_view name)
{
  return name.starts_with(kMprisPrefix);
}

} // namespace

MprisBus::MprisBus(GDBusConnection *bus, Events events)
    : events_(std::move(events)), bus_(bus), canceled_(g_cancellable_new())
{
  g_object_ref(bus_);
  subscription_ = g_dbus_connection_signal_subscribe(
      bus_, kBus, kBus, "NameOwnerChanged", "/org/freedesktop/DBus", "org.mpris.MediaPlayer2",
      G_DBUS_SIGNAL_FLAGS_MATCH_ARG0_NAMESPACE, on_owner, this, nullptr);
  g_dbus_connection_call(bus_, kBus, "/org/freedesktop/DBus", kBus, "ListNames", nullptr,
                         G_VARIANT_TYPE("(as)"), G_DBUS_CALL_FLAGS_NONE, -1, canceled_, on_names,
                         this);
}

MprisBus::~MprisBus()
{
  g_dbus_connection_signal_unsubscribe(bus_, subscription_);
  g_cancellable_cancel(canceled_);
  g_object_unref(canceled_);
  g_object_unref(bus_);
}

void
MprisBus::on_owner(GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *,
                   GVariant *parameters, gpointer data)
{
  auto *self = static_cast<MprisBus *>(data);
  const gchar *name = nullptr;
  const gchar *before = nullptr;
  const gchar *after = nullptr;
  if (!g_variant_is_of_type(parameters, G_VARIANT_TYPE("(sss)")))
    return;
  g_variant_get(parameters, "(&s&s&s)", &name, &before, &after);
  if (!is_player(name))
    return;
  if (*before != '\0')
    self->events_.vanished(name);
  if (*after != '\0')
    self->events_.appeared(name);
}

void
MprisBus::on_names(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer
      = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
  if (answer == nullptr) // canceled: this is no more
    return;
  g_autoptr(GVariant) names = g_variant_get_child_value(answer, 0);
  GVariantIter iterator;
  g_variant_iter_init(&iterator, names);
  const gchar *name = nullptr;
  while (g_variant_iter_next(&iterator, "&s", &name))
    if (is_player(name))
      static_cast<MprisBus *>(data)->events_.appeared(name);
}

} // namespace follow
