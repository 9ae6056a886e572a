// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Formats of other tools with one actuator or a vest: .haptic, .hasp, AHAP, funscript and .tact.
#include "tracks/formats/ahap.h"
#include "tracks/formats/funscript.h"
#include "tracks/formats/haptic.h"
#include "tracks/formats/hasp.h"
#include "tracks/formats/tact.h"
#include "tracks/formats/track_file.h"

#include <algorithm>
#include <cmath>

#include "foreign_samples.h"
#include "support/temporary_file.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

double
level(const Track &track, Time at, int cell = 0)
{
  return static_cast<double>(track.at(at).levels.at(static_cast<std::size_t>(cell)));
}

#define ASSERT_LEVEL(track, at, expected)                                                          \
  fail_unless(std::abs(level(track, at) - (expected)) < 1e-6, "%s: %g, expected %g", #at,          \
              level(track, at), double{ expected })

/// The strongest cell of each map, which formats of one actuator keep.
Track
pooled(const Track &track)
{
  Track one(1, 1);
  for (const Track::Entry &entry : track.entries())
    one.append(entry.time, make_map(1, 1, { std::ranges::max(entry.map.levels) }));
  one.set_end(track.end());
  return one;
}

std::string
haptic(const std::string &amplitude, const std::string &more = "")
{
  return R"({"version":{"major":1,"minor":0,"patch":0},"signals":{"continuous":{"envelopes":)"
         R"({"amplitude":[)"
         + amplitude + "]" + more + "}}}}";
}

/// A project of one effect from 100 ms on, of 400 ms, with one mode for one device.
std::string
tact(const std::string &mode, const char *device = "VestBack", const char *enable = "true")
{
  return std::string(R"({"project":{"tracks":[{"enable":)") + enable
         + R"(,"effects":[{"startTime":100,"offsetTime":400,"modes":{")" + device + "\":" + mode
         + "}}]}]}}";
}

std::string
dots(const std::string &points, const char *playback = "NONE")
{
  return std::string(R"({"mode":"DOT_MODE","dotMode":{"feedback":[{"startTime":0,"endTime":200,)")
         + R"("playbackType":")" + playback + R"(","pointList":[)" + points + "]}]}}";
}

std::string
path(const std::string &points, const char *playback = "NONE")
{
  return std::string(R"({"mode":"PATH_MODE","pathMode":{"feedback":[{"playbackType":")") + playback
         + R"(","pointList":[)" + points + "]}]}}";
}

} // namespace

CHECK_TEST(test_what_is_written_is_read)
{
  for (unsigned seed = 0; seed < 8; seed++) {
    const Track track = random_track(seed, 1ms, 100);
    const Track expected = pooled(track);
    fail_unless(read(write_haptic(track), TrackFormat::haptic) == expected, "seed %u", seed);
    fail_unless(read(write_funscript(track), TrackFormat::funscript) == expected, "seed %u", seed);
    // An AHAP file has no silence at its end.
    Track ended = read(write_ahap(track), TrackFormat::ahap);
    ended.append(ended.end(), TactileMap(1, 1));
    ended.set_end(expected.end());
    fail_unless(ended == expected, "seed %u", seed);
  }
}

CHECK_TEST(test_texts)
{
  const Track track = two_tactors(2s);
  const std::string text = write_haptic(track);
  fail_unless(text.find("{\"time\":1.000,\"amplitude\":0},\n{\"time\":1.001,\"amplitude\":0.75},\n"
                        "{\"time\":1.400,\"amplitude\":0.75},\n{\"time\":1.401,\"amplitude\":0}")
                  != std::string::npos,
              "%s", text.c_str());
  ASSERT_TEXT(write_ahap(track),
              "{\"Version\":1.0,\"Metadata\":{\"Project\":\"visuotactile\"},\"Pattern\":[\n"
              "{\"Event\":{\"Time\":1.000,\"EventType\":\"HapticContinuous\",\"EventDuration\":"
              "0.400,\"EventParameters\":[{\"ParameterID\":\"HapticIntensity\",\"ParameterValue\":"
              "0.75},{\"ParameterID\":\"HapticSharpness\",\"ParameterValue\":0.0}]}}\n]}\n");
  // Core Haptics plays continuous events of at most 30 s.
  Track lasting(1, 1);
  lasting.append(0ms, make_map(1, 1, { 1 }));
  lasting.set_end(70s);
  const std::string events = write_ahap(lasting);
  fail_unless(events.find("\"Time\":30.000,\"EventType\":\"HapticContinuous\",\"EventDuration\":"
                          "30.000")
              != std::string::npos);
  fail_unless(events.find("\"Time\":60.000,\"EventType\":\"HapticContinuous\",\"EventDuration\":"
                          "10.000")
              != std::string::npos);
  fail_unless(read(events, TrackFormat::ahap) == lasting);
}

