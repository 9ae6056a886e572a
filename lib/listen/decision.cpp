// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/decision.h"

#include "listen/onsets.h"

#include <algorithm>
#include <cmath>

namespace listen {

namespace {

// Scores. Chance reaches 4.6 in one of ten searches, 5.3 in one of a hundred, 6.1 in one of 2000.
constexpr double kHopeful = 4.4;
constexpr double kSure = 6;
constexpr double kNewSure = 3;                    ///< of the newer sound, at this place
constexpr std::int64_t kNew = Onsets::kOnsetRate; ///< steps: 1 s
constexpr double kCertain = 7;                    ///< without newer sound, if it stands alone
// Shares of the best score: another place that reaches one is as good.
constexpr double kAlike = 0.8;
constexpr double kRepeated = 0.75; ///< of the same film, as where music repeats itself
constexpr double kAlone = 0.6;     ///< of any film
constexpr std::size_t kMostHopes = 12;

} // namespace

bool
Candidate::is_at(const Candidate &other) const
{
  return film == other.film && rate == other.rate && std::abs(step - other.step) <= kSame;
}

std::optional<Candidate>
Decision::take(std::span<const Candidate> found, std::int64_t now, const Newer &newer)
{
  std::vector<Candidate> sorted(found.begin(), found.end());
  std::ranges::sort(sorted, std::ranges::greater(), &Candidate::score);
  std::vector<Hope> hopes;
  for (const Candidate &one : sorted) {
    if (one.score < kHopeful || hopes.size() == kMostHopes)
      break;
    const auto is_here = [&](const Hope &hope) {
      return hope.candidate.is_at(one);
    };
    if (std::ranges::any_of(hopes, is_here))
      continue;
    const auto known = std::ranges::find_if(hopes_, is_here);
    hopes.push_back(known != hopes_.end() ? *known : Hope{ .candidate = one, .since = now });
  }
  hopes_ = std::move(hopes);
  if (hopes_.empty() || sorted.front().score < kSure)
    return std::nullopt;
  const Candidate &best = sorted.front();
  double other = 0;
  double same_film = 0;
  for (const Candidate &one : sorted)
    if (!one.is_at(best)) {
      other = std::max(other, one.score / best.score);
      if (one.film == best.film)
        same_film = std::max(same_film, one.score / best.score);
    }
  if (other > kAlike || same_film > kRepeated)
    return std::nullopt;
  const Hope &first = hopes_.front(); // of the best
  if ((best.score < kCertain || other > kAlone)
      && (now - first.since < kNew || newer(first.candidate, first.since) < kNewSure))
    return std::nullopt;
  hopes_.clear();
  return best;
}

std::vector<Candidate>
Decision::hopes() const
{
  std::vector<Candidate> places;
  for (const Hope &hope : hopes_)
    places.push_back(hope.candidate);
  return places;
}

} // namespace listen
