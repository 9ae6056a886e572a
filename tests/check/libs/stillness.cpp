// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Frames that show nothing new: the means of their blocks, the test, and the analysis that is left
// out.
#include "saliency/stillness.h"

#include "frame/block_means.h"
#include "i420_frame.h"
#include "saliency/analyzer.h"
#include "support/tolerance.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "support/check_tests.h"

using oracle::Frame;
using saliency::Analyzer;
using saliency::BlockMeans;
using saliency::FrameView;
using saliency::Profile;
using saliency::Stillness;
using saliency::Time;

namespace {

constexpr double kFloor = 0.8; ///< of the tuned mapping
constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr Time kFrame{ 1'000'000'000 / 30 };

/// Code 0…255 of sample (x, y) of a component, in the frame's own samples.
std::uint8_t
code(int component, int x, int y)
{
  return static_cast<std::uint8_t>(x * 7 + y * 13 + x * y + 50 * component);
}

/// A frame in memory of samples `code`.
struct Memory
{
  std::array<std::vector<std::uint8_t>, 3> bytes;
  FrameView view;

  /// `step`: bytes between samples; `shrink`: log2 of how much coarser chroma is.
  Memory(int width, int height, int depth, int shift, int step, int shrink)
  {
    view.width = width;
    view.height = height;
    view.depth = depth;
    view.shift = shift;
    for (int c = 0; c < 3; ++c) {
      const int by = c > 0 ? shrink : 0;
      const int w = (width + (1 << by) - 1) >> by;
      const int h = (height + (1 << by) - 1) >> by;
      auto &all = bytes[static_cast<std::size_t>(c)];
      all.assign(static_cast<std::size_t>(w * h * step), 0xA5);
      view.components[static_cast<std::size_t>(c)] = { all.data(), w * step, step, w, h };
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const int word = code(c, x, y) << (depth == 8 ? 0 : depth - 8 + shift);
          auto *at = all.data() + (y * w + x) * step;
          at[0] = static_cast<std::uint8_t>(word & 0xFF);
          if (depth > 8)
            at[1] = static_cast<std::uint8_t>(word >> 8);
        }
    }
  }
};

/// A textured picture with this noise, which differs from frame to frame.
Frame
make_grainy(double sigma, unsigned seed)
{
  Frame frame(kWidth, kHeight);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, std::max(sigma, 1e-9));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      frame.at(0, x, y) = static_cast<std::uint8_t>(std::clamp(
          120 + 30 * std::sin(0.04 * x + 0.02 * y) + 20 * std::sin(0.03 * y) + noise(random), 16.0,
          235.0));
  return frame;
}

/// One of eight of them.
const Frame &
grainy(double sigma, unsigned seed)
{
  static std::map<std::pair<double, unsigned>, Frame> made;
  const std::pair key{ sigma, sigma > 0 ? seed % 8 : 0 };
  auto found = made.find(key);
  if (found == made.end())
    found = made.emplace(key, make_grainy(sigma, key.second)).first;
  return found->second;
}

struct Played
{
  std::vector<double> peaks;
  std::vector<cv::Mat> maps;
  int unchanged = 0;
};

Played
play(double rest_floor, int frames, const std::function<Frame(int)> &frame,
     const Profile &profile = Profile::tuned())
{
  Analyzer analyzer(profile);
  analyzer.set_rest(rest_floor);
  Played played;
  for (int i = 0; i < frames; ++i) {
    const auto &found = analyzer.analyze(frame(i).view(), i * kFrame, kFrame);
    played.peaks.push_back(found.peak);
    played.maps.push_back(found.map.clone());
    played.unchanged += found.unchanged ? 1 : 0;
  }
  return played;
}

/// The first frame that is felt.
int
onset(const Played &played)
{
  return static_cast<int>(
      std::ranges::find_if(played.peaks, [](double peak) { return peak > kFloor; })
      - played.peaks.begin());
}

} // namespace

/// The means of each block, for each layout of memory, of every third or fifth row of large blocks.
CHECK_TEST(test_block_means)
{
  struct Layout
  {
    int depth, shift, step, shrink;
  };
  BlockMeans means;
  for (const Layout &layout : { Layout{ 8, 0, 1, 1 },
                                { 8, 0, 2, 1 },
                                { 8, 0, 3, 0 },
                                { 8, 0, 4, 0 },
                                { 10, 0, 2, 1 },
                                { 10, 6, 2, 1 },
                                { 16, 0, 2, 0 } })
    for (const int level : { 0, 1, 3, 5 }) {
      const Memory memory(203, 77, layout.depth, layout.shift, layout.step, layout.shrink);
      const auto &found = means(memory.view, level);
      for (int c = 0; c < 3; ++c) {
        const int by = c > 0 ? layout.shrink : 0;
        const int side = 1 << std::max(0, level - by);
        const int w = (203 + (1 << by) - 1) >> by;
        const int h = (77 + (1 << by) - 1) >> by;
        const cv::Mat1f &of = found[static_cast<std::size_t>(c)];
        double error = 0;
        for (int y = 0; y < of.rows; ++y)
          for (int x = 0; x < of.cols; ++x) {
            double sum = 0;
            int count = 0;
            for (int sy = std::min(y * side, h - 1); sy<std::min((y + 1) * side, h); sy += side> 16
                                                         ? 5
                                                     : side > 8 ? 3
                                                                : 1)
              for (int sx = std::min(x * side, w - 1); sx < std::min((x + 1) * side, w);
                   ++sx, ++count)
                sum += code(c, sx, sy);
            error = std::max(error, std::abs(of(y, x) - sum / std::max(count, 1)));
          }
        fail_unless_near(error, 0, 1e-3);
      }
    }
}

