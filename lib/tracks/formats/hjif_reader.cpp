// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/hjif.h"

#include "tracks/formats/step_curve.h"
#include "tracks/text_cue.h"

#include <json-glib/json-glib.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr int kTimescale = 1000; ///< ticks per second, if the document has none
constexpr int kDeepest = 64;     ///< nesting of arrays and objects
/// Limits on memory: the parser allocates about 100 bytes per value and a hash table per object.
constexpr std::size_t kMostContainers = 2'000'000;
constexpr std::size_t kMostValues = 8'000'000;
constexpr Time kRampStep = std::chrono::milliseconds(20);

/// Rejects non-JSON that JSON-GLib accepts (comments, assignments), and nesting so deep that its
/// recursive parser would overflow the stack.
tl::expected<void, FormatError>
check_structure(std::string_view text)
{
  bool in_string = false;
  int depth = 0;
  std::size_t containers = 0;
  std::size_t values = 0;
  std::size_t line = 1;
  const auto wrong = [&line](std::string reason) {
    return tl::unexpected(FormatError::at_line(line, std::move(reason)));
  };
  for (std::size_t i = 0; i < text.size(); i++) {
    const char c = text[i];
    if (c == '\n')
      line++;
    if (in_string) {
      if (c == '\\')
        i++;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest)
        return wrong("nested more than " + std::to_string(kDeepest) + " deep");
      containers++;
    } else if (c == ']' || c == '}') {
      depth--;
    } else if (c == ',') {
      values++;
    } else if (!g_ascii_isspace(c) && !g_ascii_isalnum(c)
               && std::string_view(":+-.").find(c) == std::string_view::npos) {
      return wrong("this is no JSON");
    }
    if (containers > kMostContainers || values > kMostValues)
      return wrong("more than " + std::to_string(kMostContainers) + " objects or "
                   + std::to_string(kMostValues) + " values");
  }
  return {};
}

/// An object of the document with its path. A member that is missing or of another type sets
/// `error` and reads as 0 or nothing.
class Object
{
public:
  Object(JsonNode *node, std::string path, FirstError &error)
      : path_(std::move(path)), error_(&error)
  {
    if (node && JSON_NODE_HOLDS_OBJECT(node))
      object_ = json_node_get_object(node);
    else
      fail("expected an object");
  }

  void fail(const std::string &reason) const
  {
    error_->set({ .place = path_.empty() ? "document" : path_, .reason = reason });
  }

  bool has(const char *name) const
  {
    return object_ && json_object_has_member(object_, name);
  }

  double number(const char *name, double otherwise) const
  {
    return has(name) ? number(name) : otherwise;
  }

  double number(const char *name) const
  {
    JsonNode *node = member(name);
    const GType type
        = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : G_TYPE_INVALID;
    const double value = type == G_TYPE_DOUBLE  ? json_node_get_double(node)
                         : type == G_TYPE_INT64 ? static_cast<double>(json_node_get_int(node))
                                                : NAN;
    if (std::isfinite(value))
      return value;
    fail(std::string("expected a number '") + name + "'");
    return 0;
  }

  int integer(const char *name, int least, int most) const
  {
    const double value = number(name);
    if (value >= least && value <= most && value == std::floor(value))
      return static_cast<int>(value);
    fail(std::string("expected a whole number '") + name + "' from " + std::to_string(least)
         + " to " + std::to_string(most));
    return least;
  }

  /// Null, without an error, if the member is missing or not a string.
  const char *find_text(const char *name) const
  {
    JsonNode *node = member(name);
    return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING
               ? json_node_get_string(node)
               : nullptr;
  }

  std::string text(const char *name) const
  {
    const char *text = find_text(name);
    if (!text)
      fail(std::string("expected a text '") + name + "'");
    return text ? text : "";
  }

  Object object(const char *name) const
  {
    return { member(name), path_ + (path_.empty() ? "" : ".") + name, *error_ };
  }

  std::size_t size(const char *name) const
  {
    JsonArray *elements = array(name);
    return elements ? json_array_get_length(elements) : 0;
  }

  Object element(const char *name, std::size_t index) const
  {
    JsonArray *elements = array(name);
    return { elements ? json_array_get_element(elements, static_cast<guint>(index)) : nullptr,
             path_ + (path_.empty() ? "" : ".") + name + "[" + std::to_string(index) + "]",
             *error_ };
  }

private:
  JsonNode *member(const char *name) const
  {
    return object_ ? json_object_get_member(object_, name) : nullptr;
  }

  JsonArray *array(const char *name) const
  {
    JsonNode *node = member(name);
    if (node && JSON_NODE_HOLDS_ARRAY(node))
      return json_node_get_array(node);
    fail(std::string("expected an array '") + name + "'");
    return nullptr;
  }

