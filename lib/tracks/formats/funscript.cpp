// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/funscript.h"

#include "tracks/formats/step_curve.h"

#include <algorithm>
#include <cmath>

namespace tactile {

std::string
write_funscript(const Track &track)
{
  StepCurve curve;
  for (const Track::Entry &entry : track.entries())
    curve.step(std::chrono::floor<std::chrono::milliseconds>(entry.time).count(),
               std::round(static_cast<double>(std::ranges::max(entry.map.levels)) * 100));
  curve.finish(std::chrono::floor<std::chrono::milliseconds>(track.end()).count());

  std::string text = "{\"version\":\"1.0\",\"inverted\":false,\"range\":100,\"actions\":[";
  for (const StepCurve::Point &point : curve.points()) {
    if (&point != &curve.points().front())
      text += ',';
    text += "\n{\"at\":" + std::to_string(point.position)
            + ",\"pos\":" + std::to_string(std::lround(point.value)) + "}";
  }
  return text + "\n]}\n";
}

} // namespace tactile
