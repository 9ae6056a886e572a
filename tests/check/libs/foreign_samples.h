// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/formats/track_file.h"

#include <cmath>
#include <string>
#include <vector>

#include "track_samples.h"

namespace {

using tactile::Track;
using tactile::TrackFormat;

using Ignored = std::vector<std::string>;

inline Track
read(const std::string &text, TrackFormat format, Ignored *ignored = nullptr)
{
  const auto track = tactile::read_track(text, format, ignored);
  fail_unless(track.has_value(), "%s", track ? "" : track.error().text().c_str());
  return *track;
}

inline std::string
ahap(const std::string &pattern)
{
  return "{\"Version\":1.0,\"Pattern\":[" + pattern + "]}";
}

inline std::string
continuous(const char *times, const char *parameters = "")
{
  return std::string(R"({"Event":{"EventType":"HapticContinuous",)") + times
         + ",\"EventParameters\":[" + parameters + "]}}";
}

} // namespace

#define ASSERT_HZ(track, time, expected)                                                           \
  fail_unless(std::abs(static_cast<double>((track).at(time).frequency) - (expected)) < 0.01,       \
              "%s: %g Hz, expected %g", #time, static_cast<double>((track).at(time).frequency),    \
              double{ expected })
