// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The analysis allocates nothing for a frame once it is warm. Sanitizers have their own allocator,
// so meson leaves this test out there.
#include "support/allocations.h"

#include "frame/front_end.h"
#include "i420_frame.h"
#include "saliency/analyzer.h"
#include "sound/sound_analyzer.h"
#include "sound/synthetic_sound.h"
#include "tactile/tactile_mapping.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/check_tests.h"

namespace {

using oracle::Frame;

const cv::Size kFilm(160, 120);
const cv::Size kPicture(96, 72); ///< for Profile::tuned_spatial()

/// A camera that pans right over a texture, and back.
std::vector<Frame>
pan()
{
  const Frame world = oracle::textured(kFilm.width + 60, kFilm.height);
  std::vector<Frame> frames;
  for (int i = 0; i < 20; ++i) {
    const int left = 2 * (i < 10 ? i : 20 - i);
    Frame frame(kFilm.width, kFilm.height);
    for (std::size_t c = 0; c < 3; ++c)
      for (int y = 0; y < frame.plane_height(c); ++y)
        for (int x = 0; x < frame.plane_width(c); ++x)
          frame.at(c, x, y) = world.planes[c][static_cast<std::size_t>(
              y * world.plane_width(c) + x + (c == 0 ? left : left / 2))];
    // Features larger than noise, from which the camera's motion is estimated.
    for (int k = 0; k < 9; ++k)
      frame.disc(25 * k - left, 15 + 47 * k % 90, 11, { 60 + 20 * k, 128, 128 });
    frames.push_back(frame);
  }
  return frames;
}

std::vector<Frame>
still(cv::Size size)
{
  std::vector<Frame> frames;
  for (int i = 0; i < 30; ++i)
    frames.push_back(oracle::film(size.width, size.height, i));
  return frames;
}

/// A shot of five frames, then another.
std::vector<Frame>
cuts()
{
  std::vector<Frame> frames;
  for (int i = 0; i < 10; ++i)
    frames.push_back(Frame(kFilm.width, kFilm.height, i < 5 ? 40 : 200));
  return frames;
}

constexpr int kWarmUp = 200;
constexpr int kMeasured = 120;

/// Nothing rests before the frames that are measured, most of which show the same.
std::vector<Frame>
late_rest()
{
  std::vector<Frame> frames;
  for (int i = 0; i < kWarmUp; ++i) {
    frames.emplace_back(kFilm.width, kFilm.height, 90);
    frames.back().disc(20 + 37 * i % 120, 20 + 23 * i % 80, 15, { 200, 128, 128 });
  }
  frames.resize(kWarmUp + kMeasured, Frame(kFilm.width, kFilm.height, 90));
  return frames;
}

struct Counted
{
  std::uint64_t allocations;
  int cuts;
  int moved;
  int warm_up_unchanged;
  int unchanged;
};

/// Allocations during kMeasured frames that follow kWarmUp frames.
Counted
analyze(const saliency::Profile &profile, const tactile::MappingSettings &mapping, bool temporal,
        const std::vector<Frame> &frames, double rest = 0)
{
  saliency::Analyzer analyzer(profile);
  analyzer.set_rest(rest);
  tactile::TactileMap map(3, 3);
  Counted counted{ 0, 0, 0, 0, 0 };
  for (int i = 0; i < kWarmUp + kMeasured; ++i) {
    const auto view = frames[static_cast<std::size_t>(i) % frames.size()].view();
    const saliency::Time duration(33'333'333);
    const std::uint64_t before = allocations::of_this_thread();
    const auto &found = analyzer.analyze(view, i * duration, duration, temporal);
    tactile::map_saliency({ .values = found.map.ptr<float>(),
                            .width = found.map.cols,
                            .height = found.map.rows,
                            .stride = static_cast<std::ptrdiff_t>(found.map.step1()),
                            .horizontal = { found.picture.x, found.picture.width },
                            .vertical = { found.picture.y, found.picture.height } },
                          mapping, map);
    if (i >= kWarmUp)
      counted.allocations += allocations::of_this_thread() - before;
    counted.cuts += found.cut ? 1 : 0;
    counted.moved += found.camera_moves ? 1 : 0;
    (i < kWarmUp ? counted.warm_up_unchanged : counted.unchanged) += found.unchanged ? 1 : 0;
  }
  return counted;
}

} // namespace

