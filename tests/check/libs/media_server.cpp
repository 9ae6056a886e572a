// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Sessions in the form of the public API descriptions of Jellyfin, Emby and Plex, and how exactly a
// position is known from them.
#include "follow/players/media_server.h"
#include "follow/position_estimator.h"

#include <algorithm>
#include <cmath>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

std::string
session(const std::string &device, Time position, bool is_paused = false,
        const std::string &item = R"("MediaType":"Video","Name":"Film","Path":"/films/Film.mkv")")
{
  return R"({"PlayState":{"PositionTicks":)" + std::to_string(position.count() / 100)
         + R"(,"CanSeek":true,"IsPaused":)" + (is_paused ? "true" : "false")
         + R"(,"PlayMethod":"DirectPlay"},"Client":"Jellyfin Roku","DeviceName":")" + device
         + R"(","NowPlayingItem":{)" + item + "}}";
}

std::string
list(const std::string &sessions)
{
  return "[" + sessions + "]";
}

std::string
plex(Time position, const std::string &state = "playing", const std::string &type = "movie")
{
  return R"({"MediaContainer":{"size":1,"Metadata":[{"type":")" + type
         + R"(","title":"Film","duration":5262112,"viewOffset":)" + std::to_string(position / 1ms)
         + R"(,"Media":[{"id":"1","Part":[{"file":"/films/other.mkv"}]},)"
           R"({"selected":true,"Part":[{"file":"/films/Film.mkv","selected":true}]}],)"
           R"("Player":{"title":"Television","state":")"
         + state + R"("}}]}})";
}

Report
heard(MediaServer &server, const std::string &answer, Time now = 1s)
{
  const auto report = server.received(answer, now - 5ms, now);
  fail_unless(report.has_value(), "%s", report.has_value() ? "" : report.error().c_str());
  return *report;
}

/// How long the position was unknown at first, and its largest error from then on.
struct Result
{
  Time unknown{ 0 };
  Time most_error{ 0 };
  int gaps = 0; ///< moments without a position later
};

/// A film from 0:00 on at local time 100 s for a minute. `told` is the position that the server has
/// at a time of the film.
template <typename Told>
Result
follow_film(ServerKind kind, Told told)
{
  constexpr Time kBegin = 100s;
  MediaServer server(kind, "");
  PositionEstimator estimator({ .habits = MediaServer::habits(kind) });
  Result result;
  bool is_known = false;
  for (Time now = kBegin; now < kBegin + 60s; now += MediaServer::kAskEvery) {
    const Time position = told(now - kBegin);
    const auto report = server.received(
        kind == ServerKind::plex ? plex(position) : list(session("Television", position)), now,
        now + 4ms);
    fail_unless(report.has_value());
    estimator.report(*report);
    for (Time later = now + 5ms; later < now + MediaServer::kAskEvery; later += 20ms) {
      const auto estimate = estimator.at(later);
      if (estimate) {
        const Time error = estimate->position - (later - kBegin);
        result.most_error = std::max(result.most_error, error < 0ms ? -error : error);
        if (!is_known)
          result.unknown = later - kBegin;
        is_known = true;
      } else if (is_known)
        result.gaps++;
    }
  }
  fail_unless(is_known);
  return result;
}

} // namespace

CHECK_TEST(test_query)
{
  const auto jellyfin = MediaServer::query(ServerKind::jellyfin, "abc");
  fail_unless(jellyfin.path == "Sessions"
              && jellyfin.headers[0].second == "MediaBrowser Token=\"abc\"");
  fail_unless(MediaServer::query(ServerKind::emby, "abc").headers[0].first == "X-Emby-Token");
  const auto of_plex = MediaServer::query(ServerKind::plex, "abc");
  fail_unless(of_plex.path == "status/sessions" && of_plex.headers[1].second == "application/json");
}

CHECK_TEST(test_sessions)
{
  MediaServer server(ServerKind::jellyfin, "");
  fail_unless(heard(server, "[]").doing == Doing::stopped);
  fail_unless(heard(server, R"([{"DeviceName":"idle"}])").doing == Doing::stopped);
  const Report one = heard(server, list(session("A", 61500ms)));
  fail_unless(one.doing == Doing::playing && one.position == 61500ms && one.asked == 995ms);
  ck_assert_str_eq(one.film.c_str(), "/films/Film.mkv");
  fail_unless(heard(server, list(session("A", 2s, true))).doing == Doing::paused);
  fail_unless(
      heard(server, list(session("A", 2s, false, R"("MediaType":"Video","Name":"Film")"))).film
      == "Film");
  fail_unless(
      heard(server, list(session("A", 2s, false, R"("MediaType":"Audio","Name":"Song")"))).doing
      == Doing::stopped);
}

CHECK_TEST(test_two_devices)
{
  MediaServer server(ServerKind::emby, "");
  const std::string a = session("A", 1s);
  const std::string b = session("B", 2s);
  fail_unless(heard(server, list(a + "," + b)).doing == Doing::stopped);
  fail_unless(server.fault().find("'A' and 'B'") != std::string::npos);
  // The one that was followed first stays, in any order.
  fail_unless(heard(server, list(a)).position == 1s && server.fault().empty());
  fail_unless(heard(server, list(b + "," + a)).position == 1s && server.fault().empty());
  // It has paused: the other one plays.
  fail_unless(heard(server, list(session("A", 1s, true) + "," + b)).position == 2s);
  // Two that are paused are no fault, and none is prepared.
  MediaServer paused(ServerKind::emby, "");
  fail_unless(heard(paused, list(session("A", 1s, true) + "," + session("B", 1s, true))).doing
                  == Doing::stopped
              && paused.fault().empty());
  MediaServer named(ServerKind::emby, "b");
  fail_unless(heard(named, list(a + "," + b)).position == 2s && named.fault().empty());
  fail_unless(heard(named, list(a)).doing == Doing::stopped);
}

