// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/sound_analyzer.h"
#include "tactile/tactile_map.h"

#include <gst/audio/audio.h>

#include <functional>
#include <optional>
#include <vector>

/// Audio buffers → tactile maps. Used by one thread at a time.
class SoundReader
{
public:
  /// The settings of the maps.
  struct Settings
  {
    sound::FeelSettings feel;
    guint maps_per_second = 100;
  };

  /// A map of [begin, end), in the buffers' time.
  using MapSink
      = std::function<void(const tactile::TactileMap &map, GstClockTime begin, GstClockTime end)>;

  /// Reads this format from now on; false if it cannot.
  bool set_format(const GstAudioInfo &info, int rows, int columns);

  /// Maps have this grid from now on. After drain().
  void set_grid(int rows, int columns);

  /// From now on, knows impacts 80 ms later and better, or not. After drain().
  void look_ahead(bool looks_ahead);

  bool looks_ahead() const
  {
    return looks_ahead_;
  }

  /// Time between the end of a map and the sound that has to be in before it is known, plus the
  /// length of a map; 0 without a format.
  GstClockTime latency(guint maps_per_second) const;

  /// Reads a buffer with a time stamp. A buffer that does not follow on the last one begins anew.
  void read(GstBuffer *buffer, const Settings &settings, const MapSink &sink);

  /// Analyzes the rest of the sound.
  void drain(const Settings &settings, const MapSink &sink);

  /// Drops the sound so far, for a seek.
  void reset();

private:
  void clear();
  void convert(const GstAudioBuffer &audio, gsize first, gsize count);
  void feel(std::span<const sound::Moment> moments, const Settings &settings, const MapSink &sink);
  GstClockTime slot(gint64 number, guint maps_per_second) const;

  void make_analyzer();

  GstAudioInfo info_{};
  bool looks_ahead_ = false;
  std::optional<sound::SoundAnalyzer> analyzer_;
  std::vector<guint8> unpacked_; ///< a block of one channel or of all
  std::vector<float> frames_;    ///< a block, interleaved
  tactile::TactileMap map_;      ///< of the current slot
  float strongest_ = 0;          ///< level of its moments
  GstClockTime base_ = GST_CLOCK_TIME_NONE;
  guint64 count_ = 0; ///< frames since base_
  gint64 number_ = 0; ///< slots since base_
};
