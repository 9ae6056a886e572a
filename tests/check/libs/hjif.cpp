// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/hjif.h"

#include "tracks/formats/funscript.h"

#include <json-glib/json-glib.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

constexpr const char *kDate = "2026-11-20T00:00:00+00:00";

std::string
contents(const char *name)
{
  std::ifstream file(data_file(name));
  return { std::istreambuf_iterator<char>(file), {} };
}

std::string
reference()
{
  return contents("seat9.hjif");
}

/// The path of each value in a document with its type and, except for keyframes and texts, its
/// value.
void
collect(JsonNode *node, const std::string &path, std::set<std::string> &shape)
{
  if (JSON_NODE_HOLDS_OBJECT(node)) {
    JsonObjectIter iter;
    const gchar *name = nullptr;
    JsonNode *member = nullptr;
    json_object_iter_init(&iter, json_node_get_object(node));
    while (json_object_iter_next(&iter, &name, &member))
      collect(member, path + "." + name, shape);
  } else if (JSON_NODE_HOLDS_ARRAY(node)) {
    JsonArray *array = json_node_get_array(node);
    const bool is_keyframes = path.ends_with(".keyframes");
    if (json_array_get_length(array) == 0)
      shape.insert(path + "[]");
    for (guint i = 0; i < json_array_get_length(array); i++)
      collect(json_array_get_element(array, i),
              path + (is_keyframes ? "[]" : "[" + std::to_string(i) + "]"), shape);
  } else {
    std::string value = g_type_name(json_node_get_value_type(node));
    if (!path.ends_with("description") && path.find(".keyframes") == std::string::npos) {
      g_autofree gchar *text = json_to_string(node, FALSE);
      value = text;
    }
    shape.insert(path + " = " + value);
  }
}

std::set<std::string>
shape(const std::string &text)
{
  JsonParser *parser = json_parser_new();
  fail_unless(
      json_parser_load_from_data(parser, text.data(), static_cast<gssize>(text.size()), nullptr));
  std::set<std::string> paths;
  collect(json_parser_get_root(parser), "", paths);
  g_object_unref(parser);
  return paths;
}

/// A document of one channel with these bands.
std::string
document(const std::string &bands, const std::string &channel = "")
{
  return "{\"timescale\":1000,\"perceptions\":[{\"perception_modality\":\"Vibrotactile\","
         "\"channels\":[{"
         + channel + "\"bands\":[" + bands + "]}]}]}";
}

std::string
band(const std::string &effects, const std::string &type = "Curve")
{
  return "{\"band_type\":\"" + type + "\",\"effects\":[" + effects + "]}";
}

std::string
effect(int position, const std::string &keyframes)
{
  return "{\"effect_type\":\"Basis\",\"position\":" + std::to_string(position) + ",\"keyframes\":["
         + keyframes + "]}";
}

std::string
key(int position, double level)
{
  return "{\"relative_position\":" + std::to_string(position)
         + ",\"amplitude_modulation\":" + std::to_string(level) + "}";
}

tl::expected<Track, FormatError>
read_hjif(std::string_view text)
{
  std::vector<std::string> ignored;
  return tactile::read_hjif(text, ignored);
}

} // namespace

CHECK_TEST(test_reference_file)
{
  const Track expected = two_tactors(1401ms); // its silent channels last a tick longer
  fail_unless(read_hjif(reference()) == expected);
  // The same members with the same types and values, except texts and keyframes.
  const std::set<std::string> ours = shape(write_hjif(two_tactors(), kDate));
  const std::set<std::string> theirs = shape(reference());
  for (const std::string &path : ours)
    fail_unless(theirs.contains(path), "%s is not in the reference file", path.c_str());
  for (const std::string &path : theirs)
    fail_unless(ours.contains(path), "%s is not in our file", path.c_str());
}