/// Two sessions of one name, of which the server puts another one first each time; a path of
/// Windows; a television that is switched off, which the server does not know.
CHECK_TEST(test_sessions_of_one_name)
{
  const auto one = [](const char *id, const char *report, Time position) {
    return std::string(R"({"Id":")") + id + R"(","LastPlaybackCheckIn":")" + report + "\","
           + session("Chrome", position, false,
                     R"("MediaType":"Video","Path":"D:\\\\Films\\\\Film.mkv")")
                 .substr(1);
  };
  MediaServer server(ServerKind::jellyfin, "");
  const Report first = heard(server, list(one("a", "t", 1s)));
  ck_assert_str_eq(first.film.c_str(), "Film.mkv");
  for (int i = 0; i < 3; i++) {
    fail_unless(heard(server, list(one("b", "u", 7s) + "," + one("a", "t", 2s))).position == 2s);
    fail_unless(heard(server, list(one("a", "t", 2s) + "," + one("b", "u", 7s))).position == 2s);
  }
  fail_unless(heard(server, list(one("a", "t", 30s)), 29s).doing == Doing::playing);
  fail_unless(heard(server, list(one("a", "t", 33s)), 32s).doing == Doing::stalled);
  fail_unless(heard(server, list(one("a", "v", 34s)), 33s).doing == Doing::playing);
}

/// Positions that changed while the server did not answer are of no use, and that is reported.
CHECK_TEST(test_slow_plex)
{
  MediaServer server(ServerKind::plex, "");
  heard(server, plex(0s), 1s);
  for (int i = 1; i < 4; i++)
    fail_unless(!heard(server, plex(i * 10s), 1s + i * 10s).position);
  heard(server, plex(30s), 31100ms);
  fail_unless(server.fault().find("too slowly") != std::string::npos);
}

CHECK_TEST(test_plex)
{
  MediaServer server(ServerKind::plex, "");
  fail_unless(heard(server, R"({"MediaContainer":{"size":0}})").doing == Doing::stopped);
  // A film that begins has a position of this moment; later only one that changes has.
  const Report first = heard(server, plex(5s), 1100ms);
  fail_unless(first.position == 5s && !first.asked);
  ck_assert_str_eq(first.film.c_str(), "/films/Film.mkv");
  fail_unless(!heard(server, plex(5s), 1250ms).position);
  fail_unless(heard(server, plex(15s), 1400ms).position == 15s);
  fail_unless(!heard(server, plex(25s), 9s).position, "changed at an unknown time");
  fail_unless(heard(server, plex(25s, "paused"), 9100ms).doing == Doing::paused);
  fail_unless(heard(server, plex(25s, "buffering"), 9200ms).doing == Doing::stalled);
  fail_unless(heard(server, plex(25s, "playing", "track"), 9300ms).doing == Doing::stopped);
  MediaServer late(ServerKind::plex, "");
  fail_unless(!heard(late, plex(5s)).position, "it may be ten seconds old");
}

CHECK_TEST(test_strange_answers)
{
  for (const ServerKind kind : kServerKinds)
    for (const char *answer :
         { "", "<html>", "{}", "null", "7", R"({"MediaContainer":7})", R"({"MediaContainer":[]})",
           R"({"MediaContainer":{"size":1}})", "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[" })
      fail_unless(!MediaServer(kind, "").received(answer, 0s, 1ms), "%s takes %s", name_of(kind),
                  answer);
  MediaServer server(ServerKind::jellyfin, "");
  fail_unless(
      heard(
          server,
          R"([7,null,[],{"NowPlayingItem":7,"PlayState":7},{"NowPlayingItem":{},"PlayState":{}}])")
          .doing
      == Doing::stopped);
  const Report report = heard(
      server,
      R"([{"DeviceName":7,"PlayState":{"PositionTicks":-1,"IsPaused":"x","PlaybackRate":"fast"},)"
      R"("NowPlayingItem":{"MediaType":"Video","Name":"Film"}}])");
  fail_unless(!report.position && report.doing == Doing::playing && report.rate == 1);
}

/// The server adds a second after each second that its timer, 3 ms late, has counted; the player
/// reports each 10 s. The delay of its reports cannot be known.
CHECK_TEST(test_seconds)
{
  for (const Time late : { 0ms, 3ms })
    for (const Time begin : { 20ms, 77ms, 110ms }) {
      const Result result = follow_film(ServerKind::jellyfin, [&](Time film) {
        const Time since = std::max(film - begin, Time(0));
        const Time reported = since / 10s * 10s;
        return reported + (since - reported) / (1s + late) * 1s;
      });
      fail_unless(result.unknown < 8s, "unknown for %g s", 1e-9 * result.unknown.count());
      fail_unless(result.most_error < begin + 100ms, "error of %g s",
                  1e-9 * result.most_error.count());
      ck_assert_int_eq(result.gaps, 0);
    }
}

CHECK_TEST(test_ten_seconds)
{
  const Result result = follow_film(
      ServerKind::plex, [](Time film) { return std::max(film - 20ms, Time(0)) / 10s * 10s; });
  fail_unless(result.unknown < 11s, "unknown for %g s", 1e-9 * result.unknown.count());
  fail_unless(result.most_error < 20ms + 120ms, "error of %g s", 1e-9 * result.most_error.count());
  ck_assert_int_eq(result.gaps, 0);
}

CHECK_MAIN(media_server)
