// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/ahap.h"

#include "tracks/formats/decimal.h"
#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"
#include "tracks/formats/pitch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr double kTicks = 1e6; ///< per second
constexpr std::int64_t kStepLength = 1000;
constexpr double kTransient = 0.030; ///< s
constexpr auto kLongestEvent = std::chrono::seconds(30);

using Points = std::vector<LevelCurves::Point>;

/// A value of the pattern over time: linear between points, constant before and after them.
class Control
{
public:
  /// `otherwise` holds before the first point.
  explicit Control(double otherwise) : otherwise_(otherwise)
  {
  }

  /// Continues from the level at the first point's time.
  void add(const Points &points)
  {
    if (points.empty())
      return;
    const LevelCurves::Point hold{ points.front().position, at(points.front().position) };
    const auto later = std::ranges::lower_bound(points_, hold.position, {}, position_of);
    points_.erase(later, points_.end());
    points_.push_back(hold);
    points_.insert(points_.end(), points.begin(), points.end());
  }

  double at(std::int64_t position) const
  {
    const auto after = std::ranges::upper_bound(points_, position, {}, position_of);
    if (after == points_.begin())
      return otherwise_;
    const LevelCurves::Point &from = after[-1];
    if (after == points_.end() || after->position == from.position)
      return from.level;
    const auto done = static_cast<double>(position - from.position);
    return from.level
           + (after->level - from.level) * done
                 / static_cast<double>(after->position - from.position);
  }

  /// The points of an event.
  Points within(std::int64_t begin, std::int64_t end) const
  {
    Points points{ { begin, at(begin) } };
    for (auto i = std::ranges::upper_bound(points_, begin, {}, position_of);
         i != points_.end() && i->position < end; ++i)
      points.push_back(*i);
    points.push_back({ end, before(end) });
    return points;
  }

private:
  static std::int64_t position_of(const LevelCurves::Point &point)
  {
    return point.position;
  }

  /// The value that a step at `position` ends.
  double before(std::int64_t position) const
  {
    const auto here = std::ranges::lower_bound(points_, position, {}, position_of);
    return here != points_.end() && here->position == position ? here->level : at(position);
  }

  double otherwise_;
  Points points_;
};

struct Event
{
  std::int64_t begin;
  std::int64_t end;
  double intensity;
  std::optional<double> sharpness;
};

class Reader
{
public:
  explicit Reader(std::vector<std::string> &ignored) : ignored_(ignored)
  {
  }

