// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What mpv 0.35.1 says at its socket, as recorded, and what could be said instead.
#include "follow/players/mpv_conversation.h"
#include "follow/players/line_buffer.h"

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

struct Talk
{
  /// The report of a line; there has to be one.
  Report tells(const std::string &line)
  {
    now += 1ms;
    const auto report = talk.received(line, now);
    fail_unless(report.has_value(), "nothing told by %s", line.c_str());
    ck_assert(report->received == now);
    fail_if(report->asked.has_value());
    return *report;
  }
  void tells_nothing(const std::string &line)
  {
    fail_if(talk.received(line, now).has_value(), "told by %s", line.c_str());
  }
  Report property(const char *name, const char *data)
  {
    return tells(std::string(R"({"event":"property-change","id":1,"name":")") + name
                 + R"(","data":)" + data + "}");
  }
  void play()
  {
    property("working-directory", "\"/films\"");
    property("path", "\"film.mkv\"");
    property("seeking", "false");
    property("core-idle", "false");
    property("pause", "false");
    property("speed", "1.000000");
  }

  Time now = 5s;
  MpvConversation talk;
};

} // namespace

CHECK_TEST(test_questions)
{
  const std::string questions = MpvConversation::questions();
  fail_unless(questions.starts_with(R"({"command":["observe_property",1,"working-directory"]})"
                                    "\n"));
  fail_unless(questions.ends_with(R"({"command":["observe_property",9,"time-pos"]})"
                                  "\n"));
}

CHECK_TEST(test_play)
{
  Talk talk;
  talk.tells_nothing(R"({"request_id":0,"error":"success"})");
  ck_assert(talk.property("time-pos", "0.083000").doing == Doing::stopped);
  talk.play();
  const Report report = talk.property("time-pos", "0.125000");
  ck_assert(report.doing == Doing::playing);
  ck_assert(report.position == 83ms); // the frame that is on the screen
  ck_assert(report.rate == 1);
  ck_assert_str_eq(report.film.c_str(), "/films/film.mkv");
  fail_if(report.sought);

  const Report faster = talk.property("speed", "1.250000");
  ck_assert(faster.rate == 1.25);
  fail_if(faster.position.has_value());

  ck_assert(talk.property("pause", "true").doing == Doing::paused);
  ck_assert(talk.property("core-idle", "true").doing == Doing::paused);
  ck_assert(talk.property("pause", "false").doing == Doing::stalled);
  ck_assert(talk.property("core-idle", "false").doing == Doing::playing);
}

/// mpv reports the properties one after the other: a film that waits in a pause never seems to
/// play.
CHECK_TEST(test_paused_at_first)
{
  Talk talk;
  for (const auto &[name, data] :
       { std::pair<const char *, const char *>{ "working-directory", "\"/films\"" },
         { "path", "\"film.mkv\"" },
         { "seeking", "false" },
         { "core-idle", "true" },
         { "pause", "true" },
         { "speed", "1.000000" },
         { "time-pos", "9.000000" } })
    fail_if(talk.property(name, data).doing == Doing::playing, "%s", name);
  ck_assert(talk.property("time-pos", "9.000000").doing == Doing::paused);
}

/// It tells a frame while the one before is on the screen.
CHECK_TEST(test_frame_ahead)
{
  Talk talk;
  talk.play();
  talk.property("container-fps", "25.000000");
  ck_assert(talk.property("time-pos", "5.040000").position == 5s);
  ck_assert(talk.property("time-pos", "0.000000").position == 0s);
  for (const char *data : { "null", "0", "1e9", "-25" }) {
    Talk other;
    other.play();
    other.property("container-fps", data);
    ck_assert(other.property("time-pos", "5.040000").position == 5040ms);
  }
}

/// Frames that are far apart, as mpv 0.35.1 told those of a film whose container has 30 a second: a
/// short one came 33 ms before its time, one after 567 ms 50 ms before.
CHECK_TEST(test_variable_frame_rate)
{
  Talk talk;
  talk.play();
  talk.property("container-fps", "30.000000");
  ck_assert(talk.property("time-pos", "0.300000").position == 300ms - 33'333'333ns);
  ck_assert(talk.property("time-pos", "0.867000").position == 817ms);
  ck_assert(talk.property("time-pos", "0.900000").position == 867ms);
  talk.property("video-timing-offset", "0.020000");
  ck_assert(talk.property("time-pos", "1.900000").position == 1880ms);
  talk.property("speed", "2.000000");
  ck_assert(talk.property("time-pos", "2.900000").position == 2860ms);
  talk.property("video-timing-offset", "null");
  ck_assert(talk.property("time-pos", "3.900000").position == 3800ms);
  // After a seek nobody knows the frame before.
  talk.tells(R"({"event":"seek"})");
  talk.tells(R"({"event":"playback-restart"})");
  ck_assert(talk.property("time-pos", "9.000000").position == 8900ms);
}

