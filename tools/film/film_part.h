// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "analysis.h"
#include "film.h"
#include "pipeline.h"
#include "tracks/track.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>

/// A part of a film, in film time.
struct Span
{
  visuotactile::Time begin{ 0 };
  visuotactile::Time end{ 0 }; ///< 0: the film's end
};

/// Analyzes a part of a film. Its analysis begins a minute before it, with what the earlier part
/// has: levels adapt to the film's last minutes.
class FilmPart
{
public:
  struct Events
  {
    /// Called by the streaming thread with each map that begins in the part. An error ends it.
    std::function<tl::expected<void, tactile::FormatError>(FilmMap)> analyzed;
    /// Called from the main loop at the end, with the error or an empty text.
    std::function<void(const std::string &)> finished;
  };

  /// `more`: as of make_analysis(). Throws std::runtime_error.
  FilmPart(const Film &film, const AnalysisSettings &settings, Span span, Events events,
           const std::string &more = "");
  ~FilmPart();
  FilmPart(const FilmPart &) = delete;
  FilmPart &operator=(const FilmPart &) = delete;

  const Pipeline &pipeline() const
  {
    return pipeline_;
  }
  /// Throws std::runtime_error.
  void start();
  void stop();

  /// What was analyzed of the part.
  visuotactile::Time done() const
  {
    return std::max(visuotactile::Time(position_.load()) - span_.begin, visuotactile::Time(0));
  }

private:
  GstFlowReturn on_map(GstAppSink *maps);
  gboolean look_for_stall();
  gboolean on_message(GstMessage *message);
  bool seek();

  const Span span_;
  const visuotactile::Time start_; ///< stream time of the film's 0:00
  const Events events_;
  bool has_sought_;
  std::atomic<visuotactile::Time::rep> position_{ 0 };
  std::atomic<std::size_t> frames_{ 0 };
  std::size_t seen_ = 0; ///< frames at the last look_for_stall()
  gint64 reached_ = 0;   ///< position of the pipeline then
  int empty_looks_ = 0;
  guint stall_ = 0;
  // Used by the streaming thread, and by others after it has ended.
  std::optional<visuotactile::Time> first_;
  bool advances_ = false;
  guint watch_ = 0;
  Pipeline pipeline_;
};
