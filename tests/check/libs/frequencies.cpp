// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Frequencies of maps in files.
#include "tracks/formats/track_file.h"
#include "tracks/track_edit.h"

#include <cmath>
#include <string>
#include <utility>

#include "foreign_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_sharpness)
{
  const auto sharp = [](const char *value) {
    return std::string(R"({"ParameterID":"HapticSharpness","ParameterValue":)") + value + "}";
  };
  // Its control is an offset, and the event that begins last wins.
  Ignored ignored;
  const Track track
      = read(ahap(continuous(R"("Time":0,"EventDuration":2)", sharp("0.25").c_str()) + ","
                  + continuous(R"("Time":1,"EventDuration":0.5)", sharp("1").c_str()) + ","
                  + R"({"ParameterCurve":{"ParameterID":"HapticSharpnessControl","Time":0.1,)"
                    R"("ParameterCurveControlPoints":[{"Time":0,"ParameterValue":0},)"
                    R"({"Time":0.1,"ParameterValue":0.5},{"Time":0.1,"ParameterValue":-1}]}})"),
             TrackFormat::ahap, &ignored);
  fail_unless(ignored.empty());
  ASSERT_HZ(track, 50ms, 123.75);
  for (int i = 0; i < 5; i++)
    ASSERT_HZ(track, 100ms + 20ms * i, 65 + 235 * (0.25 + 0.5 * (i + 0.5) / 5));
  ASSERT_HZ(track, 300ms, 65); // clamped
  ASSERT_HZ(track, 1200ms, 65);
  ASSERT_HZ(track, 1600ms, 65);
  // Where all are 0, as we write tracks without frequencies, there is none.
  fail_if(has_frequency(read(
      ahap(continuous(R"("Time":0,"EventDuration":1)", sharp("0.0").c_str())), TrackFormat::ahap)));
}

namespace {

/// Two cells, 120 Hz and then the motors' own frequency, of three levels.
Track
tuned_track()
{
  Track track(1, 2);
  TactileMap map = make_map(1, 2, { 0.5F, 0 });
  map.frequency = 120;
  track.append(100ms, map);
  map.levels[1] = 1;
  map.frequency = 250;
  track.append(200ms, map);
  track.append(300ms, make_map(1, 2, { 0, 0 }));
  track.append(400ms, map);
  track.set_end(1s);
  return track;
}

} // namespace

CHECK_TEST(test_frequencies_survive)
{
  const Track track = tuned_track();
  for (const TrackFormat format : { TrackFormat::webvtt, TrackFormat::csv, TrackFormat::hjif })
    fail_unless(read(write_track(track, format, ""), format) == track, "format %d", int(format));
  for (const TrackFormat format : { TrackFormat::haptic, TrackFormat::ahap }) {
    const Track again = read(write_track(track, format, ""), format);
    fail_unless(again.entries().size() == track.entries().size(), "format %d", int(format));
    for (const auto &[time, frequency] :
         { std::pair(100ms, 120), { 200ms, 250 }, { 350ms, 0 }, { 500ms, 250 } })
      fail_unless(std::lround(again.at(time).frequency) == frequency, "format %d", int(format));
  }
  for (const TrackFormat format : { TrackFormat::sem, TrackFormat::funscript })
    fail_if(has_frequency(read(write_track(track, format, ""), format)));
}

CHECK_TEST(test_differences)
{
  const Track track = tune(tuned_track(), 120.4F);
  fail_unless(diff(track, tune(track, 120))->size() == 3);
  fail_unless(diff(track, tune(track, 120), 0.005F)->empty()); // as whole numbers
  fail_unless(diff(track, tune(track, 121), 0.005F)->size() == 3);
}

