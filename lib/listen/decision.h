// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace listen {

/// Looks at one place differ by less, in steps.
inline constexpr double kSame = 3;

/// A place that a search found.
struct Candidate
{
  std::size_t film = 0;
  double rate = 1;
  double step = 0; ///< of the film, at step 0 of the sound
  double score = 0;
  bool is_at(const Candidate &other) const;
};

/// Decides whether the film is at one of the places that searches find. A place is believed if its
/// score is high and that of all others is lower, and if the sound that was heard since it was
/// found first fits as well: this sound had no part in the choice of the place. A very high score
/// that stands alone is believed at once. Reads no clock.
class Decision
{
public:
  /// The score at a place of the sound since a step alone.
  using Newer = std::function<double(const Candidate &place, std::int64_t since)>;

  /// The places of a search of the sound up to step `now`.
  std::optional<Candidate> take(std::span<const Candidate> found, std::int64_t now,
                                const Newer &newer);
  /// Places of the last search that may be believed later, as they were found first.
  std::vector<Candidate> hopes() const;
  void forget()
  {
    hopes_.clear();
  }

private:
  struct Hope
  {
    Candidate candidate;
    std::int64_t since = 0; ///< step
  };
  std::vector<Hope> hopes_;
};

} // namespace listen
