// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/decision.h"

#include "listen/onsets.h"

#include <algorithm>
#include <cmath>

namespace listen {

namespace {

// Scores. Chance reaches 4.6 in one of ten searches, 5.3 in one of a hundred, 6.1 in one of 2000.
constexpr double kSure = 6.6;
constexpr double kLikely = 5.4;                              ///< if it is so for a while
constexpr std::int64_t kAWhile = 3 * Onsets::kOnsetRate / 2; ///< steps: 1.5 s
constexpr double kAlike = 0.8; ///< of the best one: another place is as good

} // namespace

bool
Candidate::is_at(const Candidate &other) const
{
  return film == other.film && rate == other.rate && std::abs(step - other.step) <= kSame;
}

std::optional<Candidate>
Decision::take(std::span<const Candidate> found, std::int64_t now)
{
  const auto best = std::ranges::max_element(found, {}, &Candidate::score);
  const bool is_likely = best != found.end() && best->score >= kLikely
                         && std::ranges::none_of(found, [&](const Candidate &one) {
                              return !one.is_at(*best) && one.score > kAlike * best->score;
                            });
  if (!is_likely) {
    hope_.reset();
    return std::nullopt;
  }
  if (!hope_ || !hope_->candidate.is_at(*best))
    hope_ = Hope{ .candidate = *best, .since = now };
  if (best->score < kSure && now - hope_->since < kAWhile)
    return std::nullopt;
  hope_.reset();
  return *best;
}

} // namespace listen
