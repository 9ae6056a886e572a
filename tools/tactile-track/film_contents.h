// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

/// What names have to be kept: such as "title", "rotation" or "forced".
using Facts = std::map<std::string, std::string>;

/// A stream of a film's file, as ffprobe reports it.
struct FilmStream
{
  static constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

  struct Packet
  {
    double time = kNever; ///< of presentation, in seconds
    long size = 0;        ///< in bytes
  };

  /// The names of MP4's chapters, which are chapters of the film besides.
  static constexpr const char *kChapters = "chapters";

  std::string kind; ///< video, audio, subtitle, data, attachment or kChapters
  std::string codec;
  int id = -1; ///< of its container, such as a transport stream's PID
  Facts facts{};
  std::vector<Packet> packets{}; ///< in the file's order

  bool is_picture() const; ///< a moving one: no cover
  bool is_text() const;    ///< subtitles of text
  /// Subtitles of language zxx that are called Tactile, as mux and its predecessors write a track.
  bool is_tactile() const;
};

struct Chapter
{
  double start = 0;
  std::string title;
};

/// The contents of a film's file.
struct FilmContents
{
  std::string container; ///< as FFmpeg calls it, such as "matroska,webm"
  double start = 0;      ///< its beginning, as FFmpeg says
  double duration = 0;   ///< 0: unknown
  Facts facts{};
  std::vector<Chapter> chapters{};
  std::vector<FilmStream> streams{};

  /// Packets of pictures or sound lack times of presentation.
  bool lacks_times() const;
  bool is_in(const char *format) const;
  /// The earliest time of a picture or sound, where the film begins.
  double earliest() const;
  /// The time of the film's 0:00 (docs/design/time.md).
  double zero() const
  {
    return is_in("mp4") ? 0 : earliest();
  }
};

/// Reads a whole file by ffprobe. `on_progress`: the share that is read, from 0 to 1. Throws
/// std::runtime_error, and Stopped.
FilmContents read_contents(const std::string &path, const std::function<void(double)> &on_progress);

/// How a copy of a film differs from it.
struct Differences
{
  double shift = 0;                  ///< of the copy's times, in seconds
  std::vector<std::string> broken{}; ///< differences of packets or times of a stream: it is no copy
  std::vector<std::string> lost{};   ///< missing parts
  std::vector<int> left_out{};       ///< streams of the film, by their index
};

/// Compares a film without the streams `taken_out` with a copy, of which the stream `track` was
/// added.
Differences compare(const FilmContents &film, const std::vector<int> &taken_out,
                    const FilmContents &copy, int track);
