// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What Kodi 20.1 says at its JSON-RPC, as recorded, and what could be said instead.
#include "follow/players/kodi_conversation.h"
#include "follow/players/json_stream.h"

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

/// By which Kodi's picture is ahead of the position that it tells.
constexpr Time kAhead = 75ms;

bool
contains(const std::string &text, const char *part)
{
  return text.find(part) != std::string::npos;
}

struct Talk
{
  KodiConversation::Heard hears(const std::string &object)
  {
    now += 1ms;
    return talk.received(object, now);
  }
  /// An answer to the last question but `before`.
  KodiConversation::Heard answer(const std::string &result, int before = 0)
  {
    return hears(R"({"id":)" + std::to_string(questions - before) + R"(,"jsonrpc":"2.0",)" + result
                 + "}");
  }
  KodiConversation::Heard notes(const char *what, const std::string &player)
  {
    const auto heard
        = hears(std::string(R"({"jsonrpc":"2.0","method":"Player.)") + what
                + R"(","params":{"data":{"item":{"title":"film.mkv","type":"movie"},"player":)"
                + player + R"(},"sender":"xbmc"}})");
    count(heard.questions);
    return heard;
  }
  void count(const std::string &asked)
  {
    for (std::size_t at = asked.find("\"id\""); at != std::string::npos;
         at = asked.find("\"id\"", at + 1))
      questions++;
  }
  /// Answers who plays, what, where and how fast. The last report.
  Report tells(const char *position, const char *speed)
  {
    const auto heard
        = answer(R"("result":[{"playerid":0,"type":"audio"},{"playerid":1,"type":"video"}])");
    fail_unless(contains(heard.questions, "Player.GetItem")
                && contains(heard.questions, R"("playerid":1)"));
    count(heard.questions);
    answer(R"("result":{"item":{"file":"/films/film.mkv","label":"film.mkv","type":"unknown"}})",
           1);
    return properties(position, speed).report.value_or(Report{});
  }
  KodiConversation::Heard properties(const char *time, const char *speed)
  {
    return answer(std::string(R"("result":{"speed":)") + speed + R"(,"time":)" + time + "}");
  }
  void ask()
  {
    const std::string asked = talk.ask(now);
    fail_unless(contains(asked, R"("properties":["time","speed"])"), "%s", asked.c_str());
    count(asked);
  }
  void begin()
  {
    count(talk.begin(now));
  }

  Time now = 5s;
  int questions = 0;
  KodiConversation talk;
};

constexpr const char *kFiveSeconds = R"({"hours":0,"milliseconds":250,"minutes":0,"seconds":5})";
constexpr const char *kTwoHours = R"({"hours":2,"milliseconds":7,"minutes":3,"seconds":4})";

} // namespace

CHECK_TEST(test_play)
{
  Talk talk;
  talk.begin();
  Report report = talk.tells(kFiveSeconds, "1");
  ck_assert(report.doing == Doing::playing && report.rate == 1);
  ck_assert(report.position == 5250ms + kAhead);
  ck_assert_str_eq(report.film.c_str(), "/films/film.mkv");
  fail_if(report.sought);

  const Time asked = talk.now;
  talk.ask();
  fail_unless(talk.talk.ask(talk.now).empty(), "asked twice");
  report = talk.properties(kTwoHours, "2").report.value_or(Report{});
  ck_assert(report.position == 2h + 3min + 4s + 7ms + kAhead && report.rate == 2);
  ck_assert(report.asked == asked && report.received == talk.now);

  talk.ask();
  report = talk.properties(kTwoHours, "0").report.value_or(Report{});
  ck_assert(report.doing == Doing::paused);
  talk.now += 900ms;
  fail_unless(talk.talk.ask(talk.now).empty(), "asked in a pause");
}

/// A pause is told before anything is asked; an answer that was on its way does not count.
CHECK_TEST(test_pause)
{
  Talk talk;
  talk.begin();
  talk.tells(kFiveSeconds, "1");
  talk.ask();
  const auto heard = talk.notes("OnPause", R"({"playerid":1,"speed":0})");
  fail_unless(heard.report.has_value() && heard.report->doing == Doing::paused);
  fail_unless(contains(heard.questions, "Player.GetActivePlayers"));
  fail_if(talk.answer(R"("result":{"speed":1,"time":{"hours":0,"milliseconds":0,"minutes":0,)"
                      R"("seconds":5}})",
                      1)
              .report.has_value());
  ck_assert(talk.tells(kFiveSeconds, "0").doing == Doing::paused);
  // Another player's pause is none of the film.
  talk.notes("OnResume", R"({"playerid":1,"speed":1})");
  ck_assert(talk.tells(kFiveSeconds, "1").doing == Doing::playing);
  fail_if(talk.notes("OnPause", R"({"playerid":0,"speed":0})").report.has_value());
}