CHECK_TEST(test_haptic)
{
  Ignored ignored;
  const Track track
      = read(haptic(R"({"time":0.5,"amplitude":0.2},{"time":0.6,"amplitude":0.4},)"
                    R"({"time":1.0,"amplitude":0.4,"emphasis":{"amplitude":0.9,"frequency":0.1}},)"
                    R"({"time":2.0,"amplitude":0.4})",
                    R"(,"frequency":[{"time":0,"frequency":0.5}])"),
             TrackFormat::haptic, &ignored);
  fail_unless(track.rows() == 1 && track.columns() == 1 && track.end() == 2s);
  ASSERT_LEVEL(track, 499ms, 0);
  for (int i = 0; i < 5; i++) // a slope in steps of 20 ms
    ASSERT_LEVEL(track, 500ms + 20ms * i, 0.2 + 0.2 * (i + 0.5) / 5);
  ASSERT_LEVEL(track, 600ms, 0.4);
  ASSERT_LEVEL(track, 999ms, 0.4);
  ASSERT_LEVEL(track, 1000ms, 0.9); // an emphasis
  ASSERT_LEVEL(track, 1029ms, 0.9);
  ASSERT_LEVEL(track, 1030ms, 0.4);
  ASSERT_HZ(track, 999ms, 182.5); // 0.5 between 65 and 300 Hz, as in MPEG's reference encoder
  ASSERT_HZ(track, 1000ms, 88.5); // of the emphasis
  ASSERT_HZ(track, 1030ms, 182.5);
  ASSERT_HZ(track, 499ms, 0); // silence has none
  fail_unless(ignored.empty());
  const auto complains = [](const std::string &text, const char *place, const char *words) {
    ASSERT_COMPLAINT(read_track(text, TrackFormat::haptic), place, words);
  };
  complains(haptic(""), "signals.continuous.envelopes", "not empty");
  complains(haptic(R"({"time":0,"amplitude":1.5})"), "signals.continuous.envelopes.amplitude[0]",
            "from 0 to 1");
  complains(haptic(R"({"time":1,"amplitude":1},{"time":0,"amplitude":1})"),
            "signals.continuous.envelopes.amplitude[1]", "before");
  complains(haptic(R"({"time":1e9,"amplitude":1})"), "signals.continuous.envelopes.amplitude[0]",
            "100 hours");
  complains(R"({"version":{"major":2},"signals":{}})", "version", "version 1");
}

/// A project that was last open at the clip "b".
std::string
hasp(const std::string &clips)
{
  return R"({"version":{"major":2},"state":{"clipId":"b"},"clips":[)" + clips + "]}";
}

