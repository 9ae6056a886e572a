// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/haptic.h"

#include "tracks/formats/decimal.h"
#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"
#include "tracks/formats/pitch.h"
#include "tracks/formats/step_curve.h"

#include <algorithm>
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

void
add_points(std::string &text, const StepCurve &curve, const std::string &name)
{
  for (const StepCurve::Point &point : curve.points()) {
    if (&point != &curve.points().front())
      text += ',';
    text += "\n{\"time\":" + seconds(std::chrono::milliseconds(point.position)) + ",\"" + name
            + "\":" + decimal(static_cast<float>(point.value)) + "}";
  }
}

/// A map without a frequency has that of the one before. Haptics Studio exports both envelopes with
/// one end.
StepCurve
pitches(const Track &track, std::int64_t end)
{
  StepCurve curve;
  const auto first = std::ranges::find_if(
      track.entries(), [](const Track::Entry &entry) { return entry.map.frequency > 0; });
  curve.step(0, static_cast<double>(pitch_of(first->map.frequency)));
  for (auto entry = first; entry != track.entries().end(); ++entry)
    if (entry->map.frequency > 0)
      curve.step(std::chrono::floor<std::chrono::milliseconds>(entry->time).count(),
                 static_cast<double>(pitch_of(entry->map.frequency)));
  curve.hold(end);
  return curve;
}

using Points = std::vector<LevelCurves::Point>;

/// The points of an envelope, from the beginning to the end of the signal; a point's emphasis is
/// passed on.
template <typename OnPoint>
Points
read_envelope(const JsonMembers &envelopes, const char *name, double latest, FirstError &error,
              const OnPoint &on_point)
{
  Points points;
  const std::size_t count = envelopes.size(name);
  for (std::size_t i = 0; i < count && !error; i++) {
    const JsonMembers breakpoint = envelopes.element(name, i);
    const double at = breakpoint.number("time") * kTicks;
    if (!(at >= 0 && at <= latest)) {
      breakpoint.fail("expected a time from 0 to 100 hours");
      break;
    }
    const LevelCurves::Point point{ std::llround(at), part(breakpoint, name) };
    if (!points.empty() && points.back().position > point.position)
      breakpoint.fail("the time is before that of the breakpoint before");
    points.push_back(point);
    on_point(breakpoint, point);
  }
  return points;
}

} // namespace

std::string
write_haptic(const Track &track)
{
  std::string text = "{\"version\":{\"major\":1,\"minor\":0,\"patch\":0},"
                     "\"metadata\":{\"editor\":\"visuotactile\",\"author\":\"\",\"source\":\"\","
                     "\"project\":\"\",\"tags\":[],\"description\":\"\"},"
                     "\"signals\":{\"continuous\":{\"envelopes\":{\"amplitude\":[";
  const StepCurve amplitude = strongest_cell(track);
  add_points(text, amplitude, "amplitude");
  if (has_frequency(track)) {
    text += "\n],\"frequency\":[";
    add_points(text, pitches(track, amplitude.points().back().position), "frequency");
  }
  return text + "\n]}}}}\n";
}

tl::expected<Track, FormatError>
read_haptic(std::string_view text)
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
  const auto check = [&](const tl::expected<void, FormatError> &done) {
    if (!done)
      envelopes.fail(done.error().reason);
  };
  Points emphases; // with their frequencies
  const Points envelope = read_envelope(
      envelopes, "amplitude", curves.latest(), error,
      [&](const JsonMembers &breakpoint, const LevelCurves::Point &point) {
        if (!breakpoint.has("emphasis"))
          return;
        const JsonMembers emphasis = breakpoint.object("emphasis");
        const std::int64_t end = point.position + kEmphasis;
        const double more = part(emphasis, "amplitude") - point.level;
        if (more > 0)
          add(breakpoint, { { point.position, more }, { end, more } });
        if (more > 0 && emphasis.has("frequency"))
          emphases.push_back({ point.position, frequency_of(part(emphasis, "frequency")) });
      });
  if (envelope.empty())
    envelopes.fail("expected an amplitude envelope that is not empty");
  add(envelopes, envelope);
  Points pitches;
  if (envelopes.has("frequency"))
    pitches = read_envelope(envelopes, "frequency", curves.latest(), error, [](auto, auto) {});
  for (LevelCurves::Point &point : pitches)
    point.level = frequency_of(point.level);
  if (!pitches.empty() && !error) {
    pitches.insert(pitches.begin(), { 0, pitches.front().level });
    pitches.push_back({ std::max(pitches.back().position, envelope.back().position) + kEmphasis,
                        pitches.back().level });
  }
  for (std::size_t i = 1; i < pitches.size() && !error; i++)
    check(curves.set_frequency(pitches[i - 1], pitches[i]));
  for (std::size_t i = 0; i < emphases.size() && !error; i++)
    check(
        curves.set_frequency(emphases[i], { emphases[i].position + kEmphasis, emphases[i].level }));
  if (error)
    return std::move(error).unless_set(Track());
  return curves.join();
}

} // namespace tactile
