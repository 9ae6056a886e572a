// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpris_bus.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

namespace follow {

namespace {

constexpr const char *kBus = "org.freedesktop.DBus";
constexpr const char *kPath = "/org/freedesktop/DBus";

struct Question
{
  MprisBus *asks;
  std::string name;
};

} // namespace

MprisBus::MprisBus(GDBusConnection *bus, const std::string &wanted, Events events)
    : wanted_(wanted.empty() ? "" : kMprisPrefix + wanted), events_(std::move(events)), bus_(bus),
      canceled_(g_cancellable_new())
{
  g_object_ref(bus_);
  subscription_ = g_dbus_connection_signal_subscribe(
      bus_, kBus, kBus, "NameOwnerChanged", kPath, "org.mpris.MediaPlayer2",
      G_DBUS_SIGNAL_FLAGS_MATCH_ARG0_NAMESPACE, on_owner, this, nullptr);
  g_dbus_connection_call(bus_, kBus, kPath, kBus, "ListNames", nullptr, G_VARIANT_TYPE("(as)"),
                         G_DBUS_CALL_FLAGS_NONE, -1, canceled_, on_names, this);
}

MprisBus::~MprisBus()
{
  g_dbus_connection_signal_unsubscribe(bus_, subscription_);
  g_cancellable_cancel(canceled_);
  g_object_unref(canceled_);
  g_object_unref(bus_);
}

bool
MprisBus::is_wanted(const std::string &name) const
{
  return name.starts_with(kMprisPrefix) && (wanted_.empty() || name == wanted_);
}

void
MprisBus::has_owner(const std::string &name, const std::string &owner)
{
  const auto before = told_.find(name);
  if (before != told_.end() && before->second == owner)
    return;
  if (before != told_.end()) {
    told_.erase(before);
    events_.vanished(name);
  }
  if (owner.empty() || std::ranges::any_of(told_, [&](auto &one) { return one.second == owner; }))
    return;
  told_[name] = owner;
  events_.appeared(name);
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
  if (self->is_wanted(name))
    self->has_owner(name, after);
}

void
MprisBus::on_names(GObject *bus, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer
      = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
  if (answer == nullptr) // canceled: this is no more
    return;
  auto *self = static_cast<MprisBus *>(data);
  g_autoptr(GVariant) names = g_variant_get_child_value(answer, 0);
  GVariantIter iterator;
  g_variant_iter_init(&iterator, names);
  const gchar *name = nullptr;
  std::set<std::string> wanted; // the shorter of two names first
  while (g_variant_iter_next(&iterator, "&s", &name))
    if (self->is_wanted(name))
      wanted.insert(name);
  for (const std::string &one : wanted)
    self->ask_for_owner(one);
}

void
MprisBus::ask_for_owner(const std::string &name)
{
  g_dbus_connection_call(bus_, kBus, kPath, kBus, "GetNameOwner",
                         g_variant_new("(s)", name.c_str()), G_VARIANT_TYPE("(s)"),
                         G_DBUS_CALL_FLAGS_NONE, -1, canceled_, on_name_owner,
                         std::make_unique<Question>(Question{ this, name }).release());
}

void
MprisBus::on_name_owner(GObject *bus, GAsyncResult *result, gpointer data)
{
  const std::unique_ptr<Question> question(static_cast<Question *>(data));
  g_autoptr(GError) error = nullptr;
  g_autoptr(GVariant) answer
      = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
  if (answer == nullptr) // it has gone again, or canceled: this is no more
    return;
  const gchar *owner = nullptr;
  g_variant_get(answer, "(&s)", &owner);
  question->asks->has_owner(question->name, owner);
}

} // namespace follow