std::string
hasp_clip(const char *id, const char *name, const char *amplitude)
{
  const std::string level = amplitude;
  return std::string(R"({"clipId":")") + id + R"(","name":")" + name + R"(","haptic":)"
         + haptic(R"({"time":0,"amplitude":)" + level + R"(},{"time":1,"amplitude":)" + level + "}")
         + "}";
}

CHECK_TEST(test_hasp)
{
  const std::string kick = hasp_clip("a", "kick", "0.25");
  const std::string hum = hasp_clip("b", "hum", "0.75");
  Ignored ignored;
  const Track open_clip = read(hasp(kick + "," + hum), TrackFormat::hasp, &ignored);
  ASSERT_LEVEL(open_clip, 500ms, 0.75);
  fail_unless(open_clip.end() == 1s && ignored == Ignored{ "the clip 'kick'" });
  ASSERT_LEVEL(read(hasp(kick), TrackFormat::hasp), 500ms, 0.25); // the clip that was open is gone
  for (const char *state : { "", "\"state\":null,", "\"state\":{\"clipId\":7}," })
    ASSERT_LEVEL(
        read(std::string("{") + state + "\"clips\":[" + hum + "," + kick + "]}", TrackFormat::hasp),
        500ms, 0.75);

  ignored.clear();
  const auto named = read_hasp(hasp(hum + "," + kick + "," + hum), "kick", ignored);
  fail_unless(named.has_value());
  ASSERT_LEVEL(*named, 500ms, 0.25);
  fail_unless(ignored == Ignored{ "the clips 'hum', 'hum'" });

  const auto first = read_hasp(hasp(hum + "," + hasp_clip("c", "hum", "0.5")), "hum", ignored);
  fail_unless(first.has_value());
  ASSERT_LEVEL(*first, 500ms, 0.75);

  ASSERT_COMPLAINT(read_hasp(hasp(hum + "," + kick), "snare", ignored), "document",
                   "expected a clip 'snare', got 'hum', 'kick'");
  const auto complains = [](const std::string &text, const char *place, const char *words) {
    ASSERT_COMPLAINT(read_track(text, TrackFormat::hasp), place, words);
  };
  complains(hasp(""), "document", "expected a clip");
  complains(hasp(R"({"clipId":"a"})"), "clips[0]", "'name'");
  complains(hasp(R"({"clipId":"a","name":"kick"})"), "clip 'kick'", "expected an object");
  complains(hasp(hasp_clip("a", "kick", "2")), "clip 'kick'", "from 0 to 1");
}

CHECK_TEST(test_ahap)
{
  constexpr const char *kHalf = R"({"ParameterID":"HapticIntensity","ParameterValue":0.5})";
  Ignored ignored;
  const Track track
      = read(ahap(continuous(R"("Time":0.1,"EventDuration":0.2)", kHalf) + ","
                  + R"({"Event":{"Time":1.0,"EventType":"HapticTransient","EventParameters":[]}},)"
                  + R"({"Event":{"Time":1.5,"EventType":"AudioContinuous","EventDuration":9}})"),
             TrackFormat::ahap, &ignored);
  ASSERT_LEVEL(track, 99ms, 0);
  ASSERT_LEVEL(track, 100ms, 0.5);
  ASSERT_LEVEL(track, 299ms, 0.5);
  ASSERT_LEVEL(track, 300ms, 0);
  ASSERT_LEVEL(track, 1000ms, 1); // the default
  ASSERT_LEVEL(track, 1029ms, 1);
  fail_unless(track.end() == 1030ms);
  fail_unless(ignored == Ignored{ "the sounds" });

  // A curve's points are relative to its time; its value holds before and after them, and scales
  // what plays.
  const std::string curve
      = R"({"ParameterCurve":{"ParameterID":"HapticIntensityControl","Time":1,)"
        R"("ParameterCurveControlPoints":[{"Time":0,"ParameterValue":1},)"
        R"({"Time":0.1,"ParameterValue":0.5},{"Time":0.1,"ParameterValue":0.2}]}})";
  const std::string value = R"({"Parameter":{"ParameterID":"HapticIntensityControl",)"
                            R"("Time":2,"ParameterValue":0.6}})";
  const Track scaled
      = read(ahap(value + "," + continuous(R"("Time":0,"EventDuration":3)", kHalf) + "," + curve),
             TrackFormat::ahap);
  ASSERT_LEVEL(scaled, 999ms, 0.5);
  for (int i = 0; i < 5; i++)
    ASSERT_LEVEL(scaled, 1000ms + 20ms * i, 0.5 * (1 - 0.5 * (i + 0.5) / 5));
  ASSERT_LEVEL(scaled, 1100ms, 0.1);
  ASSERT_LEVEL(scaled, 1999ms, 0.1);
  ASSERT_LEVEL(scaled, 2000ms, 0.3);
  fail_unless(scaled.end() == 3s);
  // Values are clamped, unknown keys are ignored, as Core Haptics does.
  const Track lenient
      = read(ahap(R"({"Nothing":1},)"
                  + continuous(R"("Time":-1,"EventDuration":1)",
                               R"({"ParameterID":"HapticIntensity","ParameterValue":7})")),
             TrackFormat::ahap);
  ASSERT_LEVEL(lenient, 0ms, 1);
  ASSERT_COMPLAINT(read_track("{}", TrackFormat::ahap), "document", "'Pattern'");
  ASSERT_COMPLAINT(
      read_track(ahap(continuous(R"("Time":1e9,"EventDuration":1)")), TrackFormat::ahap),
      "Pattern[0].Event", "100 hours");
}

CHECK_TEST(test_funscript_keeps)
{
  const std::string text
      = R"({"inverted":true,"metadata":{"title":"a"},"rawActions":[1],"axes":[)"
        R"({"id":"V0","actions":[{"at":5,"pos":10}]},{"id":"R0","actions":[{"at":6,"pos":20}]}]})";
  Track track(1, 1);
  track.append(0ms, make_map(1, 1, { 0.25F }));
  track.set_end(1s);
  const auto with = funscript_with(text, track);
  fail_unless(with.has_value());
  fail_unless(read(*with, TrackFormat::funscript) == track);
  for (const char *kept : { R"("metadata":{"title":"a"})", R"("rawActions":[1])",
                            R"("inverted":true)", R"({"id":"R0","actions":[{"at":6,"pos":20}]})" })
    fail_unless(with->find(kept) != std::string::npos, "%s", with->c_str());
}

CHECK_TEST(test_commas_at_the_end)
{
  // As in Apple's samples for Unity.
  const Track track = read(R"({"Metadata":{"Project":",]",},"Pattern":[)"
                           R"({"Event":{"Time":0,"EventType":"HapticTransient",}, },
                           ],})",
                           TrackFormat::ahap);
  fail_unless(track.end() == 30ms);
  fail_if(read_track("[,]", TrackFormat::ahap).has_value());
}

