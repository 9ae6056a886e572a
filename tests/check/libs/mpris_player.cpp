// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A player on a bus of its own, which tells and answers what each test wants.
#include "follow/players/mpris_player.h"
#include "follow/players/mpris_bus.h"
#include "follow/players/mpris_position.h"
#include "follow/players/mpris_state.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr const char *kName = "org.mpris.MediaPlayer2.fake";
constexpr const char *kInterface = "org.mpris.MediaPlayer2.Player";
constexpr const char *kXml = R"(<node><interface name="org.mpris.MediaPlayer2.Player">
  <property name="PlaybackStatus" type="s" access="read"/>
  <property name="Rate" type="d" access="read"/>
  <property name="Position" type="x" access="read"/>
  <property name="Metadata" type="a{sv}" access="read"/>
  <signal name="Seeked"><arg type="x"/></signal>
</interface></node>)";

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};
using Connection = std::unique_ptr<GDBusConnection, Unref>;

/// A session bus with a player, whose calls are answered by this thread's main loop.
class Stage
{
public:
  Stage() : bus_(g_test_dbus_new(G_TEST_DBUS_NONE))
  {
    g_test_dbus_up(bus_);
    theirs = connect();
    ours = connect();
    g_autoptr(GDBusNodeInfo) node = g_dbus_node_info_new_for_xml(kXml, nullptr);
    static const GDBusInterfaceVTable kTable = { nullptr, read, nullptr, {} };
    fail_unless(g_dbus_connection_register_object(theirs.get(), "/org/mpris/MediaPlayer2",
                                                  node->interfaces[0], &kTable, this, nullptr,
                                                  nullptr)
                != 0);
  }
  ~Stage()
  {
    ours.reset();
    theirs.reset();
    g_test_dbus_down(bus_);
    g_object_unref(bus_);
  }
  Stage(const Stage &) = delete;
  Stage &operator=(const Stage &) = delete;

  Connection connect() const
  {
    GDBusConnection *connection = g_dbus_connection_new_for_address_sync(
        g_test_dbus_get_bus_address(bus_),
        static_cast<GDBusConnectionFlags>(G_DBUS_CONNECTION_FLAGS_AUTHENTICATION_CLIENT
                                          | G_DBUS_CONNECTION_FLAGS_MESSAGE_BUS_CONNECTION),
        nullptr, nullptr, nullptr);
    fail_unless(connection != nullptr);
    return Connection(connection);
  }

  void own(const char *name) const
  {
    own(name, theirs.get());
  }
  static void own(const char *name, GDBusConnection *connection)
  {
    g_autoptr(GVariant) answer = g_dbus_connection_call_sync(
        connection, "org.freedesktop.DBus", "/org/freedesktop/DBus", "org.freedesktop.DBus",
        "RequestName", g_variant_new("(su)", name, 0U), nullptr, G_DBUS_CALL_FLAGS_NONE, -1,
        nullptr, nullptr);
    fail_unless(answer != nullptr);
  }
  void tell_change(const char *property, GVariant *value) const
  {
    GVariantBuilder changed;
    g_variant_builder_init(&changed, G_VARIANT_TYPE_VARDICT);
    g_variant_builder_add(&changed, "{sv}", property, value);
    emit("org.freedesktop.DBus.Properties", "PropertiesChanged",
         g_variant_new("(sa{sv}as)", kInterface, &changed, nullptr));
  }
  void tell_seek(gint64 to) const
  {
    emit(kInterface, "Seeked", g_variant_new("(x)", to));
  }

  PlayerEvents events()
  {
    return { .reported = [this](const Report &report) { reports.push_back(report); }, .gone = {} };
  }
  /// Runs the main loop until a report of which `is_it` holds, and returns that. Reports before it
  /// are dropped. The test's time limit ends the wait.
  template <class Predicate> Report wait_for(Predicate is_it)
  {
    while (true) {
      const auto found = std::ranges::find_if(reports, is_it);
      if (found != reports.end()) {
        const Report report = *found;
        reports.erase(reports.begin(), found + 1);
        return report;
      }
      g_main_context_iteration(nullptr, TRUE);
    }
  }

