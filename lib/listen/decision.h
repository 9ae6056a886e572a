// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

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

/// Decides whether the film is at one of the places that searches find. A high score is believed at
/// once, a lower one if all searches of a while agree. Reads no clock.
class Decision
{
public:
  /// The places of a search of the sound up to step `now`.
  std::optional<Candidate> take(std::span<const Candidate> found, std::int64_t now);
  void forget()
  {
    hope_.reset();
  }

private:
  struct Hope
  {
    Candidate candidate;
    std::int64_t since = 0; ///< step
  };
  std::optional<Hope> hope_;
};

} // namespace listen
