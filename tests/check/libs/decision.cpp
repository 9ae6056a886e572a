// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When places that searches find are believed: scores and times are set.
#include "listen/decision.h"

#include <vector>

#include "support/unwrap.h"

#include "support/check_tests.h"

using listen::Candidate;

namespace {

constexpr std::int64_t kSecond = 250;
constexpr Candidate kHere{ .film = 1, .step = 1000, .score = 6 };
constexpr Candidate kThere{ .film = 2, .step = 500, .score = 6 };
constexpr Candidate kChance{ .film = 3, .step = 9, .score = 4 };

struct Searches
{
  listen::Decision decision{};
  std::int64_t now = 0;

  /// Half a second later.
  bool finds(const std::vector<Candidate> &found)
  {
    now += kSecond / 2;
    return decision.take(found, now).has_value();
  }
};

} // namespace

CHECK_TEST(test_sure)
{
  Searches searches;
  fail_if(searches.finds({}) || searches.finds({ kChance }) || searches.finds({ kHere, kThere }));
  Candidate high = kHere;
  high.score = 7.5;
  fail_unless(searches.finds({ kChance, high }));
  Candidate other = kThere;
  other.score = 6.5;
  fail_if(searches.finds({ other, high }), "another place is as good");
}

/// All searches of 1.5 s.
CHECK_TEST(test_likely)
{
  Searches searches;
  int count = 1;
  while (!searches.finds({ kHere, kChance }))
    count++;
  fail_unless(count == 4, "%d", count);
}

/// Two sightings of chance, however far apart.
CHECK_TEST(test_disagreement)
{
  const std::vector<std::vector<Candidate>> between{
    {}, { kChance }, { kThere }, { kHere, kThere }
  };
  for (const auto &found : between) {
    Searches searches;
    fail_if(searches.finds({ kHere }));
    fail_if(searches.finds(found));
    searches.now += 60 * kSecond;
    fail_if(searches.finds({ kHere }), "a minute later");
  }
  Searches searches;
  fail_if(searches.finds({ kHere }));
  searches.decision.forget();
  searches.now += 60 * kSecond;
  fail_if(searches.finds({ kHere }), "of other sound");
}

CHECK_MAIN(decision)
