// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliencystatistics.h"

#include <algorithm>

void
SaliencyStatistics::count(std::span<const float> felt, std::optional<GstClockTime> spent)
{
  frames++;
  analyzed += spent ? 1 : 0;
  active += std::ranges::any_of(felt, [](float level) { return level > 0; }) ? 1 : 0;
  busy += spent.value_or(0);
  longest = std::max(longest, spent.value_or(0));
}

GstStructure *
SaliencyStatistics::to_structure() const
{
  const people::DetectionThread::Statistics &looks = people.looks;
  return gst_structure_new(
      "application/x-saliency-stats", "frames", G_TYPE_UINT64, frames, "analyzed", G_TYPE_UINT64,
      analyzed, "unchanged", G_TYPE_UINT64, unchanged, "active", G_TYPE_UINT64, active,
      "analysis-mean", G_TYPE_UINT64, analyzed ? busy / analyzed : 0, "analysis-max", G_TYPE_UINT64,
      longest, "faces", G_TYPE_UINT64, static_cast<guint64>(people.faces), "looks", G_TYPE_UINT64,
      static_cast<guint64>(looks.detections), "look-mean", G_TYPE_UINT64,
      static_cast<guint64>(looks.detections ? looks.busy.count() / looks.detections : 0), "path",
      G_TYPE_STRING, name_of(path), "bytes-read", G_TYPE_UINT64, bytes, nullptr);
}