/// While a frame lasts, mpv is asked whether it still plays.
CHECK_TEST(test_life_sign)
{
  ck_assert(MpvConversation::life_sign()
            == R"({"command":["get_property","core-idle"],"request_id":1000})"
               "\n");
  Talk talk;
  fail_if(talk.talk.plays());
  talk.play();
  fail_unless(talk.talk.plays());
  Report report = talk.tells(R"({"data":false,"request_id":1000,"error":"success"})");
  ck_assert(report.doing == Doing::playing);
  fail_if(report.position.has_value());
  report = talk.tells(R"({"data":true,"request_id":1000,"error":"success"})");
  ck_assert(report.doing == Doing::stalled);
  fail_if(talk.talk.plays());
  talk.tells_nothing(R"({"data":false,"request_id":999,"error":"success"})");
}

/// Where it seeks to is told before the film is there.
CHECK_TEST(test_seek)
{
  Talk talk;
  talk.play();
  Report report = talk.tells(R"({"event":"seek"})");
  ck_assert(report.doing == Doing::stalled && report.sought);
  report = talk.property("time-pos", "7.083000");
  ck_assert(report.doing == Doing::stalled);
  fail_if(report.position.has_value());
  talk.property("seeking", "true");
  talk.property("core-idle", "true");
  ck_assert(talk.tells(R"({"event":"playback-restart"})").doing == Doing::stalled); // idle still
  report = talk.property("time-pos", "8.000000");
  fail_if(report.position.has_value());
  talk.property("seeking", "false");
  talk.property("core-idle", "false");
  report = talk.property("time-pos", "8.042000");
  ck_assert(report.position == 8042ms && report.sought);
  report = talk.property("time-pos", "8.083000");
  ck_assert(report.position == 8042ms && !report.sought);
}

/// A seek so quick that no property changes.
CHECK_TEST(test_quick_seek)
{
  Talk talk;
  talk.play();
  talk.tells(R"({"event":"seek"})");
  ck_assert(talk.tells(R"({"event":"playback-restart"})").doing == Doing::playing);
  const Report report = talk.property("time-pos", "8.000000");
  ck_assert(report.position == 8s && report.sought);
}

CHECK_TEST(test_films)
{
  Talk talk;
  talk.play();
  ck_assert(talk.property("path", R"("https://example.org/a.mkv")").film
            == "https://example.org/a.mkv");
  ck_assert(talk.property("path", R"("/b \"c\".mkv")").film == "/b \"c\".mkv");
  ck_assert(talk.property("path", "\"/caf\xe9 \xc3\xa9\xff.mkv\"").film
            == "/caf\xe9 \xc3\xa9\xff.mkv");
  ck_assert(talk.tells(R"({"event":"end-file","reason":"eof"})").doing == Doing::stopped);
  talk.tells(R"({"event":"start-file","playlist_entry_id":2})");
  const std::string last = talk.property("path", "\"d.mkv\"").film;
  ck_assert(last.ends_with("d.mkv"));
  // The same film again: its path is not told again.
  ck_assert(talk.tells(R"({"event":"end-file","reason":"stop"})").film.empty());
  ck_assert(talk.tells(R"({"event":"start-file","playlist_entry_id":3})").film == last);
  ck_assert(talk.tells(R"({"event":"shutdown"})").doing == Doing::stopped);
  const std::string long_path(5000, 'a');
  ck_assert(talk.property("path", ("\"" + long_path + "\"").c_str()).doing == Doing::stopped);
  // Without a film, none has a time.
  fail_if(talk.property("time-pos", "null").position.has_value());
}

CHECK_TEST(test_nonsense)
{
  Talk talk;
  talk.play();
  for (const char *line : { "", "{", "[]", "7", "null", "\"\"", "{}", "{\"event\":7}",
                            R"({"event":"property-change"})", R"({"event":"volume"})",
                            R"({"event":"property-change","name":"volume","data":1})",
                            R"({"event":"property-change","name":["time-pos"],"data":1})" })
    talk.tells_nothing(line);
  talk.tells_nothing(std::string(10'000, '['));
  for (const char *data : { "null", "\"5\"", "true", "-1", "1e9", "1e400", "[1]", "{\"a\":1}" })
    fail_if(talk.property("time-pos", data).position.has_value(), "%s", data);
  ck_assert(talk.property("time-pos", "3").position == 3s); // a whole number
  for (const char *data : { "null", "\"fast\"", "[]" })
    ck_assert(talk.property("speed", data).rate == 1);
}

CHECK_TEST(test_lines)
{
  LineBuffer lines;
  fail_if(lines.next().has_value());
  fail_unless(lines.add("a\nbc"));
  ck_assert(lines.next() == "a");
  fail_if(lines.next().has_value());
  fail_unless(lines.add("d\n\n"));
  ck_assert(lines.next() == "bcd");
  ck_assert(lines.next() == "");
  fail_if(lines.next().has_value());
  fail_unless(lines.add(std::string(LineBuffer::kLongestLine, 'x')));
  fail_if(lines.add("x"));
}

CHECK_MAIN(mpv_conversation)
