// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/mpegv_sem.h"

#include "tracks/formats/track_file.h"

#include <fstream>
#include <iterator>
#include <regex>

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

std::string
reference()
{
  std::ifstream file(data_file("seat9.sem.xml"));
  return { std::istreambuf_iterator<char>(file), {} };
}

/// What a document contains, whatever its layout and the order of attributes: names, attributes and
/// values, sorted.
std::vector<std::string>
words(const std::string &text)
{
  const std::string plain = std::regex_replace(text, std::regex("<!--[^>]*-->"), "");
  const std::regex word("[^\\s<>\"=]+=\"[^\"]*\"|[^\\s<>]+");
  std::vector<std::string> all{ std::sregex_token_iterator(plain.begin(), plain.end(), word), {} };
  std::ranges::sort(all);
  return all;
}

std::string
document(const std::string &effects)
{
  std::string text = reference();
  text.erase(text.find("<Effect"));
  return text + effects + "</SEM>";
}

std::string
effect(const std::string &attributes, const std::string &dim, const std::string &levels)
{
  return "\n<Effect xsi:type=\"sev:TactileType\" " + attributes
         + "><sev:ArrayIntensity mpeg7:dim=\"" + dim + "\">" + levels
         + "</sev:ArrayIntensity></Effect>";
}

} // namespace

CHECK_TEST(test_reference_file)
{
  fail_unless(read_sem(reference()) == two_tactors());
  fail_unless(words(write_sem(two_tactors())) == words(reference()), "%s",
              write_sem(two_tactors()).c_str());
}

CHECK_TEST(test_round_trip)
{
  for (unsigned seed = 0; seed < 100; seed++) {
    const Track track = random_track(seed, 1ms, 0);
    fail_unless(read_sem(write_sem(track)) == track, "seed %u", seed);
  }
  const Track empty(2, 5);
  fail_unless(read_sem(write_sem(empty)) == empty);
}

CHECK_TEST(test_rows_are_samples)
{
  const Track track = *read_sem(document(
      effect("si:pts=\"100\" duration=\"500\" timeSamples=\"4\"", "2 2", "\n0 0.5\n1 0\n")));
  fail_unless(track.rows() == 1 && track.columns() == 2);
  fail_unless_equals_float(track.at(100ms).at(0, 1), 0.5);
  fail_unless_equals_float(track.at(349ms).at(0, 1), 0.5);
  fail_unless_equals_float(track.at(350ms).at(0, 0), 1);
  fail_unless(is_silent(track.at(600ms)));
  const Track in_ticks = *read_sem(
      std::regex_replace(reference(), std::regex("timeScale=\"1000\""), "timeScale=\"2000\""));
  fail_unless(in_ticks.end() == 700ms && is_silent(in_ticks.at(499ms))
              && !is_silent(in_ticks.at(500ms)));
  fail_unless(read_sem(document("<DescriptionMetadata/>"
                                + effect("si:pts=\"0\" duration=\"1\"", "1 2", "0 0")))
                  ->end()
              == 1ms);
  const Track inactive = *read_sem(
      document(effect("activate=\"false\" si:pts=\"0\" duration=\"500\"", "1 2", "1 1")));
  fail_unless(is_silent(inactive.at(0s)) && inactive.end() == 500ms);
}

/// One motor for all, as tools such as PlaySEM write it: on until it is turned off, changes its
/// strength or reaches its duration.
CHECK_TEST(test_vibrations)
{
  const auto vibration = [](const std::string &attributes) {
    return "\n<Effect xsi:type=\"sev:VibrationType\" " + attributes + "/>";
  };
  const Track track = *read_sem(document(
      vibration("activate=\"true\" intensity-value=\"20\" intensity-range=\"10 50\" si:pts=\"500\"")
      + vibration(
          "activate=\"true\" intensity-value=\"50\" intensity-range=\"10 50\" si:pts=\"800\"")
      + vibration("activate=\"false\" si:pts=\"1000\"")
      + vibration("si:pts=\"2000\" duration=\"250\"")));
  Track expected(1, 1);
  TactileMap map(1, 1);
  for (const auto &[time, level] : { std::pair{ 500ms, 0.25F }, std::pair{ 800ms, 1.0F },
                                     std::pair{ 1000ms, 0.0F }, std::pair{ 2000ms, 1.0F } }) {
    map.levels[0] = level;
    expected.append(time, map);
  }
  expected.set_end(2250ms);
  fail_unless(track == expected);

  ASSERT_COMPLAINT(read_sem(document(vibration("si:pts=\"0\""))), "line 9", "no end");
  ASSERT_COMPLAINT(read_sem(document(vibration("intensity-value=\"2\" si:pts=\"0\""))), "line 9",
                   "within intensity-range");
  ASSERT_COMPLAINT(
      read_sem(document(vibration("intensity-range=\"1 2 3\" si:pts=\"0\" duration=\"1\""))),
      "line 9", "intensity-range");
  ASSERT_COMPLAINT(read_sem(document(vibration("si:pts=\"0\" duration=\"9\"")
                                     + vibration("si:pts=\"8\" duration=\"9\""))),
                   "line 10", "overlaps");
}

