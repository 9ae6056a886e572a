// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// The synthetic films of the paper's user study (Section 5, Fig. 6), with ground truth for every
/// ball.
namespace tactile {

enum class FilmPattern
{
  static_motion,  ///< one or two balls appear, rest for more than a second and jump elsewhere
  dynamic_motion, ///< a ball moves around at various speeds and stalls suddenly
};

/// Gamma-encoded R'G'B' (sRGB).
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

/// One ball in one picture, in pixels; (0, 0) is the top left corner of the top left pixel.
struct Ball
{
  int index = 0; ///< 0 or 1
  double x = 0;  ///< center
  double y = 0;  ///< center
  double radius = 0;
  Color color{};
  Time onset{ 0 };     ///< when it last appeared or started to move
  bool moving = false; ///< now in motion

  bool operator==(const Ball &) const = default;
};

/// The positions of the balls over time. The film is a pure function of settings, time and picture
/// size, so it shows the same motion at any frame rate and after a seek. It begins with kEmptyStart
/// of empty background, so that the first ball is an event like all others. It repeats after
/// kPeriod.
///
/// Static motion: rests of 1.2–3 s, one in four of 3.2–5 s. Balls that appear together have the
/// same color and are in different thirds of the width. None appears in the ninth of the picture
/// where one has just been. Dynamic motion: moves of 1.5–4 s and stalls of 0.5–2 s, one stall in
/// three of 2.7–4 s. A moving ball never rests.
class SyntheticFilm
{
public:
  static constexpr Time kPeriod = std::chrono::minutes(10);
  static constexpr Time kEmptyStart = std::chrono::seconds(1);
  static constexpr Color kBackground{ 119, 119, 119 }; ///< L* = 50

  /// Settings out of range are clamped.
  explicit SyntheticFilm(const FilmSettings &settings);

  /// The balls at `time` (before 0: as at 0) in a picture of width × height pixels, at least 1 × 1.
  /// Balls lie entirely inside the picture if they fit.
  std::vector<Ball> balls_at(Time time, int width, int height) const;

private:
  /// A ball's motion from `begin` until the next stretch: it rests at (u, v) or moves around the
  /// center. Positions are in [0, 1], relative to the part of the picture that the center of a
  /// whole ball can reach.
  struct Stretch
  {
    Time begin{ 0 };
    Time onset{ 0 };
    bool visible = false;
    bool moving = false;
    Color color{};
    double u = 0.5;
    double v = 0.5;
    double angle = 0;       ///< moving: around the center, radians, at `begin`
    double reach = 0;       ///< moving: phase of the distance from the center, radians, at `begin`
    double direction = 1;   ///< moving: direction of rotation, ±1
    double speed = 0;       ///< moving: mean speed, radians per second
    double speed_phase = 0; ///< moving: phase of the speed's modulation, radians, at `begin`
  };
  using Track = std::vector<Stretch>;

  static Stretch advance(const Stretch &from, Time time);
  void make_static_tracks();
  Track make_dynamic_track(int index) const;

  FilmSettings settings_;
  std::vector<Track> tracks_; ///< one per ball
};

/// One 8-bit component of a picture in memory: sample (x, y) is at
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

/// Draws a ball's value into one component, with an anti-aliased edge. In a plane without
/// subsampling, pixels outside [⌊x − radius⌋, ⌈x + radius⌉) × [⌊y − radius⌋, ⌈y + radius⌉) are
/// unchanged.
void draw_ball(const SamplePlane &plane, const Ball &ball, std::uint8_t value);

/// Sensor noise: normally distributed, rounded to whole codes, independent per sample and frame. It
/// depends only on the seed, the frame's time and the sample's position.
class SensorNoise
{
public:
  /// Standard deviation in 8-bit codes, [0, 32].
  SensorNoise(double sigma, std::uint64_t seed);

  /// Adds noise to every sample of one component and clamps to 0…255. `component`: index of the
  /// component within its frame.
  void add(const SamplePlane &plane, int component, Time time) const;

private:
  static constexpr std::size_t kQuantiles = 4096; ///< up to ± 3.7 σ

  std::uint64_t seed_;
  std::array<std::int16_t, kQuantiles> quantiles_{}; ///< in whole codes
};

} // namespace tactile
