// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Prints how much of real films is felt, as a Markdown table.
// Usage: clip_scores DIRECTORY (of films)
#include "clips.h"

#include <gst/gst.h>

#include <opencv2/core/utility.hpp>

#include <cstdio>
#include <exception>

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  cv::setNumThreads(1);
  if (argc != 2) {
    std::fprintf(stderr, "usage: clip_scores DIRECTORY\n");
    return 2;
  }
  try {
    const auto rows = quality::score_clips(argv[1]);
    std::printf(
        "| film | profile | frames | active | tactors | tactors if active | longest, s | of one "
        "tactor, s | cues/min | camera moves | cuts |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const auto &[clip, profile, s] : rows)
      std::printf(
          "| %s | %s | %d | %.1f %% | %.1f %% | %.2f | %.1f | %.1f | %.0f | %.1f %% | %d |\n",
          clip.c_str(), profile.c_str(), s.frames, 100 * s.active, 100 * s.tactors,
          s.tactors_active, s.longest, s.longest_tactor, s.cues_per_minute, 100 * s.camera_moves,
          s.cuts);
  } catch (const std::exception &error) {
    std::fprintf(stderr, "clip_scores: %s\n", error.what());
    return 1;
  }
  return 0;
}
