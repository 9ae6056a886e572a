// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpris_player.h"

#include "follow/players/mpris_bus.h"
#include "follow/players/mpris_position.h"
#include "follow/players/mpris_state.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace follow {

namespace {

constexpr const char *kPath = "/org/mpris/MediaPlayer2";
constexpr const char *kPlayer = "org.mpris.MediaPlayer2.Player";
constexpr const char *kProperties = "org.freedesktop.DBus.Properties";

/// Time between queries for the position while it plays: a quarter of a second times the golden
/// section. Queries then never fall in step with a player that updates its position every quarter
/// of a second, and each answer narrows a rounded position further.
constexpr guint kAskEvery = 155; ///< ms
constexpr int kAnswer = 1000;    ///< ms; an answer that comes later is none

/// Players that renew their position now and then.
struct Known
{
  std::string_view name; ///< begins so
  Time renewed;          ///< after so long at the latest
  Time later;            ///< than its report, a picture is on the screen
  Time sound_later;      ///< than the picture (docs/measured/follow.md)
  bool counts_from_start = true;
};
constexpr Known kKnown[] = {
  // VLC 3 after 250 to 290 ms, and seldom later.
  { .name = "vlc",
    .renewed = std::chrono::milliseconds(400),
    .later = Time(0),
    .sound_later = Time(0),
    .counts_from_start = false },
  // Chromium 156 each 100 ms.
  { .name = "chromium",
    .renewed = std::chrono::milliseconds(200),
    .later = std::chrono::milliseconds(60),
    .sound_later = std::chrono::milliseconds(30) },
};

Known
known(std::string_view name)
{
  for (const Known &one : kKnown)
    if (name.starts_with(one.name))
      return one;
  return {};
}

class MprisPlayer : public Player
{
public:
  MprisPlayer(GDBusConnection *bus, const std::string &bus_name, PlayerEvents events)
      : bus_name_(bus_name), name_(bus_name.substr(std::string(kMprisPrefix).size())),
        known_(known(name_)), events_(std::move(events)), bus_(bus), canceled_(g_cancellable_new())
  {
    g_object_ref(bus_);
    subscriptions_[0] = subscribe(kProperties, "PropertiesChanged", kPlayer, on_changed);
    subscriptions_[1] = subscribe(kPlayer, "Seeked", nullptr, on_seeked);
    ask_all();
  }
  ~MprisPlayer() override
  {
    for (const guint subscription : subscriptions_)
      g_dbus_connection_signal_unsubscribe(bus_, subscription);
    g_cancellable_cancel(canceled_); // answers are dropped from now on
    g_object_unref(canceled_);
    if (timer_ != 0)
      g_source_remove(timer_);
    g_object_unref(bus_);
  }
  MprisPlayer(const MprisPlayer &) = delete;
  MprisPlayer &operator=(const MprisPlayer &) = delete;

  const std::string &name() const override
  {
    return name_;
  }
  Habits habits() const override
  {
    Habits habits;
    habits.coarseness = known_.renewed;
    habits.lingers = known_.renewed > Time(0);
    return habits;
  }
  Time sound_latency() const override
  {
    return known_.sound_later;
  }
  bool counts_from_start() const override
  {
    return known_.counts_from_start;
  }
  const std::string &fault() const override
  {
    return position_.fault();
  }
  std::string remark() const override
  {
    const std::string unit = position_.unit();
    return unit == MprisPosition().unit() ? ""
                                          : "reports its position in " + unit
                                                + " instead of microseconds, which is understood";
  }
  void ask() override
  {
    if (queried_ || !state_.plays())
      return;
    queried_ = local_time();
    call("Get", g_variant_new("(ss)", kPlayer, "Position"), on_position);
  }

private:
  guint subscribe(const char *interface, const char *signal, const char *argument,
                  GDBusSignalCallback callback)
  {
    return g_dbus_connection_signal_subscribe(bus_, bus_name_.c_str(), interface, signal, kPath,
                                              argument, G_DBUS_SIGNAL_FLAGS_NONE, callback, this,
                                              nullptr);
  }

  void call(const char *method, GVariant *arguments, GAsyncReadyCallback callback)
  {
    g_dbus_connection_call(bus_, bus_name_.c_str(), kPath, kProperties, method, arguments, nullptr,
                           G_DBUS_CALL_FLAGS_NO_AUTO_START, kAnswer, canceled_, callback, this);
  }

  void ask_all()
  {
    call("GetAll", g_variant_new("(s)", kPlayer), on_all);
  }

