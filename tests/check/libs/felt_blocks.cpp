// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/felt_blocks.h"

#include <cstdint>
#include <random>
#include <vector>

#include "frame_rate.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr double kRate = 5;

struct Block
{
  Time begin;
  std::vector<float> levels;

  bool operator==(const Block &) const = default;
};

/// The present block.
Block
felt(const FeltBlocks &blocks, Time begin)
{
  Block block{ begin, {} };
  for (std::size_t i = 0; i < blocks.cells(); i++)
    block.levels.push_back(blocks.level(i));
  return block;
}

} // namespace

CHECK_TEST(test_a_track_is_felt_as_its_film)
{
  // A track has a map for each block of its film, which lasts to the next one.
  for (const FrameRate &rate :
       { FrameRate{ 24000, 1001 }, FrameRate{ 25, 1 }, FrameRate{ 30, 1 }, FrameRate{ 60, 1 } })
    for (unsigned seed = 1; seed <= 20; seed++) {
      std::mt19937 random(seed);
      FeltBlocks film;
      std::vector<Block> track;
      std::vector<float> levels(4, 0.0F);
      for (std::int64_t frame = 0; frame < 1000; frame++) {
        for (float &level : levels)
          if (random() % 8 == 0)
            level = random() % 2 == 0 ? 0.0F : static_cast<float>(random() % 101) / 100;
        if (film.take({ rate.frame(frame), rate.duration(frame), levels }, kRate))
          track.push_back(felt(film, rate.frame(frame)));
      }
      FeltBlocks chair;
      for (std::size_t i = 0; i < track.size(); i++) {
        const Time end = i + 1 < track.size() ? track[i + 1].begin : track[i].begin + 200ms;
        fail_unless(chair.take({ track[i].begin, end - track[i].begin, track[i].levels }, kRate),
                    "seed %u: map %zu begins no block", seed, i);
        fail_unless(felt(chair, track[i].begin) == track[i], "seed %u: map %zu is another", seed,
                    i);
      }
    }
}

CHECK_TEST(test_frame_block)
{
  // On the grid alone, what becomes stronger waits for the next block.
  FeltBlocks blocks;
  const auto take = [&](int frame, float level) {
    return blocks.take({ kThirty.frame(frame), kThirty.duration(frame), std::vector{ level } },
                       kRate, true);
  };
  for (int frame = 0; frame < 18; frame++)
    fail_unless(take(frame, frame < 2 ? 0.1F : 1.0F) == (frame % 6 == 0), "frame %d", frame);
  fail_unless(blocks.level(0) == 1);
}

CHECK_TEST(test_levels_out_of_range)
{
  // What is as strong as can be does not become stronger.
  FeltBlocks blocks;
  for (int frame = 0; frame < 18; frame++)
    fail_unless(
        blocks.take({ kThirty.frame(frame), kThirty.duration(frame), std::vector{ 2.0F } }, kRate)
            == (frame % 6 == 0),
        "frame %d", frame);
  fail_unless(blocks.level(0) == 1);
}

CHECK_TEST(test_at_once)
{
  // A map of the sound is a block of its own and leaves the grid as it is.
  FeltBlocks blocks;
  const auto take = [&](int frame, float level, bool at_once = false) {
    return blocks.take(
        { kThirty.frame(frame), kThirty.duration(frame), std::vector{ level }, at_once }, kRate);
  };
  fail_unless(take(0, 0.5F));
  fail_unless(take(1, 0.3F, true) && blocks.level(0) == 0.3F);
  fail_unless(!take(5, 0.3F));
  fail_unless(take(6, 0.3F));
  blocks.silence();
  fail_unless(blocks.level(0) == 0 && take(7, 0.0F));
}

CHECK_MAIN(felt_blocks)
