// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/tact.h"

#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr int kRows = 5;
constexpr int kColumns = 4;
constexpr int kMotors = kRows * kColumns;
constexpr double kTicks = 1e6; ///< per second
constexpr double kTicksPerMillisecond = 1e3;
constexpr std::int64_t kStepLength = 1000;
constexpr std::int64_t kInterval = 20'000;
constexpr std::array<std::string_view, 2> kSides = { "VestFront", "VestBack" };

/// How an intensity changes during a feedback.
enum class Fade
{
  none,
  in,
  out,
  in_out,
};

Fade
fade_of(const JsonMembers &feedback)
{
  const char *text = feedback.find_text("playbackType");
  const std::string_view type = text ? text : "NONE";
  return type == "FADE_IN"       ? Fade::in
         : type == "FADE_OUT"    ? Fade::out
         : type == "FADE_IN_OUT" ? Fade::in_out
                                 : Fade::none;
}

/// The part of the intensity after this part of the duration.
double
faded(Fade fade, double done)
{
  switch (fade) {
  case Fade::in:
    return done;
  case Fade::out:
    return 1 - done;
  case Fade::in_out:
    return 1 - std::abs(2 * done - 1);
  case Fade::none:
    break;
  }
  return 1;
}

struct Span
{
  std::int64_t begin;
  std::int64_t end;

  bool is_empty() const
  {
    return end <= begin;
  }
};

struct PathPoint
{
  std::int64_t at;
  double x; ///< columns from the left
  double y; ///< rows from the top
  double intensity;
};

class Reader
{
public:
  tl::expected<Track, FormatError> operator()(const JsonDocument &document,
                                              std::vector<std::string> &ignored)
  {
    const JsonMembers root = document.root(error_);
    const JsonMembers project = root.has("project") ? root.object("project") : root;
    for (std::size_t i = 0; i < project.size("tracks") && !error_; i++) {
      const JsonMembers layer = project.element("tracks", i);
      if (!layer.flag("enable", true) || !layer.has("effects"))
        continue;
      for (std::size_t e = 0; e < layer.size("effects") && !error_; e++)
        read_effect(layer.element("effects", e));
    }
    if (!error_ && !has_vest_ && !devices_.empty())
      project.fail("expected patterns of a vest (VestFront, VestBack), got " + list(devices_));
    if (error_)
      return std::move(error_).unless_set(Track());
    std::set<std::string> others = devices_;
    if (std::erase_if(others, [](const std::string &name) { return is_side(name); }) > 1)
      ignored.emplace_back("the side of each pattern, as front and back are added");
    if (!others.empty())
      ignored.push_back("the patterns of " + list(others));
    std::vector<std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < kMotors; i++)
      cells.push_back({ i });
    return curves_.join(Track(kRows, kColumns), cells);
  }