CHECK_TEST(test_funscript)
{
  // Unordered, fractional, inverted, out of range; other tools' members.
  const Track track
      = read(R"({"inverted":true,"range":90,"metadata":{"tags":[]},"rawActions":[],"actions":[)"
             R"({"at":1000.5,"pos":100},{"at":500,"pos":0},{"at":0,"pos":120},)"
             R"({"at":2000,"pos":100,"subActions":[]},{"at":1000.25,"pos":0}]})",
             TrackFormat::funscript);
  fail_unless(track.rows() == 1 && track.columns() == 1 && track.end() == 2s);
  for (int i = 0; i < 25; i++)
    ASSERT_LEVEL(track, 20ms * i, (i + 0.5) / 25);
  ASSERT_LEVEL(track, 500ms, 1);
  ASSERT_LEVEL(track, 1000ms, 1);
  ASSERT_LEVEL(track, 1000251us, 0); // a step: it takes less than a millisecond
  // The vibration of several axes, as MultiFunPlayer names them.
  Ignored ignored;
  const std::string axes = R"({"actions":[{"at":0,"pos":10},{"at":100,"pos":10}],"axes":[)"
                           R"({"id":"R0","actions":[{"at":0,"pos":20},{"at":100,"pos":20}]},)"
                           R"({"id":"V0","actions":[{"at":0,"pos":30},{"at":100,"pos":30}]}]})";
  ASSERT_LEVEL(read(axes, TrackFormat::funscript, &ignored), 50ms, 0.3);
  fail_unless(ignored == Ignored{ "the other axes" });
  const std::string channels
      = R"({"channels":{"roll":{"actions":[{"at":0,"pos":90},{"at":100,"pos":90}]},)"
        R"("vib":{"actions":[{"at":0,"pos":40},{"at":100,"pos":40}]}}})";
  ASSERT_LEVEL(read("\xEF\xBB\xBF" + channels, TrackFormat::funscript), 50ms, 0.4);
  ASSERT_COMPLAINT(read_track("{}", TrackFormat::funscript), "document", "'actions'");
  // One file of several axes, as the forum of the writers agreed.
  ignored.clear();
  const std::string tracks
      = R"({"actions":[{"at":0,"pos":10},{"at":100,"pos":10}],"tracks":{"twist":{"actions":[]},)"
        R"("vib":{"actions":[{"at":0,"pos":50},{"at":100,"pos":50}]}}})";
  ASSERT_LEVEL(read(tracks, TrackFormat::funscript, &ignored), 50ms, 0.5);
  fail_unless(ignored == Ignored{ "the other axes" });
  ignored.clear();
  ASSERT_LEVEL(read(R"({"actions":[{"at":-5,"pos":0},{"at":10,"pos":70},{"at":20,"pos":70}]})",
                    TrackFormat::funscript, &ignored),
               15ms, 0.7);
  fail_unless(ignored == Ignored{ "the actions before 0:00" });
  // Axes without actions, and a list of another tool.
  const std::string full = R"("actions":[{"at":0,"pos":60},{"at":100,"pos":60}])";
  for (const std::string &text :
       { "{" + full + R"(,"tracks":{"vib":{"actions":[]}}})",
         R"({"axes":[{"id":"V0"},{"id":"L1","actions":[]},{"id":"L0",)" + full + "}]}",
         R"({"tracks":{"vib":{)" + full + "}}}", "{" + full + R"(,"tracks":[1]})",
         "{" + full + R"(,"tracks":{"vib":1}})" })
    ASSERT_LEVEL(read(text, TrackFormat::funscript), 50ms, 0.6);
  ASSERT_COMPLAINT(read_track(R"({"actions":[{"at":4e8,"pos":0}]})", TrackFormat::funscript),
                   "actions[0]", "100 hours");
  ASSERT_COMPLAINT(read_track(R"({"actions":[{"at":1}]})", TrackFormat::funscript), "actions[0]",
                   "'pos'");
}

