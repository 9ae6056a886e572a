// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/synthetic_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace tactile {

namespace {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;

/// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): every bit of the input moves every bit of
/// the output.
constexpr std::uint64_t
mix(std::uint64_t x)
{
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// What random numbers are drawn for, so that one draw more here changes nothing there.
enum class Purpose : std::uint64_t
{
  rests = 1,
  count,
  places,
  colour,
  moves,
  path,
  noise,
};

/// Random numbers that depend on a key alone: those of rest 1000 don't need the 999 before it.
class Draws
{
public:
  Draws(std::uint64_t seed, Purpose purpose, std::int64_t index)
      : state_(mix(mix(seed + kGolden * static_cast<std::uint64_t>(purpose))
                   + static_cast<std::uint64_t>(index)))
  {
  }

  /// Uniform in [low, high); the middle where the range is empty.
  double uniform(double low, double high)
  {
    state_ += kGolden;
    const double share = static_cast<double>(mix(state_) >> 11) * 0x1p-53;
    return low < high ? low + share * (high - low) : (low + high) / 2;
  }

  /// Uniform in {0 … n - 1}.
  int below(int n)
  {
    return std::min(static_cast<int>(uniform(0, n)), n - 1);
  }

private:
  std::uint64_t state_;
};

/// Random lengths in [low, high] that add up to `total`, which n·low ≤ total ≤ n·high can reach.
void
share_out(Draws &draws, std::span<double> lengths, double low, double high, double total)
{
  for (double &length : lengths)
    length = draws.uniform(low, high);
  const double sum = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  const double bound = total > sum ? high : low;
  const double share = (total - sum) / (bound * static_cast<double>(lengths.size()) - sum);
  for (double &length : lengths)
    length += share * (bound - length);
}

constexpr Time
seconds(double value)
{
  return Time(static_cast<std::int64_t>(value * 1e9 + 0.5));
}

// Schedules repeat their length, not their content, in blocks: the block of a time is a division.
constexpr std::size_t kRestsPerBlock = 6;
constexpr Time kRestBlock = seconds(16);
constexpr std::size_t kMovesPerBlock = 4;
constexpr Time kMoveBlock = seconds(20);

constexpr double kElsewhere = 1.0 / 6; ///< how far a ball appears at least from where one was
constexpr int kAttempts = 64;          ///< to find such a place

/// Saturated, and in luma far from the background too: the film works in grey.
constexpr std::array<Rgb, 5> kBallColours{ {
    { 0.90F, 0.10F, 0.10F },
    { 0.05F, 0.50F, 0.10F },
    { 0.10F, 0.20F, 0.90F },
    { 0.80F, 0.10F, 0.70F },
    { 0.95F, 0.90F, 0.10F },
} };

/// Colour of the background at a place: grey, a little lighter towards the bottom right.
constexpr Rgb
background(double x, double y)
{
  const auto grey = static_cast<float>(0.60 + 0.03 * x + 0.03 * y);
  return { grey, grey, grey };
}

Rgb
ball_colour(std::uint64_t seed, std::int64_t index)
{
  return kBallColours[static_cast<std::size_t>(
      Draws(seed, Purpose::colour, index).below(kBallColours.size()))];
}

struct Rest
{
  std::int64_t index;
  Time start;
};

Rest
find_rest(std::uint64_t seed, Time time)
{
  const std::int64_t block = time / kRestBlock;
  Draws draws(seed, Purpose::rests, block);
  std::array<double, kRestsPerBlock> lengths;
  const double longest = draws.uniform(4, 6);
  const auto which = static_cast<std::size_t>(draws.below(kRestsPerBlock));
  share_out(draws, std::span(lengths).first(kRestsPerBlock - 1), 1.2, 3,
            kRestBlock.count() * 1e-9 - longest);
  lengths.back() = longest;
  std::swap(lengths[which], lengths.back());

  Time start = block * kRestBlock;
  std::size_t i = 0;
  while (i + 1 < kRestsPerBlock && time >= start + seconds(lengths[i]))
    start += seconds(lengths[i++]);
  return { block * static_cast<std::int64_t>(kRestsPerBlock) + static_cast<std::int64_t>(i),
           start };
}

} // namespace

SyntheticFilm::SyntheticFilm(FilmPattern pattern, std::uint64_t seed, int balls, double ball_size,
                             double aspect)
    : pattern_(pattern), seed_(seed), balls_(balls), radius_(ball_size / 2),
      radius_y_(std::min(radius_ * aspect, 0.5))
{
}

std::vector<Ball>
SyntheticFilm::balls_at(Time time) const
{
  time = std::max(time, Time(0));
  if (pattern_ == FilmPattern::static_motion)
    return resting_balls(time);
  return { moving_ball(time) };
}

std::vector<Ball>
SyntheticFilm::resting_balls(Time time) const
{
  const Rest rest = find_rest(seed_, time);
  const Rgb colour = ball_colour(seed_, rest.index);
  std::vector<Ball> balls;
  for (const Place &place : places(rest.index))
    balls.push_back({ place.x, place.y, radius_, colour, rest.start, false });
  return balls;
}

/// A rest keeps its distance from its neighbours. So that no rest needs all those before it, those
/// of even index don't look around and those of odd index look at both sides.
std::vector<SyntheticFilm::Place>
SyntheticFilm::places(std::int64_t rest) const
{
  const bool two = balls_ == 2 || (balls_ != 1 && Draws(seed_, Purpose::count, rest).below(2) == 1);
  Draws draws(seed_, Purpose::places, rest);
  const auto draw = [&]() -> std::vector<Place> {
    const auto y = [&] {
      return draws.uniform(radius_y_, 1 - radius_y_);
    };
    if (!two)
      return { { draws.uniform(radius_, 1 - radius_), y() } };
    const auto x = [&](int third) {
      return std::clamp(draws.uniform(third / 3.0 + radius_, (third + 1) / 3.0 - radius_), radius_,
                        1 - radius_);
    };
    const int first = draws.below(3);
    const int second = (first + 1 + draws.below(2)) % 3;
    const Place a{ x(first), y() };
    const Place b{ x(second), y() };
    return { a, b };
  };
  if (rest % 2 == 0)
    return draw();

  std::vector<Place> others = places(rest - 1);
  const std::vector<Place> next = places(rest + 1);
  others.insert(others.end(), next.begin(), next.end());
  const auto distance = [&](const std::vector<Place> &here) {
    double nearest = 2;
    for (const Place &a : here)
      for (const Place &b : others)
        nearest = std::min(nearest, std::hypot(a.x - b.x, a.y - b.y));
    return nearest;
  };
  std::vector<Place> best = draw();
  for (int i = 1; i < kAttempts && distance(best) < kElsewhere; i++)
    if (std::vector<Place> here = draw(); distance(here) > distance(best))
      best = std::move(here);
  return best;
}

/// The path is one smooth curve of a phase; moves run through it, stalls hold it.
Ball
SyntheticFilm::moving_ball(Time time) const
{
  constexpr double kPhasePerBlock = 10;
  constexpr double kTurn = 2 * std::numbers::pi;
  const std::int64_t block = time / kMoveBlock;

  Draws draws(seed_, Purpose::moves, block);
  std::array<double, kMovesPerBlock> stalls;
  for (double &stall : stalls)
    stall = draws.uniform(0.5, 1.5);
  stalls[static_cast<std::size_t>(draws.below(kMovesPerBlock))] = draws.uniform(3, 4);
  std::array<double, kMovesPerBlock> moves;
  share_out(draws, moves, 1.5, 5.5,
            kMoveBlock.count() * 1e-9 - std::accumulate(stalls.begin(), stalls.end(), 0.0));
  std::array<double, kMovesPerBlock> advances; // of the phase
  for (std::size_t i = 0; i < kMovesPerBlock; i++)
    advances[i] = moves[i] * draws.uniform(0.5, 1.5);
  const double advanced = std::accumulate(advances.begin(), advances.end(), 0.0);
  for (double &advance : advances)
    advance *= kPhasePerBlock / advanced;

  Time start = block * kMoveBlock;
  double phase = static_cast<double>(block) * kPhasePerBlock;
  std::size_t i = 0;
  while (i + 1 < kMovesPerBlock && time >= start + seconds(moves[i]) + seconds(stalls[i])) {
    start += seconds(moves[i]) + seconds(stalls[i]);
    phase += advances[i++];
  }
  const bool moving = time < start + seconds(moves[i]);

  // Within a move the speed swings twice between 0.4 and 1.6 times its mean, from anywhere, so that
  // the stop is sudden.
  const double share = moving ? static_cast<double>((time - start).count())
                                    / static_cast<double>(seconds(moves[i]).count())
                              : 1;
  const double swing
      = Draws(
            seed_, Purpose::moves,
            -1 - (block * static_cast<std::int64_t>(kMovesPerBlock) + static_cast<std::int64_t>(i)))
            .uniform(0, kTurn);
  phase += advances[i]
           * (share + 0.6 * (std::sin(swing + 2 * kTurn * share) - std::sin(swing)) / (2 * kTurn));

  Draws path(seed_, Purpose::path, 0);
  const auto coordinate = [&](double radius) {
    const auto wave = [&](double low, double high) {
      const double begin = path.uniform(0, kTurn);
      return std::sin(begin + path.uniform(low, high) * phase);
    };
    const double slow = wave(0.8, 1.1);
    const double fast = wave(1.5, 2.2);
    return 0.5 + (0.5 - radius) * (0.6 * slow + 0.4 * fast);
  };
  const double x = coordinate(radius_);
  const double y = coordinate(radius_y_);
  return { x, y, radius_, ball_colour(seed_, 0), start, moving };
}

Disc
disc_in_pixels(const Ball &ball, int width, int height)
{
  return { ball.x * width, ball.y * height, std::max(ball.radius * width, 0.5) };
}

void
paint_row(std::span<const Ball> balls, int width, int height, int y, int left, std::span<Rgb> row)
{
  for (std::size_t i = 0; i < row.size(); i++)
    row[i] = background((left + static_cast<int>(i) + 0.5) / width, (y + 0.5) / height);

  for (const Ball &ball : balls) {
    const Disc disc = disc_in_pixels(ball, width, height);
    const double dy = y + 0.5 - disc.y;
    const double reach = disc.radius + 0.5;
    if (std::abs(dy) >= reach)
      continue;
    const double half = std::sqrt(reach * reach - dy * dy);
    const int first = std::max(static_cast<int>(std::floor(disc.x - half - 0.5)), left);
    const int last = std::min(static_cast<int>(std::ceil(disc.x + half + 0.5)),
                              left + static_cast<int>(row.size()));
    for (int x = first; x < last; x++) {
      const double dx = x + 0.5 - disc.x;
      const auto cover
          = static_cast<float>(std::clamp(reach - std::sqrt(dx * dx + dy * dy), 0.0, 1.0));
      Rgb &pixel = row[static_cast<std::size_t>(x - left)];
      pixel.r += cover * (ball.colour.r - pixel.r);
      pixel.g += cover * (ball.colour.g - pixel.g);
      pixel.b += cover * (ball.colour.b - pixel.b);
    }
  }
}

void
add_noise(std::uint8_t *samples, int count, int step, double sigma, std::uint64_t seed, Time time,
          int component, int row)
{
  std::uint64_t key = mix(seed + kGolden * static_cast<std::uint64_t>(Purpose::noise));
  key = mix(key + static_cast<std::uint64_t>(time.count()));
  key = mix(key + (static_cast<std::uint64_t>(component) << 32) + static_cast<std::uint64_t>(row));

  // The sum of eight uniform bytes is normal for all that matters here (to 4.8 σ), and one hash
  // each.
  constexpr int kMean = 8 * 255 / 2;
  const double deviation = std::sqrt(8 * (256.0 * 256.0 - 1) / 12);
  const int scale = static_cast<int>(std::lround(sigma / deviation * 0x1p16));
  for (int i = 0; i < count; i++) {
    const std::uint64_t bytes = mix(key + kGolden * static_cast<std::uint64_t>(i + 1));
    const std::uint64_t pairs = (bytes & 0x00ff00ff00ff00ff) + ((bytes >> 8) & 0x00ff00ff00ff00ff);
    const int sum = static_cast<int>((pairs * 0x0001000100010001) >> 48);
    std::uint8_t &sample = samples[static_cast<std::ptrdiff_t>(i) * step];
    sample = static_cast<std::uint8_t>(
        std::clamp(sample + (((sum - kMean) * scale + 0x8000) >> 16), 0, 255));
  }
}

} // namespace tactile