private:
  static bool is_side(std::string_view device)
  {
    return std::ranges::find(kSides, device) != kSides.end();
  }

  static std::string list(const std::set<std::string> &names)
  {
    std::string text;
    for (const std::string &name : names)
      text += (text.empty() ? "" : ", ") + name.substr(0, 20);
    return text.substr(0, 100);
  }

  /// A time in ticks; 0 after an error.
  std::int64_t ticks(const JsonMembers &of, const char *name)
  {
    const double at = of.number_or_text(name) * kTicksPerMillisecond;
    if (at >= 0 && at <= curves_.latest())
      return std::llround(at);
    of.fail(std::string("expected '") + name + "' from 0 to 100 hours, in milliseconds");
    return 0;
  }

  static double part(const JsonMembers &of, const char *name)
  {
    return std::clamp(of.number_or_text(name), 0.0, 1.0);
  }

  void add(const JsonMembers &where, int motor, const std::vector<LevelCurves::Point> &points)
  {
    if (error_)
      return;
    if (const auto added = curves_.add(static_cast<std::size_t>(motor), points); !added)
      where.fail(added.error().reason);
  }

  void read_effect(const JsonMembers &effect)
  {
    const std::int64_t begin = ticks(effect, "startTime");
    const Span span{ begin, begin + ticks(effect, "offsetTime") };
    const JsonMembers modes = effect.object("modes");
    for (const std::string &name : modes.names())
      devices_.insert(name);
    for (const std::string_view side : kSides) {
      if (error_ || !modes.has(side.data()))
        continue;
      has_vest_ = true;
      const JsonMembers mode = modes.object(side.data());
      const char *kind = mode.find_text("mode");
      const bool is_path = kind && std::string_view(kind) == "PATH_MODE";
      const char *name = is_path ? "pathMode" : "dotMode";
      if (!mode.has(name) || !mode.object(name).has("feedback"))
        continue;
      const JsonMembers part = mode.object(name);
      for (std::size_t i = 0; i < part.size("feedback") && !error_; i++)
        if (is_path)
          read_path(part.element("feedback", i), span);
        else
          read_dots(part.element("feedback", i), span);
    }
  }

  void read_dots(const JsonMembers &feedback, const Span &effect)
  {
    const std::int64_t begin = effect.begin + ticks(feedback, "startTime");
    const std::int64_t end = effect.begin + ticks(feedback, "endTime");
    const Span span{ begin, std::min(end, effect.end) };
    const Fade fade = fade_of(feedback);
    for (std::size_t i = 0; i < feedback.size("pointList") && !error_; i++) {
      const JsonMembers dot = feedback.element("pointList", i);
      const int motor = dot.integer("index", 0, kMotors - 1);
      const double intensity = part(dot, "intensity");
      if (span.is_empty() || intensity == 0)
        continue;
      const std::int64_t middle = std::midpoint(span.begin, span.end);
      add(dot, motor,
          { { span.begin, intensity * faded(fade, 0) },
            { middle, intensity * faded(fade, 0.5) },
            { span.end, intensity * faded(fade, 1) } });
    }
  }

  void read_path(const JsonMembers &feedback, const Span &effect)
  {
    std::vector<PathPoint> path;
    for (std::size_t i = 0; i < feedback.size("pointList") && !error_; i++) {
      const JsonMembers point = feedback.element("pointList", i);
      path.push_back({ .at = effect.begin + ticks(point, "time"),
                       .x = part(point, "x") * (kColumns - 1),
                       .y = part(point, "y") * (kRows - 1),
                       .intensity = part(point, "intensity") });
      if (path.size() > 1 && path.end()[-2].at > path.back().at)
        point.fail("the time is before that of the point before");
    }
    if (error_ || path.empty())
      return;
    if (path.size() == 1) { // it stands until the effect ends
      path.push_back(path.front());
      path.back().at = effect.end;
    }
    const Span span{ path.front().at, std::min(path.back().at, effect.end) };
    if (!span.is_empty())
      sample(feedback, path, span);
  }

  /// Adds the levels of the motors around the path at each interval.
  void sample(const JsonMembers &feedback, const std::vector<PathPoint> &path, const Span &span)
  {
    const Fade fade = fade_of(feedback);
    const auto length = static_cast<double>(span.end - span.begin);
    auto next = path.begin();
    for (std::int64_t at = span.begin; at < span.end && !error_; at += kInterval) {
      if (++samples_ > Track::kMaxEntries) // silent ones, too
        feedback.fail("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
      const std::int64_t end = std::min(at + kInterval, span.end);
      const std::int64_t middle = std::midpoint(at, end);
      while (next->at <= middle && next + 1 != path.end())
        ++next;
      const PathPoint &to = *next;
      const PathPoint &from = next == path.begin() ? to : next[-1];
      const double done = to.at > from.at ? static_cast<double>(middle - from.at)
                                                / static_cast<double>(to.at - from.at)
                                          : 1;
      const double intensity = std::lerp(from.intensity, to.intensity, done)
                               * faded(fade, static_cast<double>(middle - span.begin) / length);
      share(feedback, { at, end }, std::lerp(from.x, to.x, done), std::lerp(from.y, to.y, done),
            intensity);
    }
  }

  void share(const JsonMembers &where, const Span &span, double x, double y, double intensity)
  {
    const int left = std::min(static_cast<int>(x), kColumns - 2);
    const int top = std::min(static_cast<int>(y), kRows - 2);
    for (const int row : { top, top + 1 })
      for (const int column : { left, left + 1 }) {
        const double level = intensity * (1 - std::abs(x - column)) * (1 - std::abs(y - row));
        if (level > 0)
          add(where, row * kColumns + column, { { span.begin, level }, { span.end, level } });
      }
  }

  LevelCurves curves_{ kTicks, kStepLength };
  std::set<std::string> devices_;
  std::size_t samples_ = 0; ///< of all paths
  bool has_vest_ = false;
  FirstError error_;
};

} // namespace

tl::expected<Track, FormatError>
read_tact(std::string_view text, std::vector<std::string> &ignored)
{
  return JsonDocument::parse(text).and_then(
      [&](const JsonDocument &document) { return Reader()(document, ignored); });
}

} // namespace tactile
