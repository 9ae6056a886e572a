// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/hjif.h"

#include "tracks/formats/step_curve.h"
#include "tracks/text_cue.h"

#include <json-glib/json-glib.h>

#include <cmath>
#include <memory>
#include <string>

namespace tactile {

namespace {

/// The reference software says 128, and refuses more than 127.
constexpr int kMostChannelsOfLevel1 = 127;
constexpr int kTimescale = 1000; ///< ticks per second

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};

class Writer
{
public:
  std::string operator()(const Track &track, const std::string &date)
  {
    begin_object();
    add("version", "2023");
    add("profile", "Main");
    const int channels = track.rows() * track.columns();
    add("level", channels > kMostChannelsOfLevel1 ? 2 : 1);
    add("date", date.c_str());
    const std::string grid = std::to_string(track.rows()) + "x" + std::to_string(track.columns());
    add("description",
        ("tactile track " + write_grid({ track.rows(), track.columns() }, track.rate())).c_str());
    add("timescale", kTimescale);
    add_empty("avatars");
    begin_array("perceptions");
    begin_object();
    add("id", 0);
    add("perception_modality", "Vibrotactile");
    add("description", ("seat back " + grid).c_str());
    add("avatar_id", 0);
    add_empty("effect_library");
    add("unit_exponent", -3);
    add("perception_unit_exponent", 0);
    add_device();
    begin_array("channels");
    for (int row = 0; row < track.rows(); row++)
      for (int column = 0; column < track.columns(); column++)
        add_channel(track, row, column);
    end_array();
    end_object();
    end_array();
    begin_array("syncs");
    begin_object();
    add("timestamp", 0);
    add("timescale", kTimescale);
    end_object();
    end_array();
    end_object();

    g_autoptr(JsonGenerator) generator = json_generator_new();
    json_generator_set_pretty(generator, TRUE);
    json_generator_set_indent(generator, 1);
    g_autoptr(JsonNode) root = json_builder_get_root(builder_.get());
    json_generator_set_root(generator, root);
    gsize length = 0;
    g_autofree gchar *text = json_generator_to_data(generator, &length);
    return std::string(text, length) + "\n";
  }

private:
  /// A coin motor, like the simulated chair's.
  void add_device()
  {
    begin_array("reference_devices");
    begin_object();
    add("id", 1);
    add("name", "ERM coin motor");
    add("type", "ERM");
    add("resonance_frequency", 77.0);
    add("minimum_frequency", 0.0);
    add("maximum_frequency", 200.0);
    add("maximum_voltage", 3.0);
    end_object();
    end_array();
  }

  void add_channel(const Track &track, int row, int column)
  {
    begin_object();
    add("id", row * track.columns() + column);
    add("description", ("back-r" + std::to_string(row) + "c" + std::to_string(column)).c_str());
    add("gain", 1.0);
    add("mixing_coefficient", 1.0);
    add("reference_device_id", 1);
    add("body_part_mask", 0);
    begin_array("body_part_target");
    json_builder_add_string_value(builder_.get(), "Back");
    end_array();
    json_builder_set_member_name(builder_.get(), "actuator_resolution");
    add_vector(track.columns(), track.rows(), 1);
    begin_array("actuator_target");
    add_vector(column, track.rows() - 1 - row, 0);
    end_array();
    add_empty("vertices");
    begin_array("bands");
    begin_object();
    // Only waves have a frequency.
    const bool tuned = has_frequency(track);
    add("band_type", tuned ? "VectorialWave" : "Curve");
    if (!tuned)
      add("curve_type", "Linear");
    // The reference software accepts integers only.
    add("lower_frequency_limit", 0);
    add("upper_frequency_limit", 1000);
    begin_array("effects");
    begin_object();
    add("effect_type", "Basis");
    // A single effect at 0: the reference synthesizer renders effects at later positions as
    // silence.
    add("position", 0);
    if (tuned) {
      add("phase", 0.0);
      add("base_signal", "Sine");
    }
    add_keyframes(track, row, column);
    end_object();
    end_array();
    end_object();
    end_array();
    end_object();
  }

  void add_keyframes(const Track &track, int row, int column)
  {
    const auto position = [](Time time) {
      return std::chrono::floor<std::chrono::milliseconds>(time).count();
    };
    StepCurve levels;
    StepCurve frequencies; // a map without one has that of the map before
    for (const Track::Entry &entry : track.entries()) {
      levels.step(position(entry.time), static_cast<double>(entry.map.at(row, column)));
      if (entry.map.frequency > 0)
        frequencies.step(frequencies.points().empty() ? 0 : position(entry.time),
                         std::round(static_cast<double>(entry.map.frequency)));
    }
    levels.finish(position(track.end()));
    frequencies.hold(position(track.end()));
    begin_array("keyframes");
    auto next = frequencies.points().begin();
    for (const StepCurve::Point &point : levels.points()) {
      for (; next != frequencies.points().end() && next->position < point.position; ++next)
        add_keyframe(next->position, nullptr, &next->value);
      const bool both = next != frequencies.points().end() && next->position == point.position;
      add_keyframe(point.position, &point.value, both ? &(next++)->value : nullptr);
    }
    end_array();
  }

  void add_keyframe(std::int64_t position, const double *amplitude, const double *frequency)
  {
    begin_object();
    add("relative_position", position);
    if (amplitude)
      add("amplitude_modulation", *amplitude);
    if (frequency) // the reference software accepts integers only
      add("frequency_modulation", static_cast<std::int64_t>(*frequency));
    end_object();
  }

  void add_vector(int x, int y, int z)
  {
    begin_object();
    add("X", x);
    add("Y", y);
    add("Z", z);
    end_object();
  }

  void begin_object()
  {
    json_builder_begin_object(builder_.get());
  }
  void end_object()
  {
    json_builder_end_object(builder_.get());
  }
  void begin_array(const char *name)
  {
    json_builder_set_member_name(builder_.get(), name);
    json_builder_begin_array(builder_.get());
  }
  void end_array()
  {
    json_builder_end_array(builder_.get());
  }
  void add_empty(const char *name)
  {
    begin_array(name);
    end_array();
  }
  void add(const char *name, const char *value)
  {
    json_builder_set_member_name(builder_.get(), name);
    json_builder_add_string_value(builder_.get(), value);
  }
  void add(const char *name, std::int64_t value)
  {
    json_builder_set_member_name(builder_.get(), name);
    json_builder_add_int_value(builder_.get(), value);
  }
  void add(const char *name, int value)
  {
    add(name, std::int64_t{ value });
  }
  void add(const char *name, double value)
  {
    json_builder_set_member_name(builder_.get(), name);
    json_builder_add_double_value(builder_.get(), value);
  }

  std::unique_ptr<JsonBuilder, Unref> builder_{ json_builder_new() };
};

} // namespace

std::string
write_hjif(const Track &track, const std::string &date)
{
  return Writer()(track, date);
}

} // namespace tactile
