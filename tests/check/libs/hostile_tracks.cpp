// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Malicious tracks: each is read or refused with a reason, within the time limit of a test. The
// limit of memory is one gibibyte, or three where a parser builds a tree.
#include "tracks/formats/level_curves.h"
#include "tracks/formats/track_file.h"

#include "hostile.h"

#include "support/check_tests.h"

using namespace tactile;

namespace {

constexpr TrackFormat kForms[]
    = { TrackFormat::webvtt, TrackFormat::csv,  TrackFormat::hjif,      TrackFormat::sem,
        TrackFormat::haptic, TrackFormat::ahap, TrackFormat::funscript, TrackFormat::tact };

/// Whether the text is read. If so, the track must be valid.
bool
is_read(const std::string &text, TrackFormat form)
{
  const tl::expected<Track, FormatError> track = read_track(text, form);
  if (!track) {
    assert_short(track.error().text());
    return false;
  }
  bool is_sound = true;
  for (const Track::Entry &entry : track->entries()) {
    is_sound = is_sound && entry.time >= Time(0);
    for (const float level : entry.map.levels)
      is_sound = is_sound && level >= 0 && level <= 1; // false for NaN
  }
  fail_unless(is_sound);
  return true;
}

} // namespace

CHECK_TEST(test_a_file_of_two_gigabytes)
{
  limit_memory();
  const TemporaryFile file("", ".vtt");
  std::filesystem::resize_file(file.path, 2048 * kMiB); // one line, a sparse file
  fail_if(read_track_file(file.path));
}

CHECK_TEST(test_long_lines)
{
  limit_memory();
  for (const TrackFormat form : kForms)
    for (const char *piece : { "A", "9", "0 ", ",", "\"", "<", "&amp;" })
      fail_if(is_read(times(4 * kMiB / std::string(piece).size(), piece), form));
  // A track that is valid except for its long line.
  fail_if(is_read("# tactile grid=1x1 rate=5\ntime_ms,t0\n0," + std::string(4 * kMiB, '1') + "\n",
                  TrackFormat::csv));
  fail_if(is_read("WEBVTT\n\n00:01.000 --> 00:02.000\n" + times(2 * kMiB, "75 ") + "\n",
                  TrackFormat::webvtt));
}

