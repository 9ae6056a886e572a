// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/film_cache.h"
#include "film/pipeline.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// Pictures of a film for its time line: small frames, peaks and impacts of its sound, shot cuts.
/// They grow while the film is read, and are kept for the next time. Any thread.
class Strip
{
public:
  static constexpr std::size_t kMostPictures = 1000;
  static constexpr gint64 kPeak = 10; ///< ms

  /// Has what is kept. `path`: the film's file.
  Strip(const Film &film, const std::string &path);
  ~Strip();
  Strip(const Strip &) = delete;
  Strip &operator=(const Strip &) = delete;

  /// 0 to 1; < 0: it failed.
  double progress() const;
  bool is_whole() const
  {
    return progress() == 1;
  }

  /// ms between the key frames that come first; 0: none, it is whole, or soon.
  gint64 glances() const;
  /// The picture of the last key frame before a moment.
  void glimpse(gint64 ms, std::string jpeg);
  void glanced();

  /// Continues the line of make_analysis().
  std::string line(const Film &film) const;
  /// Before the pipeline with the line starts.
  void listen(const Pipeline &pipeline);
  /// After all of the film, or with what failed.
  void end(const std::string &failure);

  int width() const
  {
    return width_;
  }
  int height() const
  {
    return height_;
  }
  gint64 interval() const ///< ms between pictures
  {
    return interval_;
  }
  std::size_t count() const; ///< pictures so far
  std::size_t shown() const; ///< pictures with those of key frames nearby
  std::size_t total() const; ///< pictures in the end, if the film's length is known
  std::string picture(std::size_t index) const; ///< JPEG; empty: none yet
  std::string peaks(std::size_t from) const;    ///< a byte each
  struct Events
  {
    std::vector<gint64> cuts;    ///< between shots, ms
    gint64 until = 0;            ///< cuts are known up to here, ms
    std::vector<gint64> impacts; ///< that are heard, ms
  };
  Events events() const;

private:
  class Eye; ///< sees cuts
  class Ear; ///< hears impacts

  bool load();
  void keep() const;
  void on_frame(GstSample *sample);
  void on_sound(GstSample *sample);

  const std::string path_;
  const FilmCache cache_;
  const std::optional<library::FileVersion> version_; ///< of the film
  int width_;
  int height_;
  gint64 interval_;
  gint64 duration_;          ///< ms; 0: unknown
  visuotactile::Time start_; ///< stream time of the film's 0:00
  std::unique_ptr<Eye> eye_;
  std::unique_ptr<Ear> ear_;
  mutable std::mutex mutex_;
  std::vector<std::string> pictures_;
  std::map<std::size_t, std::string> glances_; ///< by index
  bool has_glanced_ = false;
  std::string peaks_;
  Events events_;
  double progress_ = 0;
};
