// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/sound_analyzer.h"

#include <glib.h>

#include <optional>
#include <span>
#include <vector>

/// The impacts in a film's sound, as soundtactile detects them. Not thread-safe.
class Impacts
{
public:
  /// Takes interleaved samples that begin at a film time in ms. Returns the film times of impacts
  /// that are known now, ms. Sound of a rate or of channels that cannot be analyzed has none.
  std::vector<gint64> add(gint64 time, std::span<const gint16> samples, int rate, int channels);

private:
  std::optional<sound::SoundAnalyzer> analyzer_;
  int rate_ = 0;
  int channels_ = 0;
  gint64 begin_ = 0;  ///< film time of the analyzer's first frame, ms
  gint64 frames_ = 0; ///< that it has got
};
