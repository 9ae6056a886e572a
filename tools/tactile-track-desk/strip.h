// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/pipeline.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

/// What a time line shows of a film: small pictures, peaks of its sound, shot cuts. The film is
/// gone through once, in the background, while this grows. Any thread.
class Strip
{
public:
  static constexpr std::size_t kMostPictures = 1000;
  static constexpr gint64 kPeak = 10; ///< ms

  explicit Strip(const Film &film);
  ~Strip();
  Strip(const Strip &) = delete;
  Strip &operator=(const Strip &) = delete;

  /// 0 to 1; < 0: it failed.
  double progress() const;

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
  std::size_t count() const; ///< of pictures that are there
  std::size_t total() const; ///< that there will be, if the film says how long it is
  std::string picture(std::size_t index) const; ///< JPEG; empty: not there
  std::string peaks(std::size_t from) const;    ///< a byte each
  struct Cuts
  {
    std::vector<gint64> times; ///< ms
    gint64 until = 0;          ///< ms
  };
  Cuts cuts() const;

private:
  class Eye; ///< sees cuts

  void on_frame(GstSample *sample);
  void on_sound(GstSample *sample);
  gboolean on_message(GstMessage *message);

  int width_;
  int height_;
  gint64 interval_;
  gint64 duration_;          ///< ms; 0: unknown
  visuotactile::Time start_; ///< stream time of the film's 0:00
  std::unique_ptr<Eye> eye_;
  mutable std::mutex mutex_;
  std::vector<std::string> pictures_;
  std::string peaks_;
  Cuts cuts_;
  double progress_ = 0;
  guint watch_ = 0;
  Pipeline pipeline_;
};
