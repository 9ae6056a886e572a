// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/ahap.h"

#include "tracks/formats/decimal.h"
#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr double kTicks = 1e6; ///< per second
constexpr std::int64_t kStepLength = 1000;
constexpr double kTransient = 0.030; ///< s
constexpr auto kLongestEvent = std::chrono::seconds(30);

/// A value of the pattern over time: linear between points, constant before and after them.
class Control
{
public:
  /// Takes over from what is there at the first point's time.
  void add(const std::vector<LevelCurves::Point> &points)
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
      return 1;
    const LevelCurves::Point &from = after[-1];
    if (after == points_.end() || after->position == from.position)
      return from.level;
    const auto done = static_cast<double>(position - from.position);
    return from.level
           + (after->level - from.level) * done
                 / static_cast<double>(after->position - from.position);
  }

  /// The points of an event, with its intensity.
  std::vector<LevelCurves::Point> within(std::int64_t begin, std::int64_t end,
                                         double intensity) const
  {
    std::vector<LevelCurves::Point> points{ { begin, at(begin) * intensity } };
    for (auto i = std::ranges::upper_bound(points_, begin, {}, position_of);
         i != points_.end() && i->position < end; ++i)
      points.push_back({ i->position, i->level * intensity });
    points.push_back({ end, before(end) * intensity });
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

  std::vector<LevelCurves::Point> points_;
};

struct Event
{
  std::int64_t begin;
  std::int64_t end;
  double intensity;
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
    std::ranges::stable_sort(controls_, {},
                             [](const auto &points) { return points.front().position; });
    Control control;
    for (const auto &points : controls_)
      control.add(points);
    LevelCurves curves(kTicks, kStepLength);
    std::size_t used = 0;
    for (const Event &event : events_) {
      if (error_)
        break;
      const auto points = control.within(event.begin, event.end, event.intensity);
      used += points.size();
      if (used > 2 * Track::kMaxEntries)
        root.fail("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
      else if (const auto added = curves.add(0, points); !added)
        root.fail(added.error().reason);
    }
    if (error_)
      return std::move(error_).unless_set(Track());
    return curves.join(Track(1, 1), std::vector<std::vector<std::size_t>>{ { 0 } });
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

  static double value(const JsonMembers &of, double otherwise)
  {
    return std::clamp(of.number("ParameterValue", otherwise), 0.0, 1.0);
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
    const std::size_t count = event.has("EventParameters") ? event.size("EventParameters") : 0;
    for (std::size_t i = 0; i < count; i++) {
      const JsonMembers each = event.element("EventParameters", i);
      if (is(each, "ParameterID", "HapticIntensity"))
        intensity = value(each, 1);
      else
        ignore(is(each, "ParameterID", "HapticSharpness") ? "the sharpness" : "events' envelopes");
    }
    const std::int64_t begin = ticks(event, "Time");
    const std::int64_t end = is_transient ? begin + std::llround(kTransient * kTicks)
                                          : ticks(event, "EventDuration", begin);
    if (end > begin)
      events_.push_back({ begin, end, intensity });
  }

  void read_curve(const JsonMembers &curve)
  {
    if (!is(curve, "ParameterID", "HapticIntensityControl"))
      return ignore("parameters other than the intensity");
    const std::int64_t begin = ticks(curve, "Time");
    std::vector<LevelCurves::Point> points;
    const std::size_t count = curve.size("ParameterCurveControlPoints");
    for (std::size_t i = 0; i < count && !error_; i++) {
      const JsonMembers each = curve.element("ParameterCurveControlPoints", i);
      points.push_back({ ticks(each, "Time", begin), value(each, 1) });
    }
    std::ranges::stable_sort(points, {}, &LevelCurves::Point::position);
    if (!points.empty())
      controls_.push_back(std::move(points));
  }

  void read_parameter(const JsonMembers &parameter)
  {
    if (!is(parameter, "ParameterID", "HapticIntensityControl"))
      return ignore("parameters other than the intensity");
    controls_.push_back({ { ticks(parameter, "Time"), value(parameter, 1) } });
  }

  void ignore(const char *part)
  {
    if (std::ranges::find(ignored_, part) == ignored_.end())
      ignored_.emplace_back(part);
  }

  std::vector<std::string> &ignored_;
  std::vector<Event> events_;
  std::vector<std::vector<LevelCurves::Point>> controls_;
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
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    auto begin = std::chrono::floor<std::chrono::milliseconds>(entries[i].time);
    auto left = std::chrono::floor<std::chrono::milliseconds>(end) - begin;
    while (level > 0 && left.count() > 0) {
      const auto length = std::min<std::chrono::milliseconds>(left, kLongestEvent);
      text += separator + ("{\"Event\":{\"Time\":" + seconds(begin))
              + ",\"EventType\":\"HapticContinuous\",\"EventDuration\":" + seconds(length)
              + ",\"EventParameters\":[{\"ParameterID\":\"HapticIntensity\",\"ParameterValue\":"
              + decimal(level)
              + "},{\"ParameterID\":\"HapticSharpness\",\"ParameterValue\":0.0}]}}";
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