  Connection theirs;
  Connection ours;
  std::vector<Report> reports;
  std::string status = "Playing";
  gint64 microseconds = 5'000'000;
  std::function<GVariant *(const Stage &)> position; ///< as something else
  double rate = 1;

private:
  void emit(const char *interface, const char *signal, GVariant *arguments) const
  {
    fail_unless(g_dbus_connection_emit_signal(theirs.get(), nullptr, "/org/mpris/MediaPlayer2",
                                              interface, signal, arguments, nullptr));
  }

  static GVariant *read(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                        const gchar *name, GError **, gpointer data)
  {
    auto *self = static_cast<Stage *>(data);
    const std::string property = name;
    if (property == "PlaybackStatus")
      return g_variant_new_string(self->status.c_str());
    if (property == "Rate")
      return g_variant_new_double(self->rate);
    if (property == "Position")
      return self->position ? self->position(*self) : g_variant_new_int64(self->microseconds);
    GVariantBuilder metadata;
    g_variant_builder_init(&metadata, G_VARIANT_TYPE_VARDICT);
    g_variant_builder_add(&metadata, "{sv}", "xesam:url",
                          g_variant_new_string("file:///films/a%20b.mkv"));
    return g_variant_builder_end(&metadata);
  }

  GTestDBus *bus_;
};

bool
has_position(const Report &report)
{
  return report.position.has_value();
}

} // namespace

CHECK_TEST(test_asks_while_it_plays)
{
  Stage stage;
  stage.own(kName);
  const auto player = open_mpris(stage.ours.get(), kName, stage.events());
  ck_assert_str_eq(player->name().c_str(), "fake");
  Report report = stage.wait_for(has_position);
  ck_assert(report.position == 5s && report.doing == Doing::playing && report.rate == 1);
  ck_assert(report.film == "file:///films/a%20b.mkv");
  fail_if(report.sought);
  ck_assert(report.asked.has_value() && *report.asked <= report.received);
  // Again and again, without being told to.
  stage.microseconds = 6'000'000;
  report = stage.wait_for([](const Report &one) { return one.position == 6s; });
  ck_assert(report.doing == Doing::playing);
  for (int i = 0; i < 3; i++)
    stage.wait_for(has_position);

  stage.status = "Paused";
  stage.tell_change("PlaybackStatus", g_variant_new_string("Paused"));
  report = stage.wait_for([](const Report &one) { return one.doing == Doing::paused; });
  fail_if(report.position.has_value());
  stage.tell_change("Rate", g_variant_new_double(1.5));
  report = stage.wait_for([](const Report &one) { return one.rate == 1.5; });
  ck_assert(report.doing == Doing::paused);
  stage.tell_change("PlaybackStatus", g_variant_new_string("Stopped"));
  stage.wait_for([](const Report &one) { return one.doing == Doing::stopped; });
}

CHECK_TEST(test_seek)
{
  Stage stage;
  stage.own(kName);
  const auto player = open_mpris(stage.ours.get(), kName, stage.events());
  stage.wait_for(has_position);
  stage.microseconds = 300'000'000;
  stage.tell_seek(300'000'000);
  const Report report = stage.wait_for([](const Report &one) { return one.sought; });
  ck_assert(report.position == 300s);
}

