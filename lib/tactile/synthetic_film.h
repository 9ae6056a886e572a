// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace tactile {

using Time = std::chrono::nanoseconds;

/// A colour as R'G'B' in [0, 1].
struct Rgb
{
  float r = 0;
  float g = 0;
  float b = 0;

  bool operator==(const Rgb &) const = default;
};

/// The two synthetic films of the paper (Section 5, Fig. 6).
enum class FilmPattern
{
  static_motion,  ///< one or two balls appear, rest, and appear elsewhere
  dynamic_motion, ///< a ball moves about at varying speed and stalls suddenly
};

/// A ball at one moment: x = 0 is the left edge of the picture, 1 the right one; y = 0 the top, 1
/// the bottom.
struct Ball
{
  double x = 0; ///< centre, share of the picture's width
  double y = 0; ///< centre, share of the picture's height
  double radius
      = 0; ///< share of the picture's *width* in both directions: a ball is round in pixels
  Rgb colour;
  Time onset{ 0 };     ///< when it last appeared or started to move
  bool moving = false; ///< it is on its way
};

/// A film as a pure function of its settings and the time: any moment at once, in any order, the
/// same on every run.
///
/// Static motion: rests of 1.2–3 s, and in every 16 s one of 4–6 s. At the end of a rest all balls
/// disappear and as many as the next rest has appear at the same moment, each at least a sixth of
/// the picture from where any was (for balls up to 1/8 of the width). Balls that appear together
/// have one colour and their centres in different thirds of the width; up to a ball size of a third
/// they don't overlap.
///
/// Dynamic motion: one ball on a smooth path. In every 20 s four moves of 1.5–5.5 s, each with a
/// sudden stop: three stalls of 0.5–1.5 s and one of 3–4 s.
///
/// From time 0 on there is always a ball, and balls are wholly in the picture where it is large
/// enough for them.
class SyntheticFilm
{
public:
  /// `balls`: 1 or 2 in each rest, anything else: one or two at random (as in the paper); dynamic
  /// motion has always one. `ball_size`: diameter as share of the picture's width, (0, 0.5].
  /// `aspect`: width / height of the picture in pixels, > 0.
  SyntheticFilm(FilmPattern pattern, std::uint64_t seed, int balls = 0, double ball_size = 1.0 / 16,
                double aspect = 1);

  /// The balls to be seen at `time`; a negative time is taken as 0.
  std::vector<Ball> balls_at(Time time) const;

private:
  struct Place
  {
    double x;
    double y;
  };

  std::vector<Ball> resting_balls(Time time) const;
  Ball moving_ball(Time time) const;
  std::vector<Place> places(std::int64_t rest) const;

  FilmPattern pattern_;
  std::uint64_t seed_;
  int balls_;
  double radius_;   ///< share of the width
  double radius_y_; ///< the same length as share of the height
};

/// Where a ball lies in pixels; pixel i covers [i, i + 1).
struct Disc
{
  double x;
  double y;
  double radius;
};

/// The ball on a picture of `width` × `height` pixels, at least one pixel across.
Disc disc_in_pixels(const Ball &ball, int width, int height);

/// Pixels [left, left + row.size()) of row `y` of the picture: a plain grey background with a
/// gentle gradient, and the balls with an anti-aliased edge one pixel wide. A ball touches only
/// pixels of its bounding box [floor(x - radius), ceil(x + radius)) × [floor(y - radius), ceil(y +
/// radius)).
void paint_row(std::span<const Ball> balls, int width, int height, int y, int left,
               std::span<Rgb> row);

/// Adds normally distributed noise of standard deviation `sigma` (in codes, [0, 32]) to `count`
/// 8-bit samples that are `step` bytes apart, clipped to [0, 255]. The noise is a function of
/// (seed, time, component, row, index of the sample).
void add_noise(std::uint8_t *samples, int count, int step, double sigma, std::uint64_t seed,
               Time time, int component, int row);

} // namespace tactile