CHECK_TEST(test_a_million_cues)
{
  limit_memory();
  std::string csv = "# tactile grid=1x1 rate=0\ntime_ms,t0\n";
  std::string vtt = "WEBVTT\n\nNOTE tactile grid=1x1\n";
  for (int i = 0; i < 1'000'000; i++) {
    const char *level = i % 2 ? "0" : "1";
    csv += std::to_string(i * 40) + "," + level + "\n";
    char line[80];
    const int ms = i * 10;
    std::snprintf(line, sizeof line, "\n%02d:%02d:%02d.%03d --> %02d:%02d:%02d.%03d\n50\n",
                  ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000, ms / 3'600'000,
                  ms / 60'000 % 60, ms / 1000 % 60, ms % 1000 + 5);
    vtt += line;
  }
  fail_unless(is_read(csv, TrackFormat::csv));
  fail_unless(is_read(vtt, TrackFormat::webvtt));
}

CHECK_TEST(test_deep_and_growing_documents)
{
  limit_memory();
  for (const char *open : { "[", "{\"a\":", "[{\"avatars\":" })
    fail_if(is_read(times(1'000'000, open), TrackFormat::hjif));
  fail_if(is_read("<SEM>" + times(1'000'000, "<Effect>"), TrackFormat::sem));
  // Billion laughs: ten entities of ten references each make 10^9.
  std::string laughs = "<!DOCTYPE SEM [<!ENTITY l0 \"laugh\">";
  for (int i = 1; i < 10; i++)
    laughs += "<!ENTITY l" + std::to_string(i) + " \""
              + times(10, "&l" + std::to_string(i - 1) + ";") + "\">";
  laughs += "]><SEM>&l9;</SEM>";
  fail_if(is_read(laughs, TrackFormat::sem));
  // Local files must not be read.
  fail_if(is_read("<!DOCTYPE SEM [<!ENTITY f SYSTEM \"file:///etc/passwd\">]><SEM>&f;</SEM>",
                  TrackFormat::sem));
}

/// Documents whose tree is many times larger than the file are refused by the number of their
/// parts, or read in bounded memory.
CHECK_TEST(test_documents_of_many_parts)
{
  limit_memory(3);
  const auto array = [](std::size_t count, const std::string &item) {
    return "[" + times(count - 1, item + ",") + item + "]";
  };
  for (const std::size_t count : { std::size_t{ 1'900'000 }, std::size_t{ 20'000'000 } })
    for (const char *item : { "{}", "[]", "{\"a\":1}" })
      fail_if(is_read(array(count, item), TrackFormat::hjif));
  for (const std::size_t count : { std::size_t{ 7'900'000 }, std::size_t{ 60'000'000 } })
    fail_if(is_read(array(count, "0"), TrackFormat::hjif));
  for (const std::size_t count : { std::size_t{ 1'900'000 }, std::size_t{ 20'000'000 } }) {
    fail_if(is_read("<SEM>" + times(count, "<a/>") + "</SEM>", TrackFormat::sem));
    fail_if(is_read("<SEM>" + times(count / 2, "<a b='1' />") + "</SEM>", TrackFormat::sem));
    fail_if(is_read("<SEM " + times(count, "a='' ") + "/>", TrackFormat::sem));
  }
}

CHECK_TEST(test_invalid_numbers)
{
  const char *const numbers[] = { "nan", "NaN",  "inf",    "-inf", "Infinity", "1e999", "-1e999",
                                  "-1",  "0x1p", "1e-999", "",     "١",        "1;2",   "-0" };
  for (const char *number : numbers) {
    const std::string text = number;
    is_read("# tactile grid=1x1 rate=5\ntime_ms,t0\n0," + text + "\n400,0\n", TrackFormat::csv);
    is_read("# tactile grid=1x1 rate=5\ntime_ms,t0\n" + text + ",1\n400,0\n", TrackFormat::csv);
    is_read("# tactile grid=1x1 rate=" + text + "\ntime_ms,t0\n0,1\n400,0\n", TrackFormat::csv);
    is_read("WEBVTT\n\nNOTE tactile grid=1x1 rate=" + text + "\n\n00:01.000 --> 00:02.000\n" + text
                + "\n",
            TrackFormat::webvtt);
    is_read("WEBVTT\n\n" + text + ":01.000 --> 00:02.000\n50\n", TrackFormat::webvtt);
    for (const char *place : { "pts", "duration", "timeSamples" }) {
      std::string sem
          = "<SEM xmlns=\"urn:mpeg:mpeg-v:2010:01-SEDL-NS\" "
            "xmlns:sev=\"urn:mpeg:mpeg-v:2010:01-SEV-NS\" "
            "xmlns:mpeg7=\"urn:mpeg:mpeg7:schema:2004\" "
            "xmlns:si=\"urn:mpeg:mpeg21:2003:01-DIA-XSI-NS\" "
            "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" si:timeScale=\"1000\"><!-- "
            "tactile grid=1x1 rate=5 --><Effect xsi:type=\"sev:TactileType\" ";
      for (const char *name : { "pts", "duration", "timeSamples" })
        sem += std::string(std::string("pts") == name ? "si:" : "") + name + "=\""
               + (std::string(name) == place ? text : "5") + "\" ";
      sem += "><sev:ArrayIntensity mpeg7:dim=\"1 1\">" + text
             + "</sev:ArrayIntensity></Effect></SEM>";
      is_read(sem, TrackFormat::sem);
    }
  }
}

/// Times that go back, overlap, repeat, or end before they begin.
CHECK_TEST(test_times_in_disorder)
{
  fail_if(is_read("# tactile grid=1x1 rate=5\ntime_ms,t0\n0,1\n400,0\n200,1\n", TrackFormat::csv));
  const char *const cues[] = { "00:02.000 --> 00:01.000", "00:01.000 --> 00:01.000",
                               "-00:01.000 --> 00:01.000", "00:00.000 --> 99999999:00:00.000" };
  for (const char *cue : cues)
    is_read(std::string("WEBVTT\n\nNOTE tactile grid=1x1\n\n") + cue + "\n50\n\n"
                + "00:00.500 --> 00:03.000\n50\n\n00:00.400 --> 00:00.900\n90\n",
            TrackFormat::webvtt);
}

/// A thousand events of 20 hours under one slope of sharpness: a map has few frequencies, but
/// each event sets all of them again.
CHECK_TEST(test_frequencies_set_again)
{
  limit_memory(3);
  const std::string event = R"({"Event":{"Time":0,"EventType":"HapticContinuous",)"
                            R"("EventDuration":72000,"EventParameters":[{"ParameterID":)"
                            R"("HapticSharpness","ParameterValue":0.5}]}},)";
  fail_if(is_read(R"({"Version":1,"Pattern":[)" + times(1000, event)
                      + R"({"ParameterCurve":{"ParameterID":"HapticSharpnessControl","Time":0,)"
                        R"("ParameterCurveControlPoints":[{"Time":0,"ParameterValue":-0.5},)"
                        R"({"Time":72000,"ParameterValue":0.5}]}}]})",
                  TrackFormat::ahap));
}

/// A slope of 20 hours, to which each of thousands of channels would be added in each step.
CHECK_TEST(test_a_slope_of_many_channels)
{
  LevelCurves curves(1000, 1);
  const LevelCurves::Point points[] = { { 0, 0 }, { 72'000'000, 1 } };
  fail_unless(curves.add(0, points));
  const std::vector<std::vector<std::size_t>> cells(4096, { 0 });
  fail_if(curves.join(tactile::Track(64, 64), cells));
}

CHECK_MAIN(hostile_tracks)
