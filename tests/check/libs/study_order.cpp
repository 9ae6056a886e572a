// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Orders of conditions, and the places that participants get in them.
#include "study/order.h"

#include "support/check_tests.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

using study::GivenPlace;
using study::Place;
using study::Row;

/// Counted by brute force: the definition of a Williams square.
CHECK_TEST(test_williams_squares)
{
  for (std::size_t count = 1; count <= 12; count++) {
    const std::vector<Row> square = study::williams_square(count);
    const std::size_t rows = count > 1 && count % 2 == 1 ? 2 * count : count;
    fail_unless_equals_uint64(square.size(), rows);
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> positions;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> successions;
    for (const Row &row : square) {
      fail_unless_equals_uint64(std::set(row.begin(), row.end()).size(), count);
      for (std::size_t i = 0; i < count; i++) {
        fail_unless(row[i] < count);
        positions[{ i, row[i] }]++;
        if (i > 0)
          successions[{ row[i - 1], row[i] }]++;
      }
    }
    fail_unless_equals_uint64(positions.size(), count * count);
    fail_unless_equals_uint64(successions.size(), count * (count - 1));
    for (const auto &[which, times] : positions)
      fail_unless_equals_uint64(times, rows / count);
    for (const auto &[which, times] : successions)
      fail_unless_equals_uint64(times, rows / count);
  }
}

/// After each number of people, no two rows differ by more than one; of an even number of
/// conditions, neither do positions.
CHECK_TEST(test_places_are_even)
{
  for (const std::size_t count : { 2U, 3U, 5U, 6U }) {
    for (const std::size_t groups : { 1U, 3U }) {
      const std::vector<Row> square = study::williams_square(count);
      std::vector<GivenPlace> given;
      std::map<std::pair<std::size_t, std::size_t>, int> rows;
      for (std::size_t i = 0; i < 3 * groups * square.size(); i++) {
        const Place place = study::next_place(groups, square, given);
        fail_unless(place.group < groups && place.row < square.size());
        given.push_back({ .place = place });
        rows[{ place.group, place.row }]++;
        std::vector<std::size_t> sizes(groups);
        for (const GivenPlace &one : given)
          sizes[one.place.group]++;
        fail_unless(std::ranges::max(sizes) - std::ranges::min(sizes) <= 1);
        int least = 1000;
        for (std::size_t row = 0; row < square.size(); row++)
          least = std::min(least, rows[{ place.group, row }]);
        const int uses = rows[{ place.group, place.row }];
        fail_unless(uses - least <= 1);
        std::map<std::pair<std::size_t, std::size_t>, int> positions;
        int most = 0;
        for (const GivenPlace &one : given)
          if (one.place.group == place.group)
            for (std::size_t at = 0; at < count; at++)
              most = std::max(most, ++positions[{ at, square[one.place.row][at] }]);
        int fewest = most;
        for (std::size_t at = 0; at < count; at++)
          for (std::size_t condition = 0; condition < count; condition++)
            fewest = std::min(fewest, positions[{ at, condition }]);
        fail_unless(most - fewest <= (count % 2 == 0 ? 1 : 2), "%zu conditions, %zu people: %d, %d",
                    count, given.size(), most, fewest);
      }
    }
  }
}

CHECK_TEST(test_places_are_given_again)
{
  const std::vector<Row> square = study::williams_square(6);
  std::vector<GivenPlace> given;
  for (int i = 0; i < 9; i++)
    given.push_back({ .place = study::next_place(1, square, given) });
  for (const std::size_t dropped : { 7U, 2U }) {
    given[dropped].is_free = true;
    const Place again = study::next_place(1, square, given);
    fail_unless(again == given[dropped].place, "row %zu", again.row);
    given.push_back({ .place = again });
  }
}

CHECK_MAIN(study_order)
