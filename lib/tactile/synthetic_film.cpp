// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/synthetic_film.h"

#include "random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactile {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kTurn = 2 * std::numbers::pi;

/// Saturated colors at a similar distance from the gray background.
constexpr std::array<Color, 6> kColors{ {
    { 214, 40, 40 },
    { 235, 140, 20 },
    { 240, 225, 50 },
    { 30, 170, 60 },
    { 40, 80, 220 },
    { 190, 45, 190 },
} };

using visuotactile::mix_bits;

constexpr int kThirds = 3;
constexpr double kThirdMargin = 0.15; ///< share of a third kept clear at its borders

class Random : public visuotactile::Random
{
public:
  using visuotactile::Random::Random;

  Color color()
  {
    return kColors[static_cast<std::size_t>(below(static_cast<int>(kColors.size())))];
  }

  double in_third(int third)
  {
    return uniform(third + kThirdMargin, third + 1 - kThirdMargin) / kThirds;
  }

  /// A uniformly distributed time in [low, high) seconds.
  Time time(double low, double high)
  {
    return std::chrono::round<Time>(Seconds(uniform(low, high)));
  }
};

} // namespace

SyntheticFilm::SyntheticFilm(const FilmSettings &settings) : settings_(settings)
{
  settings_.balls = std::clamp(settings_.balls, 0, 2);
  settings_.ball_size = std::clamp(settings_.ball_size, 0.0, 1.0);

  if (settings_.pattern == FilmPattern::static_motion)
    make_static_tracks();
  else
    for (int i = 0; i < std::max(settings_.balls, 1); i++)
      tracks_.push_back(make_dynamic_track(i));
}

void
SyntheticFilm::make_static_tracks()
{
  Random random(settings_.seed);
  tracks_.assign(2, Track(1));

  std::array<int, 2> last{ -1, -1 }; // ninths of the picture, row-major
  for (Time begin = kEmptyStart; begin < kPeriod;) {
    const int balls = settings_.balls > 0 ? settings_.balls : 1 + random.below(2);
    const Color color = random.color();

    std::array<int, 2> ninth{ -1, -1 };
    for (int i = 0; i < 2; i++) {
      Stretch stretch{ .begin = begin, .onset = begin, .color = color };
      if (i < balls) {
        int here = 0;
        do
          here = random.below(kThirds * kThirds);
        while (here == last[0] || here == last[1]
               || (i == 1 && here % kThirds == ninth[0] % kThirds));
        ninth[static_cast<std::size_t>(i)] = here;
        stretch.visible = true;
        stretch.u = random.in_third(here % kThirds);
        stretch.v = random.in_third(here / kThirds);
      }
      tracks_[static_cast<std::size_t>(i)].push_back(stretch);
    }
    last = ninth;

    // Longer than a second (paper); some long enough for a temporal window of two seconds to
    // settle.
    begin += random.below(4) == 0 ? random.time(3.2, 5.0) : random.time(1.2, 3.0);
  }
}

SyntheticFilm::Track
SyntheticFilm::make_dynamic_track(int index) const
{
  Random random(settings_.seed + (static_cast<std::uint64_t>(index + 1) << 32U));
  Track track(1);

  Stretch stretch{ .begin = kEmptyStart, .visible = true };
  stretch.color = random.color();
  stretch.angle = random.uniform(0, kTurn);
  stretch.reach = random.uniform(0, kTurn);
  while (stretch.begin < kPeriod) {
    stretch.onset = stretch.begin;
    stretch.moving = true;
    stretch.direction = random.below(2) == 0 ? 1 : -1;
    stretch.speed = random.uniform(0.6, 2.0);
    stretch.speed_phase = random.uniform(0, kTurn);
    track.push_back(stretch);

    stretch = advance(stretch, stretch.begin + random.time(1.5, 4.0));
    stretch.moving = false;
    track.push_back(stretch);

    stretch.begin += random.below(3) == 0 ? random.time(2.7, 4.0) : random.time(0.5, 2.0);
  }
  return track;
}

/// The state of a stretch at `time`. The angular speed varies by half around its mean, and the
/// distance from the center, never zero, more slowly: a moving ball never rests.
SyntheticFilm::Stretch
SyntheticFilm::advance(const Stretch &from, Time time)
{
  constexpr double kSwell = 0.5;
  constexpr double kSwellRate = kTurn * 0.4; // radians per second
  constexpr double kReachRate = 0.37;        // per radian of angle

  Stretch to = from;
  to.begin = time;
  if (from.moving) {
    const double elapsed = Seconds(time - from.begin).count();
    const double swell
        = std::cos(from.speed_phase) - std::cos(from.speed_phase + kSwellRate * elapsed);
    const double turned = from.speed * (elapsed + kSwell / kSwellRate * swell);
    to.angle += from.direction * turned;
    to.reach += kReachRate * turned;
    const double distance = 0.65 + 0.35 * std::sin(to.reach);
    to.u = 0.5 + 0.5 * distance * std::cos(to.angle);
    to.v = 0.5 + 0.5 * distance * std::sin(to.angle);
  }
  return to;
}