/// Noise is nothing new; a thing is, and so is a picture of which more than half is new.
CHECK_TEST(test_stillness)
{
  constexpr int kLevel = 2;
  for (const double sigma : { 0.0, 1.0, 2.0 }) {
    Stillness stillness;
    fail_if(stillness(grainy(sigma, 1).view(), kLevel, 0.24));
    fail_unless(stillness(grainy(sigma, 2).view(), kLevel, 0.24), "noise of %.0f", sigma);
    Frame thing = grainy(sigma, 3);
    thing.disc(100, 75, 10, { 90, 128, 128 });
    fail_if(stillness(thing.view(), kLevel, 0.24));
    fail_unless(stillness(thing.view(), kLevel, 0.24)); // it is the reference now
    Frame other = grainy(sigma, 4);
    for (auto &sample : other.planes[0])
      sample = static_cast<std::uint8_t>(sample + 20);
    stillness.keep(grainy(sigma, 5).view(), kLevel);
    fail_if(stillness(other.view(), kLevel, 0.24));
    Frame red = grainy(sigma, 6);
    red.disc(200, 75, 10, { 120, 128, 160 });
    stillness.keep(grainy(sigma, 7).view(), kLevel);
    fail_if(stillness(red.view(), kLevel, 0.24));
  }
}

/// A thing that appears in a noisy picture at rest is felt with the same frame as if all frames
/// were analyzed, and about as strongly, whichever frame of a rest it is. Of the rest, half and
/// more are not analyzed.
CHECK_TEST(test_onsets)
{
  for (const double sigma : { 0.0, 2.0 })
    for (int phase = 0; phase < 6; ++phase) {
      const int appears = 24 + phase;
      const auto film = [&](int i) {
        Frame frame = grainy(sigma, static_cast<unsigned>(i));
        if (i >= appears)
          frame.disc(165 + 2 * (i - appears), 90, 10, { 200, 128, 128 });
        return frame;
      };
      const Played all = play(0, appears + 12, film);
      const Played some = play(kFloor, appears + 12, film);
      ck_assert_int_eq(onset(all), appears);
      ck_assert_int_eq(onset(some), appears);
      for (std::size_t i = 0; i < all.peaks.size(); ++i)
        for (std::size_t i = 0; i < all.peaks.size(); ++i) {
          fail_unless_near(some.peaks[i], all.peaks[i], 0.05 * all.peaks[i] + 0.05);
          // Of frames that are the same, the maps are, too.
          if (sigma == 0)
            fail_unless(cv::norm(all.maps[i], some.maps[i], cv::NORM_INF) == 0, "frame %zu", i);
        }
      ck_assert_int_eq(all.unchanged, 0);
      fail_unless(some.unchanged > appears / 2, "%d of %d", some.unchanged, appears);
      fail_unless(some.unchanged < appears);
    }
}

/// What becomes visible by and by is felt no later, either.
CHECK_TEST(test_slow_onsets)
{
  for (const int codes : { 1, 2, 4 }) { // a frame
    const auto film = [&](int i) {
      Frame frame = grainy(0, 1);
      if (i > 20)
        frame.disc(165, 90, 30, { std::min(220, 120 + codes * (i - 20)), 128, 128 });
      return frame;
    };
    const int late = onset(play(kFloor, 60, film)) - onset(play(0, 60, film));
    fail_unless(late <= 0, "%d codes a frame: %d frames late", codes, late);
  }
}

/// All frames of a film in which something moves, bit for bit; and with the paper's method.
CHECK_TEST(test_moving)
{
  const auto film = [](int i) {
    Frame frame = grainy(2, static_cast<unsigned>(i));
    frame.disc(50 + 3 * i, 90, 10, { 200, 128, 128 });
    return frame;
  };
  const Played all = play(0, 30, film);
  const Played some = play(kFloor, 30, film);
  for (std::size_t i = 0; i < all.maps.size(); ++i)
    fail_unless(cv::norm(all.maps[i], some.maps[i], cv::NORM_INF) == 0, "frame %zu", i);
  ck_assert_int_eq(some.unchanged, 0);
  const auto still = [](int) {
    return grainy(0, 1);
  };
  ck_assert_int_eq(play(kFloor, 10, still, Profile::paper()).unchanged, 0);
}

CHECK_MAIN(stillness)
