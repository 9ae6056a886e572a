// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/haptic.h"

#include "tracks/formats/decimal.h"
#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"
#include "tracks/formats/step_curve.h"

#include <cmath>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr double kTicks = 1e6; ///< per second
constexpr std::int64_t kStepLength = 1000;
constexpr std::int64_t kEmphasis = 30'000;

/// A member from 0 to 1.
double
part(const JsonMembers &of, const char *name)
{
  const double value = of.number(name);
  if (!(value >= 0 && value <= 1))
    of.fail(std::string("expected '") + name + "' from 0 to 1");
  return value;
}

} // namespace

std::string
write_haptic(const Track &track)
{
  std::string text = "{\"version\":{\"major\":1,\"minor\":0,\"patch\":0},"
                     "\"metadata\":{\"editor\":\"visuotactile\",\"author\":\"\",\"source\":\"\","
                     "\"project\":\"\",\"tags\":[],\"description\":\"\"},"
                     "\"signals\":{\"continuous\":{\"envelopes\":{\"amplitude\":[";
  const StepCurve curve = strongest_cell(track);
  for (const StepCurve::Point &point : curve.points()) {
    if (&point != &curve.points().front())
      text += ',';
    text += "\n{\"time\":" + seconds(std::chrono::milliseconds(point.position))
            + ",\"amplitude\":" + decimal(static_cast<float>(point.value)) + "}";
  }
  return text + "\n]}}}}\n";
}

tl::expected<Track, FormatError>
read_haptic(std::string_view text, std::vector<std::string> &ignored)
{
  const auto document = JsonDocument::parse(text);
  if (!document)
    return tl::unexpected(document.error());
  FirstError error;
  const JsonMembers root = document->root(error);
  if (const JsonMembers version = root.object("version"); version.number("major") != 1)
    version.fail("expected version 1, as Haptics Studio writes it");
  const JsonMembers envelopes = root.object("signals").object("continuous").object("envelopes");
  LevelCurves curves(kTicks, kStepLength);
  const auto add = [&](const JsonMembers &where, const std::vector<LevelCurves::Point> &points) {
    if (error)
      return;
    if (const auto added = curves.add(0, points); !added)
      where.fail(added.error().reason);
  };
  std::vector<LevelCurves::Point> envelope;
  const std::size_t count = envelopes.size("amplitude");
  if (count == 0)
    envelopes.fail("expected an amplitude envelope that is not empty");
  for (std::size_t i = 0; i < count && !error; i++) {
    const JsonMembers breakpoint = envelopes.element("amplitude", i);
    const double at = breakpoint.number("time") * kTicks;
    if (!(at >= 0 && at <= curves.latest())) {
      breakpoint.fail("expected a time from 0 to 100 hours");
      break;
    }
    const LevelCurves::Point point{ std::llround(at), part(breakpoint, "amplitude") };
    if (!envelope.empty() && envelope.back().position > point.position)
      breakpoint.fail("the time is before that of the breakpoint before");
    envelope.push_back(point);
    if (!breakpoint.has("emphasis"))
      continue;
    const double more = part(breakpoint.object("emphasis"), "amplitude") - point.level;
    if (more > 0)
      add(breakpoint, { { point.position, more }, { point.position + kEmphasis, more } });
  }
  add(envelopes, envelope);
  if (envelopes.has("frequency"))
    ignored.emplace_back("the frequencies");
  if (error)
    return std::move(error).unless_set(Track());
  return curves.join(Track(1, 1), std::vector<std::vector<std::size_t>>{ { 0 } });
}

} // namespace tactile