/// As many axes as a document may have, each a vibration.
CHECK_TEST(test_funscript_axes)
{
  std::string axes = R"({"id":"V0","actions":[{"at":0,"pos":50},{"at":10,"pos":50}]})";
  for (int i = 0; i < 17; i++)
    axes += "," + axes;
  Ignored ignored;
  ASSERT_LEVEL(read(R"({"axes":[)" + axes + "]}", TrackFormat::funscript, &ignored), 5ms, 0.5);
  fail_unless(ignored == Ignored{ "the other axes" });
}

CHECK_TEST(test_tact_dots)
{
  const Track track = read(tact(dots(R"({"index":7,"intensity":0.5},{"index":19,"intensity":1})")),
                           TrackFormat::tact);
  fail_unless(track.rows() == 5 && track.columns() == 4);
  for (const auto &[at, cell, expected] :
       { std::tuple(99ms, 7, 0.0), { 100ms, 7, 0.5 }, { 299ms, 7, 0.5 }, { 300ms, 7, 0.0 } })
    fail_unless_equals_float(level(track, at, cell), expected);
}

CHECK_TEST(test_tact_fades)
{
  // From 100 to 300 ms; steps of 20 ms have the slope's level in their middle.
  const auto at = [](const char *playback, int step) {
    return level(read(tact(dots(R"({"index":0,"intensity":1})", playback)), TrackFormat::tact),
                 100ms + 20ms * step);
  };
  for (int i = 0; i < 10; i++) {
    const double middle = (i + 0.5) / 10;
    fail_unless(std::abs(at("FADE_IN", i) - middle) < 1e-6, "%d", i);
    fail_unless(std::abs(at("FADE_OUT", i) - (1 - middle)) < 1e-6, "%d", i);
    fail_unless(std::abs(at("FADE_IN_OUT", i) - (1 - std::abs(2 * middle - 1))) < 1e-6, "%d", i);
  }
}

CHECK_TEST(test_tact_paths)
{
  // From the top left to the top right in 300 ms: three columns, so a motor each 100 ms.
  const Track track = read(tact(path(R"({"x":"0.000","y":"0","intensity":"0.8","time":0},)"
                                     R"({"x":1,"y":0,"intensity":0.8,"time":300})")),
                           TrackFormat::tact);
  for (int step = 0; step < 15; step++) {
    const double x = 3 * (step * 20 + 10) / 300.0;
    for (int column = 0; column < 4; column++)
      fail_unless(std::abs(level(track, 100ms + 20ms * step, column)
                           - 0.8 * std::max(0.0, 1 - std::abs(x - column)))
                      < 1e-6,
                  "step %d, column %d", step, column);
  }
  fail_unless(track.end() == 400ms);
  // A point alone stands until the effect ends; between motors it is shared.
  const Track point
      = read(tact(path(R"({"x":0.5,"y":0.125,"intensity":1,"time":0})")), TrackFormat::tact);
  for (const int cell : { 1, 2, 5, 6 })
    fail_unless_equals_float(level(point, 499ms, cell), 0.25);
  fail_unless(point.end() == 500ms);
}

