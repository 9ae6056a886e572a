// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/profile.h"
#include "pipeline.h"

#include "nanoseconds.h"
#include "tactile/tactile_map.h"
#include "tactor/felt_blocks.h"
#include "tracks/track.h"

#include <gst/gst.h>

#include <optional>
#include <string>
#include <tl/expected.hpp>

/// How a film becomes a track.
struct AnalysisSettings
{
  double rate = 5; ///< Hz at which levels may change; 0: with every frame
  int rows = 3;
  int columns = 3;
  std::string profile = "tuned";
  const fusion::Profile *sound = nullptr; ///< of the film's sound; null: none is felt
  int parts = 1;                          ///< that are analyzed by themselves
};

/// Profiles of the analysis.
inline constexpr std::string_view kProfiles[] = { "tuned", "paper" };

/// All that a track depends on but its film, in words: "grid=3x3 rate=5 profile=tuned sound=off
/// version=0.1.0-2".
std::string made_with(const AnalysisSettings &settings);

/// A pipeline of a launch line that begins with film_source(), from which the appsink `maps` takes
/// the maps of the picture and of `sound`. `more`: continues the line; `split.src` has the frames.
/// Throws std::runtime_error.
Pipeline make_analysis(const std::string &source, const AnalysisSettings &settings,
                       const std::string &more = "");

/// A map that holds from `begin` to `end`, in film time.
struct FilmMap
{
  visuotactile::Time begin{ 0 };
  visuotactile::Time end{ 0 };
  tactile::TactileMap map;
  bool at_once = false; ///< of the sound, see BlockSampler
};

/// The map of a sample; `start`: the stream time of the film's 0:00. None if the sample is no map
/// in the film.
std::optional<FilmMap> film_map(GstSample *sample, visuotactile::Time start);

/// Selects the felt maps of a stream: blocks, as tactorsink takes them. Maps of the sound are taken
/// at once.
class BlockSampler
{
public:
  explicit BlockSampler(double rate) : rate_(rate)
  {
  }

  /// Whether this map, in order of time, begins a block. It then has the block's levels.
  bool takes(FilmMap &map);

private:
  double rate_;
  tactor::FeltBlocks blocks_;
};

/// Makes a track of a stream of maps.
class TrackRecorder
{
public:
  explicit TrackRecorder(const AnalysisSettings &settings);

  /// An error where the track is full.
  tl::expected<void, tactile::FormatError> add(FilmMap map);
  tl::expected<tactile::Track, tactile::FormatError> finish();

private:
  tactile::Track track_;
  BlockSampler sampler_;
  visuotactile::Time end_{ 0 };
};
