// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/tactile_mapping.h"

#include "saliency_map.h"
#include "support/tolerance.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "support/check_tests.h"

using tactile::Gain;
using tactile::MappingSettings;
using tactile::Order;
using tactile::SaliencyView;
using tactile::TactileMap;

namespace {

/// Pooling alone by exact area: no floor, no threshold, no gain.
constexpr MappingSettings kPooling{ .floor = 0, .threshold = 0, .gain = Gain::none };

TactileMap
levels(const Map &map, const MappingSettings &settings, int rows, int columns, double strength = 0)
{
  TactileMap out(rows, columns);
  std::fill(out.levels.begin(), out.levels.end(), 0.77F); // must be overwritten
  tactile::SaliencyView view = map.view();
  view.strength = strength;
  map_saliency(view, settings, out);
  return out;
}

bool
silent(const TactileMap &map)
{
  return std::all_of(map.levels.begin(), map.levels.end(), [](float level) { return level == 0; });
}

Map
random_map(int width, int height, unsigned seed)
{
  Map map(width, height);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(0, 1);
  for (float &v : map.values)
    v = value(generator);
  return map;
}

/// Mean of the map over a cell's area, as an exact sum. The picture covers [begin, begin + length)
/// of the map's samples. Sample i covers [i, i + 1), and the border is repeated.
struct Extent
{
  double begin;
  double length;
};

double
area_mean(const Map &map, Extent horizontal, Extent vertical, int rows, int columns, int r, int c)
{
  const auto inside = [](int sample, const Extent &picture, int cell, int cells) {
    const double begin = picture.begin + picture.length * cell / cells;
    const double end = picture.begin + picture.length * (cell + 1) / cells;
    return std::max(0.0, std::min(sample + 1.0, end) - std::max(1.0 * sample, begin));
  };
  double sum = 0;
  double area = 0;
  for (int y = -10; y < map.height + 10; ++y)
    for (int x = -10; x < map.width + 10; ++x) {
      const double share = inside(x, horizontal, c, columns) * inside(y, vertical, r, rows);
      const int nearest
          = std::clamp(y, 0, map.height - 1) * map.width + std::clamp(x, 0, map.width - 1);
      sum += share * static_cast<double>(map.values[static_cast<std::size_t>(nearest)]);
      area += share;
    }
  return sum / area;
}

} // namespace

CHECK_TEST(test_pooling_by_area)
{
  unsigned seed = 0;
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 2, 1 }, { 3, 5 }, { 16, 12 }, { 55, 31 }, { 64, 64 }, { 100, 7 } })
    for (const auto &[rows, columns] :
         { std::pair{ 1, 1 }, { 3, 3 }, { 2, 5 }, { 7, 4 }, { 64, 64 }, { 1, 64 } }) {
      const Map map = random_map(width, height, ++seed);
      const TactileMap out = levels(map, kPooling, rows, columns);
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c)
          fail_unless_near(
              out.at(r, c),
              area_mean(map, { 0, 1.0 * width }, { 0, 1.0 * height }, rows, columns, r, c), 1e-6);
    }
}

CHECK_TEST(test_picture_in_the_map)
{
  // In a pyramid, the picture begins inside the first sample and ends inside the last one or beyond
  // it.
  unsigned seed = 500;
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 5, 4 }, { 31, 18 } })
    for (const auto &[rows, columns] : { std::pair{ 1, 1 }, { 3, 3 }, { 5, 64 } })
      for (const double begin : { 0.0, 0.46875, 0.25 })
        for (const double end : { 0.0, 0.4375, -0.25 }) {
          const Map map = random_map(width, height, ++seed);
          const Extent horizontal{ begin, width + end - begin };
          const Extent vertical{ begin / 2, height - end - begin / 2 };
          SaliencyView view = map.view();
          view.horizontal = { horizontal.begin, horizontal.length };
          view.vertical = { vertical.begin, vertical.length };
          TactileMap out(rows, columns);
          map_saliency(view, kPooling, out);
          for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c)
              fail_unless_near(out.at(r, c),
                               area_mean(map, horizontal, vertical, rows, columns, r, c), 1e-6);
        }
}