CHECK_TEST(test_keyframes)
{
  // The channels of the reference file that are not silent.
  const std::string text = write_hjif(two_tactors(), kDate);
  const std::regex number("\"(relative_position|amplitude_modulation)\" : ([0-9.]+)");
  std::string numbers;
  const std::size_t channel = text.find("back-r1c1");
  const std::string part = text.substr(channel, text.find("back-r1c2") - channel);
  for (std::sregex_iterator i(part.begin(), part.end(), number), end; i != end; ++i)
    numbers += (*i)[2].str() + " ";
  ASSERT_TEXT(numbers, "0 0.0 1000 0.0 1001 0.75 1400 0.75 1401 0.0 ");
}

CHECK_TEST(test_round_trip)
{
  for (unsigned seed = 0; seed < 12; seed++) { // few: slow under sanitizers
    const Track track = random_track(seed, 1ms, 0);
    fail_unless(read_hjif(write_hjif(track, kDate)) == track, "seed %u", seed);
  }
  Track large(8, 16);
  large.append(1s, TactileMap(8, 16));
  large.set_end(2s);
  const std::string text = write_hjif(large, kDate);
  fail_unless(text.find("\"level\" : 2") != std::string::npos); // 128 channels
  fail_unless(read_hjif(text) == large);
}

CHECK_TEST(test_changes_a_millisecond_apart)
{
  Track track(1, 1);
  track.append(10ms, make_map(1, 1, { 0.5F }));
  track.append(11ms, make_map(1, 1, { 1 }));
  track.append(12ms, make_map(1, 1, { 0.25F }));
  track.set_end(13ms);
  fail_unless(read_hjif(write_hjif(track, kDate)) == track);
}

CHECK_TEST(test_ramps_of_other_tools)
{
  // From 0 to 1 in 100 ms: five steps of 20 ms, each with its mean level. The last level holds for
  // 50 ms.
  const Track track
      = *read_hjif(document(band(effect(200, key(0, 0) + "," + key(100, 1) + "," + key(150, 1)))));
  fail_unless(track.rows() == 1 && track.columns() == 1);
  fail_unless(track.end() == 350ms);
  for (int i = 0; i < 5; i++)
    fail_unless(std::abs(static_cast<double>(track.at(200ms + i * 20ms).at(0, 0)) - (0.1 + 0.2 * i))
                < 1e-6);
  fail_unless_equals_float(track.at(340ms).at(0, 0), 1);
  fail_unless(is_silent(track.at(199ms)));
}

CHECK_TEST(test_bands_and_effects_are_added_up)
{
  const std::string steady = effect(0, key(0, 0.25) + "," + key(100, 0.25));
  const std::string negative = effect(50, key(0, -0.5) + "," + key(100, -0.5));
  const Track track
      = *read_hjif(document(band(steady) + "," + band(negative, "VectorialWave"), "\"gain\":0.5,"));
  fail_unless_equals_float(track.at(0ms).at(0, 0), 0.125);
  fail_unless_equals_float(track.at(50ms).at(0, 0), 0.375);
  fail_unless_equals_float(track.at(100ms).at(0, 0), 0.25);
  fail_unless(track.end() == 150ms);
}

/// An AHAP file as the reference software's encoder converts it. One second of a ramp from 0.2
/// through 1 to 0, at 0.8. Half a second at 0.5 from 1 s on. The file's curve for actuators scales
/// both. A band without transients.
CHECK_TEST(test_ahap)
{
  const Track track = *read_hjif(contents("ahap.hjif"));
  fail_unless_equals_int(track.rows() * track.columns(), 1);
  const auto level = [&](Time at) {
    return static_cast<double>(track.at(at).levels[0]);
  };
  const double peak = 0.49104;
  // Steps of 20 ms differ from the ramp by at most half a step.
  for (int ms = 0; ms < 500; ms += 7)
    fail_unless(std::abs(level(std::chrono::milliseconds(ms)) - peak * (0.2 + 0.8 * ms / 500))
                    < 0.8 * peak * 21 / 500,
                "%d ms", ms);
  for (int ms = 500; ms < 1000; ms += 7)
    fail_unless(std::abs(level(std::chrono::milliseconds(ms)) - peak * (1000 - ms) / 500)
                    < peak * 21 / 500,
                "%d ms", ms);
  fail_unless(level(1500ms) == 0);
  fail_unless(std::abs(level(2200ms) - 0.3069) < 1e-4);
  fail_unless(level(2501ms) == 0);
}