  tl::expected<Track, FormatError> operator()(const JsonDocument &document)
  {
    const JsonMembers root = document.root(error_);
    const std::size_t count = root.size("Pattern");
    for (std::size_t i = 0; i < count && !error_; i++) {
      const JsonMembers each = root.element("Pattern", i);
      if (each.has("Event"))
        read_event(each.object("Event"));
      else if (each.has("ParameterCurve"))
        read_curve(each.object("ParameterCurve"));
      else if (each.has("Parameter"))
        read_parameter(each.object("Parameter"));
    }
    const Control intensity = joined(intensities_, 1);
    const Control sharpness = joined(sharpnesses_, 0);
    std::ranges::stable_sort(events_, {}, &Event::begin);
    LevelCurves curves(kTicks, kStepLength);
    std::size_t used = 0;
    const auto check = [&](const tl::expected<void, FormatError> &added) {
      if (!added)
        root.fail(added.error().reason);
    };
    for (const Event &event : events_) {
      if (error_)
        break;
      Points points = intensity.within(event.begin, event.end);
      for (LevelCurves::Point &point : points)
        point.level *= event.intensity;
      Points pitches = sharpness.within(event.begin, event.end);
      for (LevelCurves::Point &point : pitches)
        point.level = event.sharpness ? frequency_of(*event.sharpness + point.level) : 0;
      used += points.size() + pitches.size();
      if (used > 2 * Track::kMaxEntries)
        root.fail("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
      else
        check(curves.add(0, points));
      for (std::size_t i = 1; i < pitches.size() && is_sharp_ && !error_; i++)
        check(curves.set_frequency(pitches[i - 1], pitches[i]));
    }
    if (error_)
      return std::move(error_).unless_set(Track());
    if (curves.has_lost_frequency())
      ignore("the sharpness of events that overlap others");
    return curves.join();
  }

private:
  /// A time in seconds, in ticks.
  std::int64_t ticks(const JsonMembers &of, const char *name, std::int64_t after = 0)
  {
    const double at = static_cast<double>(after) + std::max(of.number(name, 0), 0.0) * kTicks;
    if (at <= LevelCurves(kTicks, kStepLength).latest())
      return std::llround(at);
    of.fail(std::string("expected '") + name + "' within 100 hours");
    return 0;
  }

  static double value(const JsonMembers &of, double otherwise, double least = 0)
  {
    return std::clamp(of.number("ParameterValue", otherwise), least, 1.0);
  }

  static Control joined(std::vector<Points> &curves, double otherwise)
  {
    std::ranges::stable_sort(curves, {},
                             [](const Points &points) { return points.front().position; });
    Control control(otherwise);
    for (const Points &points : curves)
      control.add(points);
    return control;
  }

  static bool is(const JsonMembers &of, const char *name, std::string_view word)
  {
    const char *text = of.find_text(name);
    return text && text == word;
  }

  void read_event(const JsonMembers &event)
  {
    const bool is_transient = is(event, "EventType", "HapticTransient");
    if (!is_transient && !is(event, "EventType", "HapticContinuous"))
      return ignore("the sounds");
    double intensity = 1;
    std::optional<double> sharpness;
    const std::size_t count = event.has("EventParameters") ? event.size("EventParameters") : 0;
    for (std::size_t i = 0; i < count; i++) {
      const JsonMembers each = event.element("EventParameters", i);
      if (is(each, "ParameterID", "HapticIntensity"))
        intensity = value(each, 1);
      else if (is(each, "ParameterID", "HapticSharpness"))
        sharpness = value(each, 0);
      else
        ignore("events' envelopes");
    }
    is_sharp_ = is_sharp_ || sharpness.value_or(0) > 0;
    const std::int64_t begin = ticks(event, "Time");
    const std::int64_t end = is_transient ? begin + std::llround(kTransient * kTicks)
                                          : ticks(event, "EventDuration", begin);
    if (end > begin)
      events_.push_back({ begin, end, intensity, sharpness });
  }

  /// The curves of a parameter; null after a loss.
  std::vector<Points> *curves_of(const JsonMembers &parameter)
  {
    if (is(parameter, "ParameterID", "HapticIntensityControl"))
      return &intensities_;
    if (is(parameter, "ParameterID", "HapticSharpnessControl"))
      return &sharpnesses_;
    ignore("parameters other than intensity and sharpness");
    return nullptr;
  }

  /// A point of a curve; the control of the sharpness is an offset.
  LevelCurves::Point point(const JsonMembers &of, std::int64_t after, const std::vector<Points> &in)
  {
    const bool is_offset = &in == &sharpnesses_;
    const double level = value(of, is_offset ? 0 : 1, is_offset ? -1 : 0);
    is_sharp_ = is_sharp_ || (is_offset && level != 0);
    return { ticks(of, "Time", after), level };
  }

  void read_curve(const JsonMembers &curve)
  {
    std::vector<Points> *curves = curves_of(curve);
    if (!curves)
      return;
    const std::int64_t begin = ticks(curve, "Time");
    Points points;
    const std::size_t count = curve.size("ParameterCurveControlPoints");
    for (std::size_t i = 0; i < count && !error_; i++)
      points.push_back(point(curve.element("ParameterCurveControlPoints", i), begin, *curves));
    std::ranges::stable_sort(points, {}, &LevelCurves::Point::position);
    if (!points.empty())
      curves->push_back(std::move(points));
  }

  void read_parameter(const JsonMembers &parameter)
  {
    if (std::vector<Points> *curves = curves_of(parameter))
      curves->push_back({ point(parameter, 0, *curves) });
  }

  void ignore(const char *part)
  {
    if (std::ranges::find(ignored_, part) == ignored_.end())
      ignored_.emplace_back(part);
  }

  std::vector<std::string> &ignored_;
  std::vector<Event> events_;
  std::vector<Points> intensities_;
  std::vector<Points> sharpnesses_; ///< offsets
  bool is_sharp_ = false;           ///< any sharpness is above 0
  FirstError error_;
};

} // namespace

std::string
write_ahap(const Track &track)
{
  std::string text = "{\"Version\":1.0,\"Metadata\":{\"Project\":\"visuotactile\"},\"Pattern\":[";
  const char *separator = "\n";
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++) {
    const float level = std::ranges::max(entries[i].map.levels);
    const float frequency = entries[i].map.frequency;
    const std::string sharpness = frequency > 0 ? decimal(pitch_of(frequency)) : "0.0";
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    auto begin = std::chrono::floor<std::chrono::milliseconds>(entries[i].time);
    auto left = std::chrono::floor<std::chrono::milliseconds>(end) - begin;
    while (level > 0 && left.count() > 0) {
      const auto length = std::min<std::chrono::milliseconds>(left, kLongestEvent);
      text += separator + ("{\"Event\":{\"Time\":" + seconds(begin))
              + ",\"EventType\":\"HapticContinuous\",\"EventDuration\":" + seconds(length)
              + ",\"EventParameters\":[{\"ParameterID\":\"HapticIntensity\",\"ParameterValue\":"
              + decimal(level)
              + "},{\"ParameterID\":\"HapticSharpness\",\"ParameterValue\":" + sharpness + "}]}}";
      separator = ",\n";
      begin += length;
      left -= length;
    }
  }
  return text + "\n]}\n";
}

tl::expected<Track, FormatError>
read_ahap(std::string_view text, std::vector<std::string> &ignored)
{
  return JsonDocument::parse(text).and_then(
      [&](const JsonDocument &document) { return Reader(ignored)(document); });
}

} // namespace tactile
