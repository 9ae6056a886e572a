// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/funscript.h"

#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"
#include "tracks/formats/step_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr double kTicks = 1e6; ///< per second
constexpr double kTicksPerMillisecond = 1e3;
constexpr std::int64_t kStepLength = 1000;

bool
is_vibration(std::string_view axis)
{
  constexpr std::array<std::string_view, 4> kNames = { "V0", "vib", "vibe", "vibration" };
  return std::ranges::find(kNames, axis) != kNames.end();
}

/// The object that has the actions to play: of `axes`, a list with ids (as MultiFunPlayer reads
/// them), of `channels` (funscript 2.0) or `tracks`, objects by name, or the document.
JsonMembers
chosen_axis(const JsonMembers &root, bool &is_one_of_many)
{
  std::size_t count = 0;
  std::optional<JsonMembers> chosen;
  int best = -1;
  const auto offer = [&](const JsonMembers &axis, bool is_vibration) {
    count++;
    const bool has_actions = axis.has("actions") && axis.size("actions") > 0;
    const int rank = has_actions ? 1 + is_vibration : 0;
    if (rank <= best)
      return;
    chosen = axis;
    best = rank;
  };
  if (root.has("actions") && root.size("actions") > 0)
    offer(root, false);
  const std::size_t axes = root.has("axes") ? root.size("axes") : 0;
  for (std::size_t i = 0; i < axes; i++) {
    const JsonMembers axis = root.element("axes", i);
    const char *id = axis.find_text("id");
    offer(axis, id && is_vibration(id));
  }
  for (const char *group : { "channels", "tracks" })
    if (root.has_object(group))
      for (const std::string &name : root.object(group).names())
        if (root.object(group).has_object(name.c_str()))
          offer(root.object(group).object(name.c_str()), is_vibration(name));
  is_one_of_many = count > 1;
  return chosen.value_or(root);
}

/// "[…]"
std::string
actions_of(const Track &track, bool is_inverted)
{
  std::string text = "[";
  const StepCurve curve = strongest_cell(track, 100);
  for (const StepCurve::Point &point : curve.points()) {
    if (&point != &curve.points().front())
      text += ',';
    const long position = std::lround(point.value);
    text += "\n{\"at\":" + std::to_string(point.position)
            + ",\"pos\":" + std::to_string(is_inverted ? 100 - position : position) + "}";
  }
  return text + "\n]";
}

} // namespace

std::string
write_funscript(const Track &track)
{
  return "{\"version\":\"1.0\",\"inverted\":false,\"range\":100,\"actions\":"
         + actions_of(track, false) + "}\n";
}

tl::expected<std::string, FormatError>
funscript_with(std::string_view text, const Track &track)
{
  return JsonDocument::parse(text).and_then(
      [&](const JsonDocument &document) -> tl::expected<std::string, FormatError> {
        FirstError error;
        const JsonMembers root = document.root(error);
        bool is_one_of_many = false;
        const JsonMembers axis = chosen_axis(root, is_one_of_many);
        axis.set("actions", actions_of(track, root.flag("inverted", false)));
        return std::move(error).unless_set(document.text());
      });
}

tl::expected<Track, FormatError>
read_funscript(std::string_view text, std::vector<std::string> &ignored)
{
  const auto document = JsonDocument::parse(text);
  if (!document)
    return tl::unexpected(document.error());
  FirstError error;
  const JsonMembers root = document->root(error);
  bool is_one_of_many = false;
  const JsonMembers axis = chosen_axis(root, is_one_of_many);
  if (is_one_of_many)
    ignored.emplace_back("the other axes");
  const bool is_inverted = root.flag("inverted", false);
  LevelCurves curves(kTicks, kStepLength);
  std::vector<LevelCurves::Point> points;
  bool has_early = false;
  const std::size_t count = error ? 0 : axis.size("actions");
  for (std::size_t i = 0; i < count && !error; i++) {
    const JsonMembers action = axis.element("actions", i);
    const double at = action.number("at") * kTicksPerMillisecond;
    const double position = std::clamp(action.number("pos") / 100, 0.0, 1.0);
    if (!(at <= curves.latest()))
      action.fail("expected a time up to 100 hours, in milliseconds");
    else if (at < 0)
      has_early = true;
    else
      points.push_back({ std::llround(at), is_inverted ? 1 - position : position });
  }
  if (has_early) // as OFS, MultiFunPlayer and ScriptPlayer do
    ignored.emplace_back("the actions before 0:00");
  std::ranges::stable_sort(points, {}, &LevelCurves::Point::position);
  if (const auto added = curves.add(0, points); !added)
    axis.fail(added.error().reason);
  if (error)
    return std::move(error).unless_set(Track());
  return curves.join();
}

} // namespace tactile
