// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow_service.h"
#include "translation.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace {

constexpr const char *kName = "org.visuotactile.Follow1";
constexpr const char *kPath = "/org/visuotactile/Follow1";
constexpr int kAnswer = 5000; ///< ms

constexpr const char *kXml = R"(<node><interface name="org.visuotactile.Follow1">
  <method name="Nudge">
    <arg name="by" type="d" direction="in"/>
    <arg name="offset" type="d" direction="out"/>
  </method>
  <method name="NudgeFilm">
    <arg name="by" type="d" direction="in"/>
    <arg name="offset" type="d" direction="out"/>
  </method>
  <method name="PassOver"/>
  <property name="Player" type="s" access="read"/>
  <property name="State" type="s" access="read"/>
  <property name="Film" type="s" access="read"/>
  <property name="Track" type="s" access="read"/>
  <property name="Fault" type="s" access="read"/>
  <property name="Library" type="s" access="read"/>
  <property name="Position" type="d" access="read"/>
  <property name="Ahead" type="d" access="read"/>
  <property name="SyncTo" type="s" access="read"/>
  <property name="Latency" type="d" access="read"/>
  <property name="Offset" type="d" access="read"/>
  <property name="FilmOffset" type="d" access="read"/>
</interface></node>)";

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};

/// D-Bus carries UTF-8 only; names of files may be anything.
GVariant *
text(const std::string &value)
{
  return g_variant_new_take_string(g_utf8_make_valid(value.c_str(), -1));
}

GVariant *
property_of(const FollowStatus &status, std::string_view name)
{
  if (name == "Player")
    return text(status.player);
  if (name == "State")
    return text(status.state);
  if (name == "Film")
    return text(status.film);
  if (name == "Track")
    return text(status.track);
  if (name == "Fault")
    return text(status.fault);
  if (name == "Library")
    return text(status.library);
  if (name == "SyncTo")
    return text(status.sync_to);
  return g_variant_new_double(name == "Position"  ? status.position
                              : name == "Ahead"   ? status.ahead
                              : name == "Latency" ? status.latency
                              : name == "Offset"  ? status.offset
                                                  : status.film_offset);
}

/// Calls the follower that runs; starts none.
GVariant *
call(const char *interface, const char *method, GVariant *arguments, const char *answer)
{
  g_autoptr(GError) error = nullptr;
  const std::unique_ptr<GDBusConnection, Unref> bus(
      g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, &error));
  GVariant *reply = nullptr;
  if (bus)
    reply = g_dbus_connection_call_sync(bus.get(), kName, kPath, interface, method, arguments,
                                        G_VARIANT_TYPE(answer), G_DBUS_CALL_FLAGS_NO_AUTO_START,
                                        kAnswer, nullptr, &error);
  else
    g_variant_unref(g_variant_ref_sink(arguments));
  if (reply != nullptr)
    return reply;
  if (g_error_matches(error, G_DBUS_ERROR, G_DBUS_ERROR_SERVICE_UNKNOWN)
      || g_error_matches(error, G_DBUS_ERROR, G_DBUS_ERROR_NAME_HAS_NO_OWNER))
    throw std::runtime_error(_("no visuotactile-follow runs in this session; start it first"));
  g_dbus_error_strip_remote_error(error);
  throw std::runtime_error(in_text("no answer from visuotactile-follow: {}", error->message));
}

} // namespace

FollowService::FollowService(GDBusConnection *bus, Calls calls)
    : calls_(std::move(calls)), bus_(bus)
{
  g_object_ref(bus_);
  g_autoptr(GDBusNodeInfo) node = g_dbus_node_info_new_for_xml(kXml, nullptr);
  static const GDBusInterfaceVTable kTable = { on_call, on_get, nullptr, {} };
  object_ = g_dbus_connection_register_object(bus_, kPath, node->interfaces[0], &kTable, this,
                                              nullptr, nullptr);
  name_ = g_bus_own_name_on_connection(
      bus_, kName, G_BUS_NAME_OWNER_FLAGS_DO_NOT_QUEUE, nullptr,
      +[](GDBusConnection *connection, const gchar *, gpointer self) {
        if (connection != nullptr && !g_dbus_connection_is_closed(connection))
          static_cast<FollowService *>(self)->calls_.told(
              std::string("another visuotactile-follow has the name ") + kName
              + " on the session bus: --status and --nudge reach that one");
      },
      this, nullptr);
}

FollowService::~FollowService()
{
  g_bus_unown_name(name_);
  g_dbus_connection_unregister_object(bus_, object_);
  g_object_unref(bus_);
}

void
FollowService::on_call(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                       const gchar *method, GVariant *arguments, GDBusMethodInvocation *invocation,
                       gpointer self)
{
  const Calls &calls = static_cast<FollowService *>(self)->calls_;
  try {
    if (std::string_view(method) == "PassOver") {
      calls.pass_over();
      g_dbus_method_invocation_return_value(invocation, nullptr);
      return;
    }
    double by = 0;
    g_variant_get(arguments, "(d)", &by);
    if (!std::isfinite(by))
      throw std::runtime_error(_("expected a number of ms"));
    const auto &nudge = std::string_view(method) == "NudgeFilm" ? calls.nudge_film : calls.nudge;
    g_dbus_method_invocation_return_value(invocation, g_variant_new("(d)", nudge(by)));
  } catch (const std::runtime_error &error) {
    g_dbus_method_invocation_return_error_literal(invocation, G_DBUS_ERROR, G_DBUS_ERROR_FAILED,
                                                  error.what());
  }
}

GVariant *
FollowService::on_get(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                      const gchar *property, GError **, gpointer self)
{
  return property_of(static_cast<FollowService *>(self)->calls_.status(), property);
}

FollowStatus
ask_status()
{
  g_autoptr(GVariant) answer
      = call("org.freedesktop.DBus.Properties", "GetAll", g_variant_new("(s)", kName), "(a{sv})");
  g_autoptr(GVariant) all = g_variant_get_child_value(answer, 0);
  const auto words = [&](const char *name) {
    const gchar *value = "";
    g_variant_lookup(all, name, "&s", &value);
    return std::string(value);
  };
  const auto number = [&](const char *name) {
    double value = -1;
    g_variant_lookup(all, name, "d", &value);
    return value;
  };
  return { .player = words("Player"),
           .state = words("State"),
           .film = words("Film"),
           .track = words("Track"),
           .library = words("Library"),
           .fault = words("Fault"),
           .position = number("Position"),
           .ahead = number("Ahead"),
           .sync_to = words("SyncTo"),
           .latency = number("Latency"),
           .offset = number("Offset"),
           .film_offset = number("FilmOffset") };
}

double
send_nudge(double by, bool of_film)
{
  g_autoptr(GVariant) answer
      = call(kName, of_film ? "NudgeFilm" : "Nudge", g_variant_new("(d)", by), "(d)");
  double offset = 0;
  g_variant_get(answer, "(d)", &offset);
  return offset;
}

void
send_pass_over()
{
  g_variant_unref(call(kName, "PassOver", g_variant_new("()"), "()"));
}
