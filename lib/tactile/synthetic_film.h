// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/time.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// The synthetic films of the paper's user study (Section 5, Fig. 6), with the truth about every
/// ball.
namespace tactile {

/// Which of the two films.
enum class FilmPattern
{
  static_motion,  ///< one or two balls appear, rest for more than a second, then are elsewhere at
                  ///< once
  dynamic_motion, ///< a ball moves around at various speeds and stalls suddenly
};

/// Gamma-encoded R'G'B', as on an sRGB screen.
struct Color
{
  std::uint8_t red;
  std::uint8_t green;
  std::uint8_t blue;

  bool operator==(const Color &) const = default;
};

struct FilmSettings
{
  FilmPattern pattern = FilmPattern::static_motion;
  std::uint64_t seed = 0;
  int balls = 0;                 ///< 1 or 2 at a time; 0: as in the paper
  double ball_size = 1.0 / 16.0; ///< diameter as a share of the picture's width

  bool operator==(const FilmSettings &) const = default;
};

/// One ball in one picture, in pixels; the top left corner of the top left pixel is (0, 0).
struct Ball
{
  int index = 0; ///< 0 or 1
  double x = 0;  ///< center
  double y = 0;  ///< center
  double radius = 0;
  Color color{};
  Time onset{ 0 };     ///< when it last appeared or started to move
  bool moving = false; ///< it is on its way

  bool operator==(const Ball &) const = default;
};

/// Where the balls are at any time. The film is a pure function of settings, time and picture size:
/// another frame rate or a seek shows the same motion. It begins with kEmptyStart of empty
/// background, so that its first ball is an event like all others, and repeats after kPeriod.
///
/// Static motion: rests of 1.2–3 s, one in four of 3.2–5 s. Balls that appear together have one
/// color and are in different thirds of the width; none appears in that ninth of the picture where
/// one has just been. Dynamic motion: moves of 1.5–4 s and stalls of 0.5–2 s, one stall in three
/// of 2.7–4 s. A moving ball never rests.
class SyntheticFilm
{
public:
  static constexpr Time kPeriod = std::chrono::minutes(10);
  static constexpr Time kEmptyStart = std::chrono::seconds(1);
  static constexpr Color kBackground{ 119, 119, 119 }; ///< L* = 50

  /// Settings out of range are taken as the nearest in range.
  explicit SyntheticFilm(const FilmSettings &settings);

  /// The balls at `time` (before 0: as at 0) in a picture of width × height pixels, at least 1 × 1.
  /// Whole balls lie inside the picture as far as they fit.
  std::vector<Ball> balls_at(Time time, int width, int height) const;

private:
  /// What one ball does from `begin` until the next stretch: rests at (u, v), or moves around the
  /// middle. Positions are in [0, 1], relative to the part of the picture that a whole ball's
  /// center can be in.
  struct Stretch
  {
    Time begin{ 0 };
    Time onset{ 0 };
    bool visible = false;
    bool moving = false;
    Color color{};
    double u = 0.5;
    double v = 0.5;
    double angle = 0;       ///< moving: around the middle, radians, at `begin`
    double reach = 0;       ///< moving: phase of the distance from the middle, radians, at `begin`
    double direction = 1;   ///< moving: sense of rotation, ±1
    double speed = 0;       ///< moving: mean, radians per second
    double speed_phase = 0; ///< moving: phase of the speed's swell, radians, at `begin`
  };
  using Track = std::vector<Stretch>;

  static Stretch advance(const Stretch &from, Time time);
  void make_static_tracks();
  Track make_dynamic_track(int index) const;

  FilmSettings settings_;
  std::vector<Track> tracks_; ///< one for each ball
};

/// One component of a picture where it lies in memory, 8 bits: sample (x, y) is at
/// `data + y * row_stride + x * pixel_stride` (bytes) and covers `block_width × block_height`
/// pixels.
struct SamplePlane
{
  std::uint8_t *data = nullptr;
  std::ptrdiff_t row_stride = 0;
  int pixel_stride = 1;
  int width = 0;  ///< samples
  int height = 0; ///< samples
  int block_width = 1;
  int block_height = 1;
};

/// Draws a ball's component value over what is there, the edge anti-aliased. Pixels outside
/// [⌊x − radius⌋, ⌈x + radius⌉) × [⌊y − radius⌋, ⌈y + radius⌉) stay as they are where samples are
/// pixels.
void draw_ball(const SamplePlane &plane, const Ball &ball, std::uint8_t value);

/// Sensor noise: normally distributed, rounded to whole codes, independent from sample to sample
/// and frame to frame, and a function of nothing but its seed, the frame's time and the sample's
/// position.
class SensorNoise
{
public:
  /// Standard deviation in 8-bit codes, [0, 32].
  SensorNoise(double sigma, std::uint64_t seed);

  /// Adds noise to every sample of one component (`component` tells those of one frame apart),
  /// clamped to 0…255.
  void add(const SamplePlane &plane, int component, Time time) const;

private:
  static constexpr std::size_t kQuantiles = 4096; ///< to ± 3.7 σ

  std::uint64_t seed_;
  std::array<std::int16_t, kQuantiles> quantiles_{}; ///< of the distribution, in whole codes
};

} // namespace tactile
