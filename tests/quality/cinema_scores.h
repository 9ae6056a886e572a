// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"
#include "estimate.h"
#include "film_scores.h"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace quality {

/// How one film is felt, as shares.
struct CinemaScores
{
  Mean phantoms;      ///< felt: frames in which nothing is to be felt
  Mean right;         ///< strongest cell expected: frames felt, but not where anything may be
  Mean found;         ///< felt in an expected cell within 0.5 s: events
  Mean told;          ///< some frame is right: whole seconds in which something is to be felt
  double longest = 0; ///< longest stretch of phantoms, s
};

/// Compares what is felt of a film with what is expected.
class CinemaJudge
{
public:
  /// The next frame, shown during [time, time + duration). `map` is 3 × 3.
  void frame(const Expected &expected, Time time, Time duration, const tactile::TactileMap &map);

  const CinemaScores &scores() const
  {
    return scores_;
  }

private:
  CinemaScores scores_;
  int events_ = 0;
  Time event_{ 0 };
  bool found_ = true; ///< the last event
  std::optional<Time> phantoms_since_;
  std::optional<Time> second_since_; ///< in which something is to be felt
  bool told_ = false;
};

/// Limits of the shares; infinite where there are none.
struct CinemaLimits
{
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double phantoms = kNone; ///< at most
  double right = -kNone;   ///< at least, like the others
  double found = -kNone;
  double told = -kNone;
};

/// Films of one kind.
struct CinemaCase
{
  std::string film;
  std::function<std::unique_ptr<CinemaFilm>(std::uint64_t seed)> make;
  CinemaLimits target{};
  CinemaLimits floor{}; ///< what the tuned profile is held to
  int fps = 30;
  double noise = 2; ///< σ in 8-bit codes
};

/// The scores of films with seeds 1, 2, …, `seeds` of each case: by case, by seed. `threads` ≥ 1
/// share them, and the result does not depend on their number. `what`: see in_parallel().
std::vector<std::vector<CinemaScores>> score_cinema(const std::vector<CinemaCase> &cases,
                                                    cv::Size size, int seeds,
                                                    const ModelMaker &model, int threads,
                                                    const char *what);

} // namespace quality