CHECK_TEST(test_counter)
{
  // An allocation by each way in is seen.
  fail_unless(allocations::are_counted());
  const std::uint64_t before = allocations::of_this_thread();
  std::vector<int> by_new(10);
  cv::Mat by_opencv(10, 10, CV_8UC1);
  void *by_malloc = malloc(10);
  const std::uint64_t seen = allocations::of_this_thread() - before;
  free(by_malloc);
  fail_unless(seen >= 3);
}

CHECK_TEST(test_tuned)
{
  const auto mapping = tactile::MappingSettings::tuned();
  const auto profile = saliency::Profile::tuned();
  ck_assert_uint_eq(analyze(profile, mapping, true, still(kFilm)).allocations, 0);

  const Counted moving = analyze(profile, mapping, true, pan());
  ck_assert_int_ge(moving.moved, 100);
  ck_assert_uint_eq(moving.allocations, 0);

  const Counted cut = analyze(profile, mapping, true, cuts());
  ck_assert_int_ge(cut.cuts, 50);
  ck_assert_uint_eq(cut.allocations, 0);
}

CHECK_TEST(test_rest)
{
  // The noise floor allocates where things first stand still, also without a rest.
  const auto count = [](double rest) {
    return analyze(saliency::Profile::tuned(), tactile::MappingSettings::tuned(), true, late_rest(),
                   rest);
  };
  const Counted counted = count(0.8);
  ck_assert_int_eq(counted.warm_up_unchanged, 0);
  ck_assert_int_gt(counted.unchanged, kMeasured / 2);
  ck_assert_uint_eq(counted.allocations, count(0).allocations);
}

CHECK_TEST(test_tuned_spatial)
{
  const Counted counted
      = analyze(saliency::Profile::tuned_spatial(), tactile::MappingSettings::tuned_spatial(),
                false, still(kPicture));
  ck_assert_uint_eq(counted.allocations, 0);
}

CHECK_TEST(test_paper)
{
  const Counted counted
      = analyze(saliency::Profile::paper(), tactile::MappingSettings::paper(), true, still(kFilm));
  ck_assert_uint_eq(counted.allocations, 0);
}

CHECK_TEST(test_front_end)
{
  // 8-bit planes, deeper planes and packed pixels, with and without decimation.
  constexpr int kWidth = 800;
  constexpr int kHeight = 760;
  const Frame planes = oracle::film(kWidth, kHeight, 0);
  const std::vector<std::uint8_t> memory(static_cast<std::size_t>(kWidth) * kHeight * 4, 77);
  saliency::FrameView pixels;
  pixels.model = saliency::ColorModel::rgb;
  saliency::FrameView deep;
  deep.depth = 10;
  for (auto *view : { &pixels, &deep }) {
    view->width = kWidth;
    view->height = kHeight;
    const int stride = view == &pixels ? 4 : 2;
    for (std::size_t c = 0; c < 3; ++c)
      view->components[c]
          = { memory.data() + (view == &pixels ? c : 0), kWidth * stride, stride, kWidth, kHeight };
  }
  for (const auto &view : { planes.view(), pixels, deep })
    for (int level = 0; level <= 3; ++level)
      for (int converted = 0; converted <= level; ++converted) {
        saliency::FrontEnd front_end;
        front_end.lab(view, level, converted);
        const std::uint64_t before = allocations::of_this_thread();
        front_end.lab(view, level, converted);
        ck_assert_uint_eq(allocations::of_this_thread(), before);
      }
}

CHECK_TEST(test_sound)
{
  constexpr std::size_t kRate = 48000;
  const auto speakers = sound::usual_speakers(6);
  const sound::SyntheticSound made({ .seed = 1, .seconds = 4, .music = true, .impacts_db = -10 });
  std::vector<float> frames(4 * kRate * speakers.size());
  made.render(kRate, 0, speakers, frames);
  sound::SoundAnalyzer analyzer(kRate, speakers);
  std::uint64_t allocated = 0;
  int onsets = 0;
  const std::size_t block = 1000 * speakers.size();
  for (std::size_t at = 0; at + block <= frames.size(); at += block) {
    const std::uint64_t before = allocations::of_this_thread();
    const auto moments = analyzer.add(std::span(frames).subspan(at, block), {});
    allocated += allocations::of_this_thread() - before;
    for (const sound::Moment &moment : moments)
      onsets += moment.onset ? 1 : 0;
  }
  ck_assert_int_ge(onsets, 1);
  ck_assert_uint_eq(allocated, 0);
}

CHECK_MAIN(allocations)