/// After a seek, Kodi tells for a while where it was.
CHECK_TEST(test_seek)
{
  Talk talk;
  talk.begin();
  talk.tells(kFiveSeconds, "1");
  const auto heard = talk.notes(
      "OnSeek", R"({"playerid":1,"seekoffset":{"hours":0,"milliseconds":0,"minutes":0,)"
                R"("seconds":20},"speed":1,"time":{"hours":0,"milliseconds":842,)"
                R"("minutes":0,"seconds":24}})");
  fail_unless(heard.report.has_value() && heard.report->sought);
  ck_assert(heard.report->doing == Doing::stalled && !heard.report->position);
  ck_assert(talk.tells(kFiveSeconds, "1").film.empty()); // no report: that is of before
  talk.ask();
  Report report = talk.properties(R"({"hours":0,"milliseconds":900,"minutes":0,"seconds":24})", "1")
                      .report.value_or(Report{});
  ck_assert(report.position == 24900ms + kAhead && report.sought && report.doing == Doing::playing);
  talk.ask();
  report = talk.properties(R"({"hours":0,"milliseconds":0,"minutes":0,"seconds":25})", "1")
               .report.value_or(Report{});
  ck_assert(report.position == 25s + kAhead && !report.sought);

  // It does not land where it said: that is believed in the end.
  talk.notes("OnSeek", R"({"playerid":1,"speed":1,"time":{"hours":1,"milliseconds":0,"minutes":0,)"
                       R"("seconds":0}})");
  ck_assert(talk.tells(kFiveSeconds, "1").film.empty());
  talk.now += 4s;
  talk.ask();
  report = talk.properties(kFiveSeconds, "1").report.value_or(Report{});
  ck_assert(report.position == 5250ms + kAhead && report.sought);
}

CHECK_TEST(test_films)
{
  Talk talk;
  talk.begin();
  auto heard = talk.answer(R"("result":[])");
  ck_assert(heard.report && heard.report->doing == Doing::stopped);
  fail_unless(talk.talk.ask(talk.now).empty());
  talk.now += 1s;
  fail_unless(contains(talk.talk.ask(talk.now), "Player.GetActivePlayers")); // once a second
  talk.questions++;
  ck_assert(talk.tells(kFiveSeconds, "1").film == "/films/film.mkv");

  // The next one is unknown until its name is told.
  heard = talk.notes("OnPlay", R"({"playerid":1,"speed":1})");
  ck_assert(heard.report && heard.report->doing == Doing::stopped && heard.report->film.empty());
  talk.count(talk.answer(R"("result":[{"playerid":1,"type":"video"}])").questions);
  heard = talk.answer(R"("result":{"item":{"file":"","label":"A film"}})", 1);
  ck_assert(heard.report && heard.report->film == "A film");

  // What is no more has no properties.
  heard = talk.answer(R"("error":{"code":-32100,"message":"Failed to execute method."})");
  ck_assert(heard.report && heard.report->doing == Doing::stopped);
  fail_unless(talk.notes("OnStop", "{}").questions.size() > 0);
}

CHECK_TEST(test_silence)
{
  Talk talk;
  talk.begin();
  talk.tells(kFiveSeconds, "1");
  talk.now += 1h;
  fail_if(talk.talk.is_silent(talk.now)); // nothing is asked
  talk.ask();
  fail_if(talk.talk.is_silent(talk.now + 4s));
  fail_unless(talk.talk.is_silent(talk.now + 6s));
}

CHECK_TEST(test_nonsense)
{
  Talk talk;
  talk.begin();
  talk.tells(kFiveSeconds, "1");
  for (const char *object :
       { "", "{", "[]", "7", "{}", R"({"id":"1"})", R"({"id":-1,"result":[]})",
         R"({"id":99,"result":[]})", R"({"method":7})", R"({"method":"Player.OnEat"})",
         R"({"method":"GUI.OnScreensaverActivated","params":{"data":null}})" }) {
    const auto heard = talk.hears(object);
    fail_if(heard.report.has_value() || !heard.questions.empty(), "%s", object);
  }
  for (const char *time : { "7", "null", "{}", R"({"hours":0,"minutes":0,"seconds":5})",
                            R"({"hours":100,"milliseconds":0,"minutes":0,"seconds":5})",
                            R"({"hours":0,"milliseconds":-1,"minutes":0,"seconds":5})",
                            R"({"hours":0,"milliseconds":0,"minutes":0,"seconds":5.5})" }) {
    talk.ask();
    const auto heard = talk.properties(time, "1");
    ck_assert(heard.report && heard.report->doing == Doing::stopped && !heard.report->position);
    talk.begin();
    talk.tells(kFiveSeconds, "1");
  }
  fail_unless(KodiConversation::is_pong(R"({"id":0,"jsonrpc":"2.0","result":"pong"})"));
  for (const char *object : { "", "HTTP/1.1 400 Bad Request", R"({"result":["pong"]})", "{}" })
    fail_if(KodiConversation::is_pong(object));
}

CHECK_TEST(test_stream)
{
  JsonStream stream;
  fail_if(stream.next().has_value());
  fail_unless(stream.add(R"({"a":"}\"{"}{"b":{"c)"));
  ck_assert(stream.next() == R"({"a":"}\"{"})");
  fail_if(stream.next().has_value());
  fail_unless(stream.add("\":1}}"));
  ck_assert(stream.next() == R"({"b":{"c":1}})");
  fail_unless(stream.add(" \r\n"));
  fail_if(stream.next().has_value());
  fail_unless(stream.add("{}\n{}"));
  ck_assert(stream.next() == "{}");
  ck_assert(stream.next() == "{}");
  fail_if(stream.next().has_value());
  fail_if(stream.add("HTTP/1.1 400 Bad Request"));

  JsonStream long_one;
  fail_unless(long_one.add("{\"a\":\""));
  const std::string piece(10'000, 'x');
  bool takes = true;
  int pieces = 0;
  for (; takes && pieces < 100; pieces++) {
    takes = long_one.add(piece);
    fail_if(long_one.next().has_value());
  }
  fail_unless(!takes && pieces < 10, "%d pieces", pieces);
}

CHECK_MAIN(kodi_conversation)
