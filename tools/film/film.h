// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "start_watch.h"

#include <gst/gst.h>

#include <string>

/// A film that can be opened, as far as it is known before it is played.
struct Film
{
  std::string uri;   ///< empty: the built-in synthetic film
  std::string title; ///< for the report
  int width = 0;
  int height = 0;
  double pixel_aspect = 1;                     ///< width of a pixel in its heights
  double fps = 0;                              ///< 0: unknown or variable
  bool has_sound = false;                      ///< even if no decoder for it is installed
  GstClockTime duration = GST_CLOCK_TIME_NONE; ///< by the file's header
  StartTimes start{};                          ///< its 0:00
  std::string type; ///< as browsers' canPlayType() takes it; empty: unknown
};

/// The built-in film: the paper's static-motion film, then its dynamic-motion film.
Film synthetic_film();

/// Opens a film, given as a path or URI. Throws std::runtime_error, in one line with the fault and
/// what to do: no such file, not readable, not decodable, no picture.
Film discover_film(const std::string &path_or_uri);

/// The beginning of a launch line, up to an element named `film` whose source pads have raw video
/// and audio.
std::string film_source(const Film &film);
