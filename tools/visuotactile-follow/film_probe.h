// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/pipeline.h"
#include "film/start_watch.h"
#include "nanoseconds.h"

#include <gst/pbutils/pbutils.h>

#include <optional>
#include <string>

/// Probes a film's file without waiting for it. Main context's thread.
class FilmProbe
{
public:
  struct Result
  {
    std::optional<visuotactile::Time> duration{};
    StartTimes start{}; ///< the film's 0:00
    bool has_picture = false;
    bool has_sound = false;
    bool may_have_track = false; ///< subtitles that are not named otherwise, or KLV
    std::string complaint{};     ///< why it cannot be decoded, if so
  };

  /// Throws std::runtime_error.
  explicit FilmProbe(const std::string &uri);
  ~FilmProbe();
  FilmProbe(const FilmProbe &) = delete;
  FilmProbe &operator=(const FilmProbe &) = delete;

  /// None during the probe, which takes ten seconds at most.
  const std::optional<Result> &result() const
  {
    return result_;
  }

private:
  static void on_discovered(GstDiscoverer *discoverer, GstDiscovererInfo *info, GError *error,
                            gpointer self);

  Owned<GstDiscoverer> discoverer_;
  std::optional<StartWatch> start_;
  std::optional<Result> result_;
};
