// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When places that searches find are believed: scores and times are set.
#include "listen/decision.h"

#include <tuple>
#include <vector>

#include "support/unwrap.h"

#include "support/check_tests.h"

using listen::Candidate;

namespace {

constexpr std::int64_t kSecond = 250;
constexpr Candidate kHere{ .film = 1, .step = 1000, .score = 6.5 };
constexpr Candidate kThere{ .film = 2, .step = 500, .score = 6.5 };
constexpr Candidate kAgain{ .film = 1, .step = 2750, .score = 6.5 };
constexpr Candidate kChance{ .film = 3, .step = 9, .score = 5 };

struct Searches
{
  listen::Decision decision{};
  std::int64_t now = 0;
  double of_newer = 6;               ///< the score of the newer sound
  std::vector<std::int64_t> asked{}; ///< steps from which on it was newer

  /// Half a second later.
  bool finds(const std::vector<Candidate> &found)
  {
    now += kSecond / 2;
    return decision
        .take(found, now,
              [&](const Candidate &, std::int64_t since) {
                asked.push_back(since);
                return of_newer;
              })
        .has_value();
  }
};

Candidate
scored(Candidate place, double score)
{
  place.score = score;
  return place;
}

} // namespace

/// After a second of sound which had no part in the choice.
CHECK_TEST(test_newer)
{
  Searches searches;
  fail_if(searches.finds({ kChance, kHere }) || searches.finds({ kHere, kChance }));
  fail_unless(searches.finds({ kHere, kChance }));
  fail_unless(searches.asked == std::vector<std::int64_t>{ kSecond / 2 });
  fail_if(searches.finds({ kHere }), "it begins anew");
  Searches of_chance{ .of_newer = 1 };
  for (int i = 0; i < 60; i++)
    fail_if(of_chance.finds({ kHere }), "the newer sound does not fit");
  of_chance.of_newer = 6;
  fail_unless(of_chance.finds({ kHere }));
}

/// At once, unless another place has more than chance's score.
CHECK_TEST(test_certain)
{
  Searches searches{ .of_newer = 1 };
  fail_unless(searches.finds({ scored(kHere, 9), kChance }) && searches.asked.empty());
  fail_if(searches.finds({ scored(kHere, 9), scored(kThere, 5.8) }));
}

/// A place that was seen with a low score counts from then on.
CHECK_TEST(test_rising)
{
  Searches searches;
  for (const double score : { 4.6, 4.8, 5.0 })
    fail_if(searches.finds({ scored(kHere, score), scored(kThere, 4.9) }));
  fail_unless(searches.finds({ scored(kThere, 4.9), kHere }));
  fail_unless(searches.asked == std::vector<std::int64_t>{ kSecond / 2 });
  fail_if(searches.finds({ scored(kHere, 4) }) || searches.finds({ kHere })
              || searches.finds({ kHere }),
          "it had nearly no score");
}

/// Other films, and other places of the film, as where music repeats itself.
CHECK_TEST(test_alike)
{
  for (const auto &[other, alike, least] :
       { std::tuple(kThere, 5.3, 5.1), std::tuple(kAgain, 5.0, 4.8) }) {
    Searches searches;
    for (int i = 0; i < 10; i++)
      fail_if(searches.finds({ scored(other, alike), kHere }), "another place is as good");
    fail_unless(searches.finds({ scored(other, least), kHere }));
    Searches both;
    fail_if(both.finds({ kHere }) || both.finds({ kHere }) || both.finds({ kHere, other }));
  }
}

/// Two sightings of chance, however far apart, and places that move.
CHECK_TEST(test_disagreement)
{
  const std::vector<std::vector<Candidate>> between{ {}, { kChance }, { kThere } };
  for (const auto &found : between) {
    Searches searches;
    fail_if(searches.finds({ kHere }) || searches.finds(found));
    searches.now += 60 * kSecond;
    fail_if(searches.finds({ kHere }), "a minute later");
  }
  Searches searches;
  fail_if(searches.finds({ kHere }));
  searches.decision.forget();
  searches.now += 60 * kSecond;
  fail_if(searches.finds({ kHere }), "of other sound");
  Searches of_faster;
  Candidate faster = kHere; // by 2 %
  for (int i = 0; i < 20; i++, faster.step += 2.5)
    fail_if(of_faster.finds({ faster }), "another speed");
}

/// Hopes are the places of the last search, as they were found first.
CHECK_TEST(test_hopes)
{
  Searches searches;
  Candidate next = kHere;
  next.step += 2;
  fail_if(searches.finds({ kHere, kChance, scored(kThere, 3) }) || searches.finds({ next, next }));
  const auto hopes = searches.decision.hopes();
  fail_unless(hopes.size() == 1 && hopes[0].film == 1);
  fail_unless_equals_float(hopes[0].step, kHere.step);
}

CHECK_MAIN(decision)