CHECK_TEST(test_refused)
{
  const auto keyframes = key(0, 0.5) + "," + key(10, 0.5);
  ASSERT_COMPLAINT(read_hjif(""), "document", "object");
  ASSERT_COMPLAINT(read_hjif("{"), "document", "");
  ASSERT_COMPLAINT(read_hjif("[]"), "document", "object");
  ASSERT_COMPLAINT(read_hjif("{\n/* a comment */}"), "line 2", "no JSON");
  ASSERT_COMPLAINT(read_hjif(std::string(100'000, '[')), "line 1", "nested");
  ASSERT_COMPLAINT(read_hjif("{\"perceptions\":[]}"), "document", "one perception");
  ASSERT_COMPLAINT(read_hjif("{\"perceptions\":[{\"perception_modality\":\"Force\"}]}"),
                   "perceptions[0]", "Vibrotactile");
  ASSERT_COMPLAINT(read_hjif("{\"timescale\":0,\"perceptions\":[]}"), "document", "timescale");
  ASSERT_COMPLAINT(read_hjif(document(band(effect(0, key(0, 1)), "Transient"))),
                   "perceptions[0].channels[0].bands[0]", "Transient");
  ASSERT_COMPLAINT(read_hjif(document(band(effect(-1, keyframes)))),
                   "perceptions[0].channels[0].bands[0].effects[0].keyframes[0]", "100 hours");
  ASSERT_COMPLAINT(read_hjif(document(band(effect(0, key(10, 1) + "," + key(0, 1))))),
                   "perceptions[0].channels[0].bands[0].effects[0].keyframes[1]", "before");
  ASSERT_COMPLAINT(read_hjif(document(band(effect(0, "{\"amplitude_modulation\":\"loud\"}")))),
                   "perceptions[0].channels[0].bands[0].effects[0].keyframes[0]", "number");
  ASSERT_COMPLAINT(
      read_hjif(document(band("{\"effect_type\":\"Reference\",\"position\":0,\"id\":3}"))),
      "perceptions[0].channels[0].bands[0].effects[0]", "Basis");
  ASSERT_COMPLAINT(
      read_hjif(document(
          "",
          "\"actuator_resolution\":{\"X\":2,\"Y\":2},\"actuator_target\":[{\"X\":2,\"Y\":0}],")),
      "perceptions[0].channels[0].actuator_target[0]", "'X'");
  ASSERT_COMPLAINT(read_hjif(document(
                       "", "\"actuator_resolution\":{\"X\":2000,\"Y\":2},\"actuator_target\":[],")),
                   "perceptions[0].channels[0].actuator_resolution", "'X'");
  std::string targets = "{\"X\":0,\"Y\":0}";
  for (int i = 0; i < 12; i++)
    targets += "," + targets;
  ASSERT_COMPLAINT(read_hjif(document("", "\"actuator_resolution\":{\"X\":1,\"Y\":1},"
                                          "\"actuator_target\":["
                                              + targets + "," + targets + "],")),
                   "perceptions[0].channels[0]", "4096 targets");
}

CHECK_TEST(test_funscript)
{
  const Track track = two_tactors(2s);
  ASSERT_TEXT(write_funscript(track),
              "{\"version\":\"1.0\",\"inverted\":false,\"range\":100,\"actions\":[\n"
              "{\"at\":0,\"pos\":0},\n"
              "{\"at\":1000,\"pos\":0},\n"
              "{\"at\":1001,\"pos\":75},\n"
              "{\"at\":1400,\"pos\":75},\n"
              "{\"at\":1401,\"pos\":0},\n"
              "{\"at\":2000,\"pos\":0}\n"
              "]}\n");
  shape(write_funscript(random_track(1, 1ms, 0))); // valid JSON
}

CHECK_MAIN(hjif)