CHECK_TEST(test_square_in_one_cell)
{
  // 4×4 of the 10×10 pixels of a cell, in each cell of each grid.
  for (const int side : { 1, 3, 4 })
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        const Map map
            = Map(10 * side, 10 * side).square(10 * c + 3, 10 * r + 3, 10 * c + 7, 10 * r + 7, 1);
        const TactileMap out = levels(map, kPooling, side, side);
        for (int i = 0; i < side; ++i)
          for (int j = 0; j < side; ++j)
            fail_unless_near(out.at(i, j), i == r && j == c ? 0.16 : 0.0, 1e-7);
      }
}

CHECK_TEST(test_square_on_a_border)
{
  // 6 columns are in the left cell and 2 in the right one, 3 rows above and 5 below, as shares of
  // 100 pixels a cell.
  const Map map = Map(20, 20).square(4, 7, 12, 15, 1);
  const TactileMap out = levels(map, kPooling, 2, 2);
  fail_unless_near(out.at(0, 0), 18 / 100.0, 1e-7);
  fail_unless_near(out.at(0, 1), 6 / 100.0, 1e-7);
  fail_unless_near(out.at(1, 0), 30 / 100.0, 1e-7);
  fail_unless_near(out.at(1, 1), 10 / 100.0, 1e-7);

  // With 3 pixels and 2 cells, the middle pixel counts half in each.
  const TactileMap halves = levels(Map(3, 1).square(1, 0, 2, 1, 1), kPooling, 1, 2);
  fail_unless_near(halves.at(0, 0), 1 / 3.0, 1e-7);
  fail_unless_near(halves.at(0, 1), 1 / 3.0, 1e-7);
}

CHECK_TEST(test_map_smaller_than_grid)
{
  // One pixel fills any grid, two fill a half each.
  for (const int side : { 1, 3, 64 })
    for (const float level : levels(Map(1, 1, 0.5F), kPooling, side, side).levels)
      fail_unless_near(level, 0.5, 1e-7);
  const TactileMap out = levels(Map(2, 1).square(1, 0, 2, 1, 1), kPooling, 64, 64);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c)
      fail_unless_near(out.at(r, c), c < 32 ? 0 : 1, 0);
}

CHECK_TEST(test_stride)
{
  // A negative stride.
  const Map memory = random_map(9, 6, 3);
  Map map(9, 6);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 9; ++x)
      map.at(x, y) = memory.values[static_cast<std::size_t>((5 - y) * 9 + x)];
  TactileMap out(3, 3);
  map_saliency({ memory.values.data() + 5 * 9, 9, 6, -9 }, kPooling, out);
  fail_unless(out == levels(map, kPooling, 3, 3));
}

CHECK_TEST(test_threshold)
{
  // 1, ½, just above ½ and just below. At 50 % only values above ½ remain.
  Map map(4, 1);
  map.values = { 8, 4, std::nextafter(4.0F, 8.0F), std::nextafter(4.0F, 0.0F) };
  MappingSettings settings = kPooling;
  settings.order = Order::threshold_first;
  settings.binary = true;
  settings.threshold = 0.5;
  const auto kept = [&](double threshold) {
    settings.threshold = threshold;
    return levels(map, settings, 1, 4).levels;
  };
  fail_unless((kept(0.5) == std::vector<float>{ 1, 0, 1, 0 }));
  fail_unless((kept(0.25) == std::vector<float>{ 1, 1, 1, 1 }));
  fail_unless((kept(0.9) == std::vector<float>{ 1, 0, 0, 0 }));
  fail_unless((kept(1) == std::vector<float>{ 1, 0, 0, 0 })); // the maximum always remains
  settings.binary = false;
  map.values = { 0.5F, 0.25F, 0.375F, 0 };
  fail_unless((kept(0.5) == std::vector<float>{ 0.5F, 0, 0.375F, 0 }));
  fail_unless((kept(0) == std::vector<float>{ 0.5F, 0.25F, 0.375F, 0 }));
}