std::vector<Ball>
SyntheticFilm::balls_at(Time time, int width, int height) const
{
  time = std::max(time, Time(0));
  const Time loop = time - time % kPeriod;
  const Time within = time - loop;
  const double radius = settings_.ball_size * width / 2;
  const auto place = [radius](double position, int size) {
    const double room = std::max(size - 2 * radius, 0.0);
    return (size - room) / 2 + position * room;
  };

  std::vector<Ball> balls;
  for (std::size_t i = 0; i < tracks_.size(); i++) {
    const auto next
        = std::upper_bound(tracks_[i].begin(), tracks_[i].end(), within,
                           [](Time t, const Stretch &stretch) { return t < stretch.begin; });
    const Stretch now = advance(*std::prev(next), within);
    if (now.visible)
      balls.push_back({ .index = static_cast<int>(i),
                        .x = place(now.u, width),
                        .y = place(now.v, height),
                        .radius = radius,
                        .color = now.color,
                        .onset = loop + now.onset,
                        .moving = now.moving });
  }
  return balls;
}

void
draw_ball(const SamplePlane &plane, const Ball &ball, std::uint8_t value)
{
  // The edge is one sample wide; a ball smaller than a sample is drawn fainter instead of larger.
  const double sample_size = std::sqrt(static_cast<double>(plane.block_width) * plane.block_height);
  const double most
      = std::min(1.0, std::numbers::pi * ball.radius * ball.radius / (sample_size * sample_size));
  const double reach = ball.radius + sample_size / 2;
  const auto first = [reach](double center, int block) {
    return std::max(0, static_cast<int>(std::floor((center - reach) / block)));
  };
  const auto last = [reach](double center, int block, int size) {
    return std::min(size, static_cast<int>(std::ceil((center + reach) / block)));
  };

  for (int y = first(ball.y, plane.block_height);
       y < last(ball.y, plane.block_height, plane.height); y++) {
    const double dy = (y + 0.5) * plane.block_height - ball.y;
    for (int x = first(ball.x, plane.block_width); x < last(ball.x, plane.block_width, plane.width);
         x++) {
      const double dx = (x + 0.5) * plane.block_width - ball.x;
      const double inside = ball.radius - std::sqrt(dx * dx + dy * dy);
      const double share = most * std::clamp(inside / sample_size + 0.5, 0.0, 1.0);
      std::uint8_t &sample
          = plane.data[y * plane.row_stride + static_cast<std::ptrdiff_t>(x) * plane.pixel_stride];
      sample = static_cast<std::uint8_t>(std::lround(sample + share * (value - sample)));
    }
  }
}

SensorNoise::SensorNoise(double sigma, std::uint64_t seed) : seed_(mix_bits(seed ^ 0x6e6f697365U))
{
  sigma = std::clamp(sigma, 0.0, 32.0);
  if (!(sigma > 0))
    return;
  // Walks up the normal distribution: code k has the quantiles between Φ((k − ½) / σ) and Φ((k + ½)
  // / σ).
  int code = -static_cast<int>(std::ceil(4 * sigma)) - 1;
  for (std::size_t i = 0; i < kQuantiles; i++) {
    const double quantile = (static_cast<double>(i) + 0.5) / kQuantiles;
    while (0.5 * std::erfc(-(code + 0.5) / (sigma * std::numbers::sqrt2)) < quantile)
      code++;
    quantiles_[i] = static_cast<std::int16_t>(code);
  }
}

void
SensorNoise::add(const SamplePlane &plane, int component, Time time) const
{
  constexpr int kPerHash = 5; // quantile indices of 12 bits each
  const std::uint64_t frame = mix_bits(mix_bits(seed_ + static_cast<std::uint64_t>(time.count()))
                                       + static_cast<std::uint64_t>(component));

  for (int y = 0; y < plane.height; y++) {
    const std::uint64_t line = mix_bits(frame + static_cast<std::uint64_t>(y));
    std::uint8_t *sample = plane.data + y * plane.row_stride;
    for (int x = 0; x < plane.width;) {
      std::uint64_t bits = mix_bits(line + static_cast<std::uint64_t>(x));
      for (const int end = std::min(x + kPerHash, plane.width); x < end;
           x++, bits >>= 12U, sample += plane.pixel_stride)
        *sample = static_cast<std::uint8_t>(
            std::clamp(*sample + quantiles_[bits % kQuantiles], 0, 255));
    }
  }
}

} // namespace tactile