  JsonObject *object_ = nullptr; ///< null after an error
  std::string path_;
  FirstError *error_;
};

/// A step of one effect's level on a channel.
struct Change
{
  Time time;
  std::size_t channel;
  std::size_t effect;
  double value;
};

class Reader
{
public:
  tl::expected<Track, FormatError> operator()(JsonNode *document)
  {
    const Object root(document, "", error_);
    Track track = read(root);
    if (root.has("description"))
      track.set_rate(description_rate(root));
    return std::move(error_).unless_set(std::move(track));
  }

private:
  Track read(const Object &root)
  {
    timescale_ = root.number("timescale", kTimescale);
    if (!(timescale_ >= 1 && timescale_ <= 48'000))
      root.fail("expected a timescale from 1 to 48000");
    if (const std::size_t count = root.size("perceptions"); count != 1) {
      root.fail("expected one perception, got " + std::to_string(count));
      return Track();
    }
    const Object perception = root.element("perceptions", 0);
    if (perception.text("perception_modality") != "Vibrotactile")
      perception.fail("expected the modality Vibrotactile");
    const std::size_t channels = perception.size("channels");
    constexpr auto kMost
        = static_cast<std::size_t>(kMaxGridSide) * static_cast<std::size_t>(kMaxGridSide);
    if (channels < 1 || channels > kMost) {
      perception.fail("expected 1 to " + std::to_string(kMost) + " channels");
      return Track();
    }
    find_grid(perception, channels);
    for (std::size_t i = 0; i < channels && !error_; i++)
      read_channel(perception.element("channels", i), i);
    return error_ ? Track() : make_track(channels);
  }

  /// 0 if the description has no "rate=".
  static double description_rate(const Object &root)
  {
    const char *words = root.find_text("description");
    const tl::expected<GridHeader, FormatError> header = read_grid(words ? words : "", 1);
    return header ? header->rate : 0;
  }

  void find_grid(const Object &perception, std::size_t channels)
  {
    const Object first = perception.element("channels", 0);
    has_places_ = first.has("actuator_resolution") && first.has("actuator_target");
    if (has_places_) {
      const Object size = first.object("actuator_resolution");
      grid_ = { size.integer("Y", 1, kMaxGridSide), size.integer("X", 1, kMaxGridSide) };
      if (size.has("Z") && size.integer("Z", 0, 1) > 1)
        size.fail("expected tactors in one plane");
    } else if (channels <= static_cast<std::size_t>(kMaxGridSide)) {
      grid_ = { 1, static_cast<int>(channels) };
    } else {
      perception.fail("channels without actuator_resolution and actuator_target: at most 64");
    }
    cells_.resize(channels);
  }

  void read_channel(const Object &channel, std::size_t index)
  {
    if (has_places_)
      for (std::size_t i = 0; i < channel.size("actuator_target") && !error_; i++) {
        const Object place = channel.element("actuator_target", i);
        const int column = place.integer("X", 0, grid_.columns - 1);
        const int row = grid_.rows - 1 - place.integer("Y", 0, grid_.rows - 1);
        cells_[index].push_back(static_cast<std::size_t>(row * grid_.columns + column));
      }
    else
      cells_[index].push_back(index);
    const double gain = channel.number("gain", 1);
    for (std::size_t b = 0; b < channel.size("bands") && !error_; b++) {
      const Object band = channel.element("bands", b);
      const std::string type = band.text("band_type");
      // The reference encoder always writes a band of transients, even an empty one.
      if (type == "Transient" && is_empty(band))
        continue;
      if (type != "Curve" && type != "VectorialWave")
        band.fail("bands of type " + type + " cannot be a track; only Curve and VectorialWave");
      for (std::size_t e = 0; !error_ && e < band.size("effects"); e++)
        read_effect(band.element("effects", e), index, gain);
    }
  }

  static bool is_empty(const Object &band)
  {
    for (std::size_t e = 0; e < band.size("effects"); e++) {
      const Object effect = band.element("effects", e);
      if (is_reference(effect) || effect.size("keyframes") > 0)
        return false;
    }
    return true;
  }

  static bool is_reference(const Object &effect)
  {
    return effect.has("effect_type") && effect.text("effect_type") != "Basis";
  }

  void read_effect(const Object &effect, std::size_t channel, double gain)
  {
    if (is_reference(effect))
      effect.fail("only effects of type Basis can be a track");
    const double position = effect.number("position", 0);
    const std::size_t id = effects_++;
    std::optional<StepCurve::Point> last;
    std::size_t count = effect.size("keyframes");
    for (std::size_t k = 0; k < count && !error_; k++) {
      const Object keyframe = effect.element("keyframes", k);
      const double at = position + keyframe.number("relative_position", 0);
      if (!(at >= 0 && at * 1e9 / timescale_ <= static_cast<double>(Track::kMaxEnd.count()))
          || at != std::floor(at))
        keyframe.fail("expected a whole position within 100 hours");
      // A keyframe of a wave may set its frequency only.
      if (!keyframe.has("amplitude_modulation"))
        continue;
      const StepCurve::Point point{
        static_cast<std::int64_t>(at),
        std::min(std::abs(keyframe.number("amplitude_modulation") * gain), 1.0)
      };
      if (last && point.position < last->position)
        keyframe.fail("the position is before that of the keyframe before");
      if (last)
        add_segment(keyframe, channel, id, *last, point);
      else
        add(keyframe, point.position, channel, id, point.value);
      last = point;
    }
    if (last)
      add(effect, last_step_.value_or(last->position), channel, id, 0);
    last_step_.reset();
  }

  /// Adds the curve between two keyframes: a step if it takes at most one tick, else constant or a
  /// ramp.
  void add_segment(const Object &where, std::size_t channel, std::size_t effect,
                   const StepCurve::Point &from, const StepCurve::Point &to)
  {
    last_step_.reset();
    if (from.value == to.value)
      return;
    if (to.position - from.position <= 1) {
      add(where, from.position, channel, effect, to.value);
      last_step_ = from.position;
      return;
    }
    const double step
        = std::max(std::chrono::duration<double>(kRampStep).count() * timescale_, 1.0);
    const auto length = static_cast<double>(to.position - from.position);
    for (double at = 0; at < length && !error_; at += step) {
      const double middle = (at + std::min(at + step, length)) / 2 / length;
      add(where, from.position + std::llround(at), channel, effect,
          from.value + (to.value - from.value) * middle);
    }
    add(where, to.position, channel, effect, to.value);
  }

  void add(const Object &where, std::int64_t position, std::size_t channel, std::size_t effect,
           double value)
  {
    if (changes_.size() >= Track::kMaxEntries)
      return where.fail("more changes than a track can have, "
                        + std::to_string(Track::kMaxEntries));
    const auto time
        = static_cast<Time::rep>(std::llround(static_cast<double>(position) * 1e9 / timescale_));
    changes_.push_back({ Time(time), channel, effect, value });
  }

  Track make_track(std::size_t channels)
  {
    std::ranges::stable_sort(changes_, {}, &Change::time);
    struct Active
    {
      std::size_t effect;
      double value;
    };
    std::vector<std::vector<Active>> active(channels);
    Track track(grid_.rows, grid_.columns);
    TactileMap map(grid_.rows, grid_.columns);
    std::vector<double> sums(channels, 0);
    for (std::size_t i = 0; i < changes_.size(); i++) {
      const Change &change = changes_[i];
      std::vector<Active> &effects = active[change.channel];
      std::erase_if(effects, [&](const Active &a) { return a.effect == change.effect; });
      if (change.value != 0)
        effects.push_back({ change.effect, change.value });
      sums[change.channel] = 0;
      for (const Active &a : effects)
        sums[change.channel] += a.value;
      if (i + 1 < changes_.size() && changes_[i + 1].time == change.time)
        continue;
      std::ranges::fill(map.levels, 0.0F);
      for (std::size_t c = 0; c < channels; c++)
        for (const std::size_t cell : cells_[c])
          map.levels[cell]
              = std::min(map.levels[cell] + static_cast<float>(std::min(sums[c], 1.0)), 1.0F);
      if (auto appended = track.append(change.time, map); !appended) {
        error_.set(std::move(appended.error()).within("document"));
        break;
      }
    }
    track.set_end(changes_.empty() ? Time(0) : changes_.back().time);
    return track;
  }

  double timescale_ = kTimescale;
  Grid grid_;
  bool has_places_ = false;
  std::vector<std::vector<std::size_t>> cells_; ///< per channel
  std::size_t effects_ = 0;
  std::optional<std::int64_t> last_step_; ///< position of the last segment, if it was a step
  std::vector<Change> changes_;
  FirstError error_;
};

} // namespace

tl::expected<Track, FormatError>
read_hjif(std::string_view text)
{
  if (const auto checked = check_structure(text); !checked)
    return tl::unexpected(checked.error());
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) error = nullptr;
  if (!json_parser_load_from_data(parser, text.data(), static_cast<gssize>(text.size()), &error))
    return tl::unexpected(FormatError{ .place = "document", .reason = error->message });
  return Reader()(json_parser_get_root(parser));
}

} // namespace tactile