  /// The answer, or nothing; `is_over`: the player is no more, and `self` neither.
  static GVariant *answer(GObject *bus, GAsyncResult *result, bool &is_over)
  {
    g_autoptr(GError) error = nullptr;
    GVariant *value = g_dbus_connection_call_finish(G_DBUS_CONNECTION(bus), result, &error);
    is_over = g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
    return value;
  }

  static void on_all(GObject *bus, GAsyncResult *result, gpointer data)
  {
    bool is_over = false;
    g_autoptr(GVariant) value = answer(bus, result, is_over);
    if (value == nullptr || is_over)
      return;
    auto *self = static_cast<MprisPlayer *>(data);
    if (g_variant_is_of_type(value, G_VARIANT_TYPE("(a{sv})"))) {
      g_autoptr(GVariant) properties = g_variant_get_child_value(value, 0);
      self->state_.take(properties);
    }
    self->changed();
  }

  static void on_changed(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                         const gchar *, GVariant *parameters, gpointer data)
  {
    auto *self = static_cast<MprisPlayer *>(data);
    if (!g_variant_is_of_type(parameters, G_VARIANT_TYPE("(sa{sv}as)")))
      return;
    g_autoptr(GVariant) properties = g_variant_get_child_value(parameters, 1);
    g_autoptr(GVariant) invalidated = g_variant_get_child_value(parameters, 2);
    self->state_.take(properties);
    if (g_variant_n_children(invalidated) > 0)
      self->ask_all();
    self->changed();
  }

  static void on_seeked(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                        const gchar *, GVariant *parameters, gpointer data)
  {
    auto *self = static_cast<MprisPlayer *>(data);
    self->overtaken_ = self->queried_.has_value();
    self->position_.leap();
    Report report = self->state_.report(local_time());
    report.sought = true;
    if (g_variant_n_children(parameters) == 1) {
      g_autoptr(GVariant) position = g_variant_get_child_value(parameters, 0);
      report.position = self->shown(self->position_.meant(MprisPosition::number(position)));
    }
    self->events_.reported(report);
    self->ask();
  }

  static void on_position(GObject *bus, GAsyncResult *result, gpointer data)
  {
    bool is_over = false;
    g_autoptr(GVariant) value = answer(bus, result, is_over);
    if (is_over)
      return;
    auto *self = static_cast<MprisPlayer *>(data);
    const Time asked = self->queried_.value_or(Time(0));
    self->queried_.reset();
    if (std::exchange(self->overtaken_, false)) { // a notification came meanwhile
      self->ask();
      return;
    }
    std::optional<double> told;
    if (value != nullptr && g_variant_is_of_type(value, G_VARIANT_TYPE("(v)"))) {
      g_autoptr(GVariant) variant = g_variant_get_child_value(value, 0);
      g_autoptr(GVariant) position = g_variant_get_variant(variant);
      told = MprisPosition::number(position);
    }
    Report report = self->state_.report(local_time());
    report.asked = asked;
    report.position = self->shown(self->position_.take(told, report.received, report.rate));
    if (report.position)
      self->events_.reported(report);
  }

  /// The position of the screen when the player reports one.
  std::optional<Time> shown(std::optional<Time> position) const
  {
    return position ? std::optional(std::max(Time(0), *position - known_.later)) : position;
  }

  /// The player reported something else than a position.
  void changed()
  {
    overtaken_ = queried_.has_value();
    const Report report = state_.report(local_time());
    if (report.doing != Doing::playing || report.film != film_ || report.rate != rate_)
      position_.leap();
    film_ = report.film;
    rate_ = report.rate;
    events_.reported(report);
    ask();
    if (timer_ == 0 && state_.plays())
      timer_ = g_timeout_add(kAskEvery, on_timer, this);
  }

  static gboolean on_timer(gpointer data)
  {
    auto *self = static_cast<MprisPlayer *>(data);
    if (!self->state_.plays()) {
      self->timer_ = 0;
      return G_SOURCE_REMOVE;
    }
    self->ask();
    return G_SOURCE_CONTINUE;
  }

  const std::string bus_name_;
  const std::string name_;
  const Known known_;
  const PlayerEvents events_;
  GDBusConnection *bus_;
  GCancellable *canceled_;
  std::array<guint, 2> subscriptions_{};
  MprisState state_;
  MprisPosition position_;
  std::string film_;            ///< whose position it is
  double rate_ = 1;             ///< by which that goes
  std::optional<Time> queried_; ///< time of the query that awaits an answer
  bool overtaken_ = false;      ///< the state changed since
  guint timer_ = 0;
};

} // namespace

std::unique_ptr<Player>
open_mpris(GDBusConnection *bus, const std::string &bus_name, PlayerEvents events)
{
  return std::make_unique<MprisPlayer>(bus, bus_name, std::move(events));
}

} // namespace follow