CHECK_TEST(test_threshold_of_cells)
{
  // Pooled by the integral of the map, then compared with the strongest cell.
  unsigned seed = 700;
  for (const double threshold : { 0.0, 0.5, 0.9, 0.98, 1.0 })
    for (const auto &[rows, columns] : { std::pair{ 3, 3 }, { 2, 5 }, { 1, 1 }, { 8, 8 } }) {
      const Map map = random_map(31, 18, ++seed);
      MappingSettings settings = kPooling;
      settings.order = Order::pool_first;
      settings.threshold = threshold;
      std::vector<double> cells;
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c)
          cells.push_back(area_mean(map, { 0, 31.0 }, { 0, 18.0 }, rows, columns, r, c));
      const double strongest = *std::max_element(cells.begin(), cells.end());
      const TactileMap out = levels(map, settings, rows, columns);
      int kept = 0;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const bool keep = cells[i] > threshold * strongest || cells[i] == strongest;
        fail_unless_near(out.levels[i], keep ? cells[i] : 0, 1e-6);
        kept += keep ? 1 : 0;
      }
      fail_unless(threshold < 1 || kept == 1);
    }

  // A spike does not outweigh a cell that is salient all over; compared by pixels, it does.
  const Map map = Map(30, 10).square(4, 4, 5, 5, 1.0F).square(10, 0, 20, 10, 0.4F);
  MappingSettings settings = kPooling;
  settings.threshold = 0.5;
  settings.order = Order::pool_first;
  const TactileMap cells = levels(map, settings, 1, 3);
  fail_unless_near(cells.at(0, 0), 0, 0);
  fail_unless_near(cells.at(0, 1), 0.4, 1e-6);
  settings.order = Order::threshold_first;
  const TactileMap pixels = levels(map, settings, 1, 3);
  fail_unless_near(pixels.at(0, 0), 0.01, 1e-6);
  fail_unless_near(pixels.at(0, 1), 0, 0);
}

CHECK_TEST(test_center_weight)
{
  // Values of the formula by hand: a cell in a corner of 3 × 3 is a third of each side away,
  // exp(−2 (1/3)² / (2 · 0.25²)) = 0.169013; one beside the middle 0.411112.
  MappingSettings settings = kPooling;
  const Map map(9, 9, 0.5F);
  for (const double weight : { 0.0, 0.7, 1.0 }) {
    settings.center_weight = weight;
    const TactileMap out = levels(map, settings, 3, 3);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        const double near = r == 1 && c == 1 ? 1 : r == 1 || c == 1 ? 0.411112 : 0.169013;
        fail_unless_near(out.at(r, c), 0.5 * (1 - weight + weight * near), 1e-6);
      }
  }
}

CHECK_TEST(test_floor)
{
  MappingSettings settings = kPooling;
  settings.floor = 0.75;
  fail_unless(silent(levels(Map(4, 4, 0.75F), settings, 3, 3)));
  fail_if(silent(levels(Map(4, 4, std::nextafter(0.75F, 1.0F)), settings, 3, 3)));
  settings.floor = 0;
  fail_unless(silent(levels(Map(4, 4, 0), settings, 3, 3)));
  // The floor applies to the map's maximum, before pooling.
  settings.floor = 0.75;
  fail_if(silent(levels(Map(100, 100).square(0, 0, 1, 1, 1), settings, 1, 1)));
}

CHECK_TEST(test_perceptual_gain)
{
  // The event's ΔE gives the strongest cell's level, whatever the event's size. Values of the
  // formula by hand.
  const struct
  {
    double delta_e;
    double level;
  } cases[] = { { 1, 0.2 },          { 4, 0.2 },          { 10, 0.370697711 },
                { 29, 0.705696447 }, { 54, 0.891731773 }, { 400, 0.999999895 } };
  for (const Order order : { Order::threshold_first, Order::pool_first }) {
    MappingSettings settings{
      .order = order, .threshold = 0.4, .gain = Gain::perceptual, .units_per_delta_e = 0.065
    };
    for (const auto &c : cases)
      for (const int size : { 1, 4, 10 }) {
        const auto value = static_cast<float>(c.delta_e * 0.065);
        const Map map
            = Map(30, 30).square(12, 12, std::min(20, 12 + size), std::min(20, 12 + size), value);
        const TactileMap out = levels(map, settings, 3, 3);
        for (int i = 0; i < 9; ++i)
          fail_unless_near(out.levels[static_cast<std::size_t>(i)], i == 4 ? c.level : 0, 2e-6);
      }

    // Other cells keep their ratio: one with half the area, one with the same area at 0.75 of the
    // value.
    const Map map = Map(30, 10)
                        .square(0, 0, 4, 4, 1.885F)
                        .square(11, 1, 15, 3, 1.885F)
                        .square(22, 2, 26, 6, 0.75F * 1.885F);
    const TactileMap out = levels(map, settings, 1, 3);
    fail_unless_near(out.at(0, 0), 0.705696447, 1e-6); // 29 ΔE
    fail_unless_near(out.at(0, 1), 0.705696447 / 2, 1e-6);
    fail_unless_near(out.at(0, 2), 0.705696447 * 0.75, 1e-6);
    settings.binary = true;
    fail_unless_near(levels(map, settings, 1, 3).at(0, 2), 0.705696447, 1e-6);
  }
}