CHECK_TEST(test_texts_of_frequencies)
{
  const Track track = tuned_track();
  const std::string text = write_track(track, TrackFormat::webvtt, "");
  fail_unless(text.find("00:00:00.100 --> 00:00:00.200\n 50   0\n120 Hz\n") != std::string::npos,
              "%s", text.c_str());
  ASSERT_TEXT(write_track(track, TrackFormat::csv, ""),
              "# tactile grid=1x2\ntime_ms,t0,t1,hz\n0,0,0,0\n100,0.5,0,120\n200,0.5,1,250\n"
              "300,0,0,0\n400,0.5,1,250\n1000,0,0,0\n");
  const std::string hjif = write_track(track, TrackFormat::hjif, "");
  fail_unless(hjif.find("\"VectorialWave\"") != std::string::npos);
  fail_unless(
      write_track(track, TrackFormat::haptic, "").find("{\"time\":0.200,\"frequency\":0.234}")
      != std::string::npos);
  // Both envelopes end with the track.
  for (const char *last : { "{\"time\":1.001,\"amplitude\":0}", "{\"time\":1.001,\"frequency\":" })
    fail_unless(write_track(track, TrackFormat::haptic, "").find(last) != std::string::npos, "%s",
                write_track(track, TrackFormat::haptic, "").c_str());
  fail_unless(write_track(track, TrackFormat::ahap, "")
                  .find("\"HapticSharpness\",\"ParameterValue\":0.234}")
              != std::string::npos);
  ASSERT_COMPLAINT(
      read_track("WEBVTT\n\n00:00.000 --> 00:01.000\n1 2\n2000 Hz\n", TrackFormat::webvtt), "line",
      "1 to 1000 Hz");
}

namespace {

/// HJIF with a channel of 1 s for each list of keyframes.
std::string
hjif(const std::vector<std::string> &channels, const char *type = "VectorialWave")
{
  std::string text = "{\"perceptions\":[{\"perception_modality\":\"Vibrotactile\",\"channels\":[";
  for (const std::string &keyframes : channels)
    text += (&keyframes == &channels.front() ? "" : ",")
            + std::string("{\"bands\":[{\"band_type\":\"") + type
            + "\",\"effects\":[{\"position\":0,\"keyframes\":[" + keyframes + "]}]}]}";
  return text + "]}]}";
}

std::string
wave(double from, double to)
{
  const auto key = [](int position, double frequency) {
    return "{\"relative_position\":" + std::to_string(position)
           + ",\"amplitude_modulation\":0.5,\"frequency_modulation\":" + std::to_string(frequency)
           + "}";
  };
  return key(0, from) + "," + key(1000, to);
}

} // namespace

/// Frequencies that a map cannot have are bounded or left out, and told.
CHECK_TEST(test_hjif_of_others)
{
  const auto expect = [](const std::string &text, double frequency, std::size_t losses) {
    std::vector<std::string> ignored;
    const auto track = read_track(text, TrackFormat::hjif, &ignored);
    fail_unless(track.has_value(), "%s", text.c_str());
    fail_unless_equals_float(track->at(500ms).frequency, frequency);
    fail_unless_equals_float(track->at(500ms).levels[0], 0.5);
    fail_unless_equals_int(ignored.size(), losses);
  };
  expect(hjif({ wave(120, 120) }), 120, 0);
  expect(hjif({ wave(4000, 4000) }), 1000, 1);
  expect(hjif({ wave(-5, -5) }), 0, 1);
  expect(hjif({ "{\"relative_position\":20,\"frequency_modulation\":80}," + wave(120, 120) }), 100,
         1);
  expect(hjif({ wave(4000, 4000) }, "Curve"), 0, 0);
  expect(hjif({ wave(120, 120), wave(120.5, 120.5) }), 120.5, 0);
  expect(hjif({ wave(120, 120), wave(80, 80) }), 80, 1);
  expect(hjif({ wave(100, 300), wave(100, 300) }), 202, 0); // the middle of a step of 20 ms
}

/// MPEG's reference software reads whole numbers only, and plays others as 0 Hz.
CHECK_TEST(test_hjif_has_whole_frequencies)
{
  const Track track = tune(tuned_track(), 120.4F);
  const std::string text = write_track(track, TrackFormat::hjif, "");
  fail_unless(text.find("\"frequency_modulation\" : 120\n") != std::string::npos, "%s",
              text.c_str());
  fail_unless(read(text, TrackFormat::hjif) == tune(track, 120));
}

CHECK_TEST(test_overlapping_sharpness)
{
  const auto event = [](const char *time, const char *sharpness) {
    return std::string(
               "{\"Event\":{\"EventType\":\"HapticContinuous\",\"EventDuration\":1,\"Time\":")
           + time + ",\"EventParameters\":[{\"ParameterID\":\"HapticSharpness\",\"ParameterValue\":"
           + sharpness + "}]}}";
  };
  for (const auto &[time, losses] : { std::pair("1", 0U), { "0.5", 1U } }) {
    std::vector<std::string> ignored;
    fail_unless(read_track("{\"Pattern\":[" + event("0", "0.2") + "," + event(time, "0.9") + "]}",
                           TrackFormat::ahap, &ignored)
                    .has_value());
    fail_unless_equals_int(ignored.size(), losses);
  }
}

CHECK_MAIN(frequencies)
