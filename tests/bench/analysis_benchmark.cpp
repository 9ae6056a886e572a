// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What the analysis of a frame costs, I420 in, 3 x 3 levels out, on one thread: milliseconds
// (median), and as a multiple of what it takes to read the frame from memory once in the same run.
// "bare" is the tuned profile without what tells events from cuts, light, noise and camera motion.
#include "saliency/analyzer.h"
#include "tactile/tactile_mapping.h"

#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWarmUp = 5;

/// A film of two frames, noise and the same with a disc; or of a camera that pans to and fro, 4 pixels
/// a frame, over a texture of random squares.
struct Film
{
  int width;
  int height;
  std::vector<std::vector<std::uint8_t>> frames;

  Film(int width_, int height_, bool pan) : width(width_), height(height_)
  {
    pan ? draw_pan() : draw_disc();
  }

  std::size_t luma_size() const
  {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }

  std::size_t size() const
  {
    return luma_size()
           + 2 * static_cast<std::size_t>((width + 1) / 2)
                 * static_cast<std::size_t>((height + 1) / 2);
  }

  void draw_disc()
  {
    std::mt19937 random(1);
    std::vector<std::uint8_t> frame(size());
    for (std::uint8_t &sample : frame)
      sample = static_cast<std::uint8_t>(120 + random() % 8);
    frames.push_back(frame);
    for (int y = height / 3; y < height / 2; y++)
      std::memset(&frame[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)
                         + static_cast<std::size_t>(width) / 3],
                  200, static_cast<std::size_t>(width) / 12);
    frames.push_back(frame);
  }

  void draw_pan()
  {
    constexpr int kSteps = 8;
    constexpr int kStep = 4;
    const int side = width / 24;
    std::mt19937 random(1);
    std::vector<std::uint8_t> squares(4096);
    for (std::uint8_t &square : squares)
      square = static_cast<std::uint8_t>(40 + random() % 160);
    for (int i = 0; i < 2 * kSteps; i++) {
      const int shift = kStep * (i < kSteps ? i : 2 * kSteps - i);
      std::vector<std::uint8_t> frame(size(), 128);
      for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
          frame[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)
                + static_cast<std::size_t>(x)]
              = squares[static_cast<std::size_t>((x + shift) / side * 61 + y / side * 7) % 4096];
      frames.push_back(std::move(frame));
    }
  }

  saliency::FrameView view(std::size_t i) const
  {
    const std::uint8_t *data = frames[i % frames.size()].data();
    const int cw = (width + 1) / 2;
    const int ch = (height + 1) / 2;
    const std::ptrdiff_t luma = static_cast<std::ptrdiff_t>(width) * height;
    const std::ptrdiff_t chroma = static_cast<std::ptrdiff_t>(cw) * ch;
    saliency::FrameView view;
    view.width = width;
    view.height = height;
    view.components = { saliency::Component{ data, width, 1, width, height },
                        saliency::Component{ data + luma, cw, 1, cw, ch },
                        saliency::Component{ data + luma + chroma, cw, 1, cw, ch } };
    return view;
  }
};

template <typename Work>
double
median_ms(int runs, Work work)
{
  std::vector<double> times;
  for (int i = 0; i < kWarmUp + runs; i++) {
    const auto begin = Clock::now();
    work(static_cast<std::size_t>(i));
    if (i >= kWarmUp)
      times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return times[times.size() / 2];
}

double
read_ms(const Film &film)
{
  volatile std::uint64_t sink = 0;
  return median_ms(30, [&](std::size_t i) {
    const std::vector<std::uint8_t> &frame = film.frames[i % film.frames.size()];
    std::uint64_t sum = 0;
    for (std::size_t at = 0; at + 8 <= frame.size(); at += 8) {
      std::uint64_t word;
      std::memcpy(&word, &frame[at], 8);
      sum += word;
    }
    sink = sink + sum;
  });
}

double
analysis_ms(const Film &film, const saliency::Profile &profile,
            const tactile::MappingSettings &mapping, int runs)
{
  saliency::Analyzer analyzer(profile);
  tactile::TactileMap map(3, 3);
  return median_ms(runs, [&](std::size_t i) {
    const saliency::Time frame(33333333);
    const saliency::Saliency &found
        = analyzer.analyze(film.view(i), frame * static_cast<int>(i), frame);
    tactile::map_saliency({ .values = found.map.ptr<float>(),
                            .width = found.map.cols,
                            .height = found.map.rows,
                            .stride = static_cast<std::ptrdiff_t>(found.map.step1()),
                            .horizontal = { found.picture.x, found.picture.width },
                            .vertical = { found.picture.y, found.picture.height } },
                          mapping, map);
  });
}

} // namespace

int
main()
{
  cv::setNumThreads(1);
  std::printf(
      "| I420 | memory read, ms | bare, ms | tuned, ms | tuned, camera moving, ms | paper, ms | "
      "tuned / memory read | paper / tuned |\n|---|---|---|---|---|---|---|---|\n");
  saliency::Profile bare = saliency::Profile::tuned();
  bare.illumination_guard = false;
  bare.camera_motion = false;
  bare.background_gain = 0;
  bare.cut_share = 1;
  const auto tuned_mapping = tactile::MappingSettings::tuned();
  const int sizes[][2] = { { 640, 480 }, { 1000, 1000 }, { 1920, 1080 }, { 3840, 2160 } };
  for (const auto &[width, height] : sizes) {
    const Film film(width, height, false);
    const Film pan(width, height, true);
    const int runs = static_cast<int>(60'000'000LL / width / height) + 5;
    const double read = read_ms(film);
    const double plain = analysis_ms(film, bare, tuned_mapping, 2 * runs);
    const double tuned = analysis_ms(film, saliency::Profile::tuned(), tuned_mapping, 2 * runs);
    const double moving = analysis_ms(pan, saliency::Profile::tuned(), tuned_mapping, 2 * runs);
    const double paper
        = analysis_ms(film, saliency::Profile::paper(), tactile::MappingSettings::paper(), runs);
    std::printf("| %d x %d | %.3f | %.2f | %.2f | %.2f | %.1f | %.1f | %.1f |\n", width, height,
                read, plain, tuned, moving, paper, tuned / read, paper / tuned);
    std::fflush(stdout);
  }
  return 0;
}