CHECK_TEST(test_relative_gain)
{
  // The event's strength gives the strongest cell's level, whatever the map's values. Values of the
  // formula by hand: a thirtieth is the weakest, the root of a thirtieth is half way.
  MappingSettings settings{ .threshold = 0.4, .gain = Gain::relative };
  const Map map = Map(30, 10).square(11, 1, 15, 5, 2.0F).square(22, 2, 26, 6, 1.5F);
  for (const auto &[strength, level] : { std::pair{ 0.0, 0.3 },
                                         { 0.01, 0.3 },
                                         { 1.0 / 30, 0.3 },
                                         { 0.182574186, 0.65 },
                                         { 0.5, 0.857343495 },
                                         { 1.0, 1.0 },
                                         { 7.0, 1.0 } })
    for (const double sensitivity : { 0.5, 1.0, 3.0 }) {
      settings.sensitivity = sensitivity;
      const TactileMap out = levels(map, settings, 1, 3, strength / sensitivity);
      fail_unless_near(out.at(0, 0), 0, 0);
      fail_unless_near(out.at(0, 1), level, 1e-6);
      fail_unless_near(out.at(0, 2), 0.75 * level, 1e-6);
    }
}

CHECK_TEST(test_no_gain_is_limited)
{
  const TactileMap out = levels(Map(4, 4, 37.0F), kPooling, 2, 2);
  for (const float level : out.levels)
    fail_unless_near(level, 1, 0);
}

CHECK_TEST(test_prefilter)
{
  // By definition: each pixel becomes the Gaussian mean about it (over the map's own samples),
  // which is interpolated at the centers of the cells.
  MappingSettings settings = kPooling;
  unsigned seed = 40;
  for (const double sigma : { 0.2, 1.0 / 3, 1.0 })
    for (const auto &[width, height] :
         { std::pair{ 1, 1 }, { 1, 9 }, { 8, 6 }, { 30, 30 }, { 47, 23 } })
      for (const auto &[rows, columns] : { std::pair{ 3, 3 }, { 1, 1 }, { 2, 5 }, { 40, 64 } }) {
        settings.prefilter_sigma = sigma;
        const Map map = random_map(width, height, ++seed);
        const auto filtered = [&](double px, double py, int r_, int c_) {
          double sum = 0;
          double weights = 0;
          for (int y = 0; y < r_; ++y)
            for (int x = 0; x < c_; ++x) {
              const double dx = (x - px) / (sigma * width / columns);
              const double dy = (y - py) / (sigma * height / rows);
              const double weight = std::exp(-(dx * dx + dy * dy) / 2);
              sum += weight
                     * static_cast<double>(map.values[static_cast<std::size_t>(y * width + x)]);
              weights += weight;
            }
          return sum / weights;
        };
        const TactileMap out = levels(map, settings, rows, columns);
        for (int r = 0; r < rows; ++r)
          for (int c = 0; c < columns; ++c) {
            const double x = std::clamp((c + 0.5) * width / columns - 0.5, 0.0, width - 1.0);
            const double y = std::clamp((r + 0.5) * height / rows - 0.5, 0.0, height - 1.0);
            double expected = 0;
            for (const double j : { std::floor(y), std::floor(y) + 1 })
              for (const double i : { std::floor(x), std::floor(x) + 1 }) {
                const double weight = (1 - std::abs(x - i)) * (1 - std::abs(y - j));
                if (weight > 0)
                  expected += weight * filtered(i, j, height, width);
              }
            // the Gaussian ends at 4 σ, which omits 6e-5 of the weight
            fail_unless_near(out.at(r, c), expected, 1e-3);
          }
      }
}