CHECK_TEST(test_refused)
{
  const std::string when = "si:pts=\"0\" duration=\"500\"";
  ASSERT_COMPLAINT(read_sem(""), "line 1", "");
  ASSERT_COMPLAINT(read_sem("<SEM>"), "line 1", "");
  ASSERT_COMPLAINT(read_sem("<SEM/>"), "line 1", "SEM of MPEG-V");
  ASSERT_COMPLAINT(read_sem(document("")), "line", "no effect");
  ASSERT_COMPLAINT(read_sem(document("\n<Effect xsi:type=\"sev:WindType\"/>")), "line 9",
                   "TactileType");
  ASSERT_COMPLAINT(read_sem(document("\n<GroupOfEffects/>")), "line 9", "TactileType");
  ASSERT_COMPLAINT(read_sem(document(effect("si:pts=\"0\"", "1 2", "0 0"))), "line 9",
                   "'duration'");
  ASSERT_COMPLAINT(read_sem(document(effect("si:pts=\"-1\" duration=\"1\"", "1 2", "0 0"))),
                   "line 9", "'pts'");
  ASSERT_COMPLAINT(
      read_sem(document(effect("si:pts=\"9000000000000\" duration=\"1\"", "1 2", "0 0"))), "line 9",
      "100 hours");
  // The schema requires whole times and positive durations.
  ASSERT_COMPLAINT(read_sem(document(effect("si:pts=\"0.5\" duration=\"1\"", "1 2", "0 0"))),
                   "line 9", "whole number 'pts'");
  ASSERT_COMPLAINT(read_sem(document(effect("si:pts=\"0\" duration=\"0\"", "1 2", "0 0"))),
                   "line 9", "whole number 'duration'");
  ASSERT_COMPLAINT(read_sem(document(effect(when + " activate=\"yes\"", "1 2", "0 0"))), "line 9",
                   "'activate'");
  ASSERT_COMPLAINT(read_sem(document(effect(when + " fade=\"100\"", "1 2", "0 0"))), "line 9",
                   "fade");
  ASSERT_COMPLAINT(read_sem(document(effect(when + " si:timeScale=\"90000\"", "1 2", "0 0"))),
                   "line 9", "timeScale");
  ASSERT_COMPLAINT(
      read_sem(std::regex_replace(reference(), std::regex(" si:timeScale=\"1000\""), "")), "line",
      "timeScale");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1 2", "0 0 0"))), "line 9", "got 3");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "", "0"))), "line 9", "dim");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1.5 2", "0 0 1"))), "line 9", "dim");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1 2", "0 2"))), "line 9", "range");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1 2", "0 nan"))), "line 9", "range");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1 2", "0 0") + effect(when, "1 2", "0 0"))),
                   "line 10", "overlaps");
  ASSERT_COMPLAINT(read_sem(document(effect(when, "1 2", "0 0")
                                     + effect("si:pts=\"500\" duration=\"1\"", "1 3", "0 0 0"))),
                   "line 10", "2 tactors, got 3");
  ASSERT_COMPLAINT(read_sem("<!DOCTYPE SEM [<!ENTITY a \"x\">]><SEM/>"), "line 1", "DTD");
  ASSERT_COMPLAINT(
      read_sem("<!DOCTYPE SEM [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><SEM>&a;</SEM>"),
      "line 1", "DTD");
}

CHECK_TEST(test_format_by_name)
{
  fail_unless(track_format("/a.b/film.vtt") == TrackFormat::webvtt);
  fail_unless(track_format("film.csv") == TrackFormat::csv);
  fail_unless(track_format("film.hjif") == TrackFormat::hjif);
  fail_unless(track_format("film.sem.xml") == TrackFormat::sem);
  fail_unless(track_format("film.funscript") == TrackFormat::funscript);
  ASSERT_COMPLAINT(track_format("film.xml"), "'film.xml'", ".sem.xml");
  ASSERT_COMPLAINT(read_track_file("/nowhere/film.vtt"), "'/nowhere/film.vtt'", "No such file");
  fail_unless(read_track_file(data_file("seat9.sem.xml")) == two_tactors());
}

/// A map that lasts for hours at a high rate has less text.
CHECK_TEST(test_long_map)
{
  Track track(1, 2);
  track.set_rate(1000);
  fail_unless(track.append(1s, make_map(1, 2, { 0.5F, 1 })).has_value());
  fail_unless(track.set_end(3h).has_value());
  const std::string text = write_sem(track); // 65 MB with all samples
  fail_unless(text.size() < std::size_t{ 10 } << 20);
  const auto read = read_sem(text);
  fail_unless(read.has_value(), "%s", read ? "" : read.error().text().c_str());
  fail_unless(*read == track);
}

CHECK_MAIN(mpegv_sem)
