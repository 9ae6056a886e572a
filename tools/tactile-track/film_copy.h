// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_contents.h"

#include "tracks/cue_builder.h"

#include <deque>
#include <functional>
#include <string>
#include <vector>

enum class Container
{
  matroska,
  mp4,
  transport_stream,
};

/// A film, and a track that is added to a copy of it.
struct FilmAndTrack
{
  std::string path;
  const FilmContents &film;
  std::vector<int> taken_out{}; ///< streams that are not copied as such: older tracks, chapters
  std::deque<tactile::Cue> cues{};
  std::string subtitles{}; ///< the name of a SubRip file with these cues
  bool first = false;      ///< the track comes before the film's subtitles
};

/// The streams that are tracks: subtitles, or KLV of ours. Reads a transport stream that has KLV.
std::vector<int> older_tracks(const std::string &path, const FilmContents &film);

/// The share of a step that is done, from 0 to 1.
using OnProgress = std::function<void(double)>;

// Each writes a file, by what the world uses for it. `at` is the time in the file, in seconds, at
// which the track begins. They throw std::runtime_error if that fails, and Stopped.

/// Copies by mkvmerge, which preserves all that Matroska can hold, and adds missing times to
/// pictures.
void copy_by_mkvmerge(const FilmAndTrack &what, double at, const std::string &to,
                      const OnProgress &on_progress);

/// Copies by ffmpeg. Streams that the container cannot hold, which the error names otherwise, are
/// `left_out`. A transport stream gets no track.
void copy_by_ffmpeg(const FilmAndTrack &what, Container container, const std::vector<int> &left_out,
                    double at, const std::string &to, const OnProgress &on_progress);

/// The streams of a film that ffmpeg refuses to write into a container.
std::vector<int> streams_not_for(Container container, const FilmAndTrack &what,
                                 const std::string &scratch);

/// Adds the track to a transport stream, whose packets stay as they are.
void copy_transport_stream(const FilmAndTrack &what, const std::string &from, double at,
                           const std::string &to, const OnProgress &on_progress);