/// Chromium's picture is behind the position that it tells, which it renews now and then.
CHECK_TEST(test_known_player)
{
  constexpr const char *kChromium = "org.mpris.MediaPlayer2.chromium.instance7";
  Stage stage;
  stage.own(kChromium);
  const auto player = open_mpris(stage.ours.get(), kChromium, stage.events());
  fail_unless(player->habits().lingers && player->habits().coarseness == 200ms);
  fail_unless(player->sound_latency() == 30ms);
  ck_assert(stage.wait_for(has_position).position == 5s - 60ms);
  stage.tell_seek(10'000);
  ck_assert(stage.wait_for([](const Report &one) { return one.sought; }).position == 0s);
}

/// What is no time is none, and what is of another type than it should be is left out.
CHECK_TEST(test_nonsense)
{
  const MprisPosition meaning;
  for (const gint64 microseconds : { gint64{ -1 }, G_MAXINT64, G_MININT64 }) {
    g_autoptr(GVariant) position = g_variant_ref_sink(g_variant_new_int64(microseconds));
    fail_if(meaning.meant(MprisPosition::number(position)).has_value());
  }
  g_autoptr(GVariant) text = g_variant_ref_sink(g_variant_new_string("5"));
  fail_if(MprisPosition::number(text).has_value());
  fail_if(meaning.meant(std::nullopt).has_value() || meaning.meant(NAN).has_value());

  MprisState state;
  state.take(text);
  ck_assert(state.report(1s).doing == Doing::stopped && state.report(1s).film.empty());
  const std::string long_name(5000, 'a');
  g_autoptr(GVariant) strange = g_variant_ref_sink(
      g_variant_new_parsed("{'PlaybackStatus': <'Playing'>, 'Rate': <'fast'>, 'Position': <'x'>,"
                           " 'Metadata': <{'xesam:url': <7>, 'xesam:title': <%s>}>}",
                           long_name.c_str()));
  state.take(strange);
  ck_assert(state.report(1s).doing == Doing::playing && state.report(1s).rate == 1);
  ck_assert(state.report(1s).film.empty());
  g_autoptr(GVariant) titled
      = g_variant_ref_sink(g_variant_new_parsed("{'Metadata': <{'xesam:title': <'A film'>}>}"));
  state.take(titled);
  ck_assert(state.report(1s).film == "A film");
}

/// Whatever number it is.
CHECK_TEST(test_types)
{
  const auto is = [](GVariant *value, double number) {
    g_autoptr(GVariant) owned = g_variant_ref_sink(value);
    fail_unless(MprisPosition::number(owned) == number, "%s", g_variant_get_type_string(owned));
  };
  is(g_variant_new_int64(5'000'000), 5e6);
  is(g_variant_new_uint64(5'000'000), 5e6);
  is(g_variant_new_int32(5'000'000), 5e6);
  is(g_variant_new_uint32(5'000'000), 5e6);
  is(g_variant_new_double(5'000'000.5), 5'000'000.5);
  Stage stage;
  stage.own(kName);
  stage.position = [](const Stage &self) {
    return g_variant_new_double(static_cast<double>(self.microseconds));
  };
  const auto player = open_mpris(stage.ours.get(), kName, stage.events());
  ck_assert(stage.wait_for(has_position).position == 5s);
  stage.tell_seek(300'000'000);
  ck_assert(stage.wait_for([](const Report &one) { return one.sought; }).position == 300s);
}

namespace {
/// A film that plays from ten seconds on and is asked after each 155 ms. What is told, and what
/// that means: the last of it.
std::optional<Time>
heard(MprisPosition &meaning, Time from, Time to, double rate,
      const std::function<std::optional<double>(Time)> &told)
{
  std::optional<Time> position;
  for (Time now = from; now <= to; now += 155ms)
    position = meaning.take(told(10s + std::chrono::duration_cast<Time>(now * rate)), now, rate);
  return position;
}
} // namespace

/// The unit is that by which the position goes as fast as the film.
CHECK_TEST(test_units)
{
  struct Case
  {
    double nanoseconds;
    const char *unit;
    Time renewed; ///< each so often
  };
  for (const Case &one : { Case{ 1e3, "microseconds", 1ms }, Case{ 1e6, "milliseconds", 1ms },
                           Case{ 1, "nanoseconds", 1ms }, Case{ 1e3, "microseconds", 290ms },
                           Case{ 1e6, "milliseconds", 290ms }, Case{ 1e3, "microseconds", 1s } })
    for (const double rate : { 0.5, 1.0, 4.0 }) {
      MprisPosition meaning;
      const auto told = [&](Time film) -> std::optional<double> {
        const Time known = film / one.renewed * one.renewed;
        return static_cast<double>(known.count()) / one.nanoseconds;
      };
      std::optional<Time> position = heard(meaning, 0s, 10s, rate, told);
      ck_assert_str_eq(meaning.unit(), one.unit);
      fail_unless(position && std::chrono::abs(*position - 10s - 10s * rate) < 155ms * rate + 1s);
      fail_unless(meaning.fault() == "");
      // Another film, and a leap that nobody tells, by which milliseconds become nanoseconds for
      // once.
      meaning.leap();
      heard(meaning, 20s, 22s, rate, told);
      meaning.take(told(Time(1000s)).value() * 1000, 22s + 155ms, rate);
      position = heard(meaning, 23s, 28s, rate, told);
      ck_assert_str_eq(meaning.unit(), one.unit);
      fail_unless(meaning.fault() == "");
    }
}

/// A position that is of no use is called so, after a while, and no longer when it is one.
CHECK_TEST(test_no_usable_position)
{
  const std::pair<std::function<std::optional<double>(Time)>, const char *> cases[] = {
    { [](Time) { return 0.0; }, "stays the same" },
    { [](Time) { return 5e6; }, "stays the same" },
    { [](Time) { return -1.0; }, "reports none" },
    { [](Time) { return std::nullopt; }, "reports none" },
    { [](Time film) { return static_cast<double>(film / 1s); }, "does not go as the film plays" },
  };
  for (const auto &[told, fault] : cases) {
    MprisPosition meaning;
    heard(meaning, 0s, 2900ms, 1, told);
    fail_unless(meaning.fault() == "");
    heard(meaning, 3s, 8s, 1, told);
    fail_unless(meaning.fault().find(fault) != std::string::npos, "%s, not %s",
                meaning.fault().c_str(), fault);
    const auto right = [](Time film) {
      return static_cast<double>(film / 1us);
    };
    heard(meaning, 9s, 15s, 1, right);
    fail_unless(meaning.fault() == "");
  }
}

/// Players that were there before, that come and that go.
CHECK_TEST(test_bus)
{
  Stage stage;
  stage.own(kName);
  stage.own("org.example.no_player");
  std::vector<std::string> told;
  MprisBus names(stage.ours.get(), "",
                 { .appeared = [&](const std::string &name) { told.push_back("+" + name); },
                   .vanished =
                       [&](const std::string &name) {
                         told.push_back("-" + name);
                       } });
  const auto wait_for = [&told](const std::string &what) {
    while (std::ranges::find(told, what) == told.end())
      g_main_context_iteration(nullptr, TRUE);
  };
  wait_for(std::string("+") + kName);
  const Connection others = stage.connect();
  Stage::own("org.mpris.MediaPlayer2.other", others.get());
  wait_for("+org.mpris.MediaPlayer2.other");
  fail_unless(g_dbus_connection_close_sync(stage.theirs.get(), nullptr, nullptr));
  fail_unless(g_dbus_connection_close_sync(others.get(), nullptr, nullptr));
  wait_for(std::string("-") + kName);
  wait_for("-org.mpris.MediaPlayer2.other");
  for (const std::string &name : told)
    fail_if(name.find("no_player") != std::string::npos);
}

/// VLC has two names. It is one player, by the name that is wanted.
CHECK_TEST(test_two_names)
{
  constexpr const char *kSecond = "org.mpris.MediaPlayer2.fake.instance7";
  Stage stage;
  std::vector<std::string> all;
  std::vector<std::string> second;
  const auto telling = [](std::vector<std::string> &told) {
    return MprisBus::Events{ .appeared
                             = [&](const std::string &name) { told.push_back("+" + name); },
                             .vanished =
                                 [&](const std::string &name) {
                                   told.push_back("-" + name);
                                 } };
  };
  const auto wait_for = [](const std::vector<std::string> &told, const std::string &what) {
    while (std::ranges::find(told, what) == told.end())
      g_main_context_iteration(nullptr, TRUE);
  };
  const std::string first_came = std::string("+") + kName;
  const std::string first_went = std::string("-") + kName;
  // It comes while somebody looks, and is there when somebody begins to look.
  const MprisBus names(stage.ours.get(), "", telling(all));
  const MprisBus one(stage.ours.get(), "fake.instance7", telling(second));
  stage.own(kName);
  stage.own(kSecond);
  wait_for(second, std::string("+") + kSecond);
  ck_assert(all == std::vector{ first_came });
  std::vector<std::string> later;
  {
    const MprisBus late(stage.ours.get(), "", telling(later));
    wait_for(later, first_came);
    fail_unless(g_dbus_connection_close_sync(stage.theirs.get(), nullptr, nullptr));
    wait_for(later, first_went);
    wait_for(all, first_went);
    wait_for(second, std::string("-") + kSecond);
  }
  ck_assert((all == std::vector{ first_came, first_went }));
  ck_assert((later == std::vector{ first_came, first_went }));
  ck_assert_int_eq(static_cast<int>(second.size()), 2);
}

CHECK_MAIN(mpris_player)
