// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <string>

/// What is to be played, as far as it is known before it plays.
struct Film
{
  std::string uri;   ///< empty: the built-in synthetic film
  std::string title; ///< for the report
  int width = 0;
  int height = 0;
  double fps = 0;                              ///< 0: unknown or variable
  bool has_sound = false;                      ///< which need not mean that it can be decoded
  GstClockTime duration = GST_CLOCK_TIME_NONE; ///< as the file says
};

/// The built-in film: the paper's static-motion film, then its dynamic-motion film.
Film synthetic_film();

/// Looks into a film, given as a path or URI. Throws std::runtime_error with one line that says
/// what is wrong with it and what to do: no such file, not readable, not decodable, no picture.
Film discover_film(const std::string &path_or_uri);

/// The launch line's beginning for a film: what ends in an element whose source pads are raw video
/// and sound, named `film`.
std::string film_source(const Film &film);