/// A path that is not felt takes time, too.
CHECK_TEST(test_tact_silent_paths)
{
  std::string text = tact(path(R"({"x":0,"y":0,"intensity":0,"time":0},)"
                               R"({"x":1,"y":0,"intensity":0,"time":300000000})"));
  text.replace(text.find("\"offsetTime\":400"), 16, "\"offsetTime\":300000000");
  ASSERT_COMPLAINT(read_track(text, TrackFormat::tact),
                   "project.tracks[0].effects[0].modes.VestBack.pathMode.feedback[0]",
                   "more changes than a track can have");
}

CHECK_TEST(test_tact_devices)
{
  const std::string dot = dots(R"({"index":0,"intensity":0.25})");
  ASSERT_COMPLAINT(read_track(tact(dot, "ForearmL"), TrackFormat::tact), "project", "ForearmL");
  fail_unless(read(tact(dot, "VestBack", "false"), TrackFormat::tact) == Track(5, 4));
  // Front and back add up; sleeves are named.
  const std::string all = tact(dot, "VestBack");
  const std::string both = all.substr(0, all.rfind("}}]}")) + ",\"VestFront\":" + dot
                           + ",\"ForearmR\":" + dot + all.substr(all.rfind("}}]}"));
  Ignored ignored;
  ASSERT_LEVEL(read(both, TrackFormat::tact, &ignored), 150ms, 0.5);
  const Ignored expected{ "the side of each pattern, as front and back are added",
                          "the patterns of ForearmR" };
  fail_unless(ignored == expected);
  ASSERT_COMPLAINT(read_track(tact(dots(R"({"index":20,"intensity":1})")), TrackFormat::tact),
                   "project.tracks[0].effects[0].modes.VestBack.dotMode.feedback[0].pointList[0]",
                   "from 0 to 19");
  // Curves without end on one motor.
  std::string many = R"({"index":0,"intensity":0.001})";
  for (int i = 0; i < 10; i++)
    many += "," + many;
  ASSERT_COMPLAINT(read_track(tact(dots(many)), TrackFormat::tact), "", "effects at a time");
}

CHECK_TEST(test_formats_by_content)
{
  const auto found = [](const std::string &text) {
    const TemporaryFile named(text);
    const auto file = read_track_text(named.path);
    fail_unless(file.has_value(), "%s", file ? "" : file.error().text().c_str());
    return file->format;
  };
  const Track track = two_tactors();
  for (const TrackFormat format :
       { TrackFormat::webvtt, TrackFormat::csv, TrackFormat::hjif, TrackFormat::sem,
         TrackFormat::haptic, TrackFormat::ahap, TrackFormat::funscript })
    fail_unless(found(write_track(track, format, "")) == format, "%d", static_cast<int>(format));
  fail_unless(found(tact(dots(""))) == TrackFormat::tact);
  fail_unless(found(hasp(hasp_clip("a", "kick", "1"))) == TrackFormat::hasp);
  fail_unless(found("\xEF\xBB\xBF" + haptic(R"({"time":0,"amplitude":1})")) == TrackFormat::haptic);
  fail_unless(found(R"({"tracks":{"vib":{"actions":[]}}})") == TrackFormat::funscript);
  for (const char *text : { "", "{}", "[]", "hello", R"({"tracks":[]})" }) {
    const TemporaryFile named(text);
    const std::string place = "'" + named.path + "'";
    ASSERT_COMPLAINT(read_track_text(named.path), place.c_str(), "or the text of such a file");
  }
  ASSERT_COMPLAINT(written_format("film.tact"), "'film.tact'", ".haptic, .ahap or .funscript");
  fail_unless(track_format("film.tact") == TrackFormat::tact);
}

CHECK_MAIN(foreign_formats)