CHECK_TEST(test_profiles)
{
  const auto paper = MappingSettings::paper();
  fail_unless(paper.order == Order::threshold_first && paper.binary && paper.gain == Gain::none);
  fail_unless_near(paper.threshold, 0.5, 0);
  fail_unless_near(paper.floor, 0, 0);
  // A half-plane of any value: levels do not depend on it, and fall off across its border.
  for (const float value : { 0.001F, 300.0F }) {
    const TactileMap out = levels(Map(90, 90).square(0, 0, 45, 90, value), paper, 3, 3);
    for (int r = 0; r < 3; ++r) {
      fail_unless_near(out.at(r, 0), 1, 0.002); // the border is 3 σ away
      fail_unless_near(out.at(r, 1), 0.5, 1e-6);
      fail_unless_near(out.at(r, 2), 0, 0.002);
    }
  }

  const auto tuned = MappingSettings::tuned();
  fail_unless(silent(levels(Map(9, 9, 0.79F), tuned, 3, 3, 1)));
  // The center counts more, but a corner is felt: 1 − 0.4 + 0.4 · 0.411112 beside it, and in the
  // corners 0.4 · 0.169013.
  const TactileMap even = levels(Map(9, 9, 0.81F), tuned, 3, 3, 1);
  for (int i = 0; i < 9; ++i)
    fail_unless_near(even.levels[static_cast<std::size_t>(i)],
                     i == 4       ? 1
                     : i % 2 == 1 ? 0.764445
                                  : 0.667605,
                     1e-5);
  // Cells are compared, not pixels: of means 2 · 9/100, 1 and 0.4 the second is felt.
  const Map map
      = Map(30, 10).square(3, 3, 6, 6, 2.0F).square(10, 0, 20, 10, 1.0F).square(20, 0, 30, 4, 1.0F);
  const TactileMap out = levels(map, tuned, 1, 3, 1);
  fail_unless_near(out.at(0, 0), 0, 0);
  fail_unless_near(out.at(0, 1), 1, 1e-6);
  fail_unless_near(out.at(0, 2), 0, 0);
}

CHECK_TEST(test_spatial_profile)
{
  // Two units of the map are 1 ΔE. The weakest level is 0.2 at 4 ΔE, as in the other profiles.
  for (const double s : { 7.9, 8.1, 16.0, 58.0, 200.0 }) {
    const Map spatial = Map(9, 9).square(3, 3, 6, 6, static_cast<float>(s));
    const TactileMap out = levels(spatial, MappingSettings::tuned_spatial(), 3, 3);
    const double expected = s > 8 ? 0.2 + 0.8 * (1 - std::exp(-(s / 2 - 4) / 25)) : 0;
    fail_unless_near(out.levels[4], expected, 1e-6);
  }
  // The center counts more: 1 − 0.7 + 0.7 · 0.411112 beside it, in the corners less than half.
  const TactileMap even = levels(Map(9, 9, 16.0F), MappingSettings::tuned_spatial(), 3, 3);
  const double level = 0.2 + 0.8 * (1 - std::exp(-4.0 / 25));
  for (int i = 0; i < 9; ++i)
    fail_unless_near(even.levels[static_cast<std::size_t>(i)],
                     i == 4       ? level
                     : i % 2 == 1 ? level * 0.5877784
                                  : 0,
                     1e-6);
}

CHECK_TEST(test_bad_values)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const auto &settings : { MappingSettings::paper(), MappingSettings::tuned(), kPooling })
    for (const float bad : { nan, inf, -inf, -1.0F }) {
      fail_unless(silent(levels(Map(4, 4, bad), settings, 3, 3)));
      Map map(4, 4, 0.8F);
      Map good(4, 4, 0.8F);
      map.at(1, 2) = bad;
      good.at(1, 2) = 0;
      fail_unless(levels(map, settings, 3, 3) == levels(good, settings, 3, 3));
    }

  const Map map(4, 4, 0.8F);
  TactileMap out(2, 2);
  for (const SaliencyView view : { SaliencyView{}, SaliencyView{ nullptr, 4, 4, 4 },
                                   SaliencyView{ map.values.data(), 0, 4, 4 },
                                   SaliencyView{ map.values.data(), 4, -1, 4 } }) {
    std::fill(out.levels.begin(), out.levels.end(), 0.77F);
    map_saliency(view, kPooling, out);
    fail_unless(silent(out));
  }
  TactileMap nothing;
  map_saliency(map.view(), MappingSettings::tuned(), nothing);
  fail_unless(nothing == TactileMap());
}

CHECK_MAIN(tactile_mapping)
