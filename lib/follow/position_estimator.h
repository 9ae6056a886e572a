// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/evidence.h"
#include "follow/report.h"

#include <cstdint>
#include <optional>

namespace follow {

/// Estimates the position of a player's film from reports that are late, rounded, jittery and
/// sometimes wrong.
///
/// A report that does not fit the earlier ones is a leap or an error: the position is unknown until
/// the next report decides, unless the report itself notifies a leap (Report::sought, another film,
/// another rate). It is also unknown without reports, with an error above Settings::most_error, and
/// while the player goes backwards.
///
/// Within a stretch, the position never decreases: it approaches a better estimate by playing up to
/// a fifth faster or slower. Reads no clock; not thread-safe.
class PositionEstimator
{
public:
  struct Settings
  {
    Habits habits{};
    Time most_error = std::chrono::milliseconds(120);
  };

  /// The position at a moment.
  struct Estimate
  {
    Time position{ 0 }; ///< film time
    Time error{ 0 };    ///< the largest one
    double rate = 1;    ///< film seconds a second; 0: the film stands still
    /// Another number after each leap and change of rate, where the film continues elsewhere.
    std::uint64_t stretch = 0;
  };

  /// Reports beyond these limits are skipped.
  static constexpr Time kLongestFilm = std::chrono::hours(100);
  static constexpr double kLeastRate = 1.0 / 16;
  static constexpr double kMostRate = 16;
  /// Share of the rate by which the position approaches a better estimate.
  static constexpr double kMostCorrection = 0.2;
  /// A report with a smaller misfit is late or a little wrong, and alone changes nothing.
  static constexpr Time kLeap = std::chrono::milliseconds(150);
  /// A shorter seek only corrects the position: the stretch continues.
  static constexpr Time kPutRight = std::chrono::milliseconds(50);

  PositionEstimator() = default;
  explicit PositionEstimator(const Settings &settings);

  /// Reports in order of their local times; one from before the last position is too old.
  void report(const Report &report);

  /// At a local time not before the last report; none: unknown.
  std::optional<Estimate> at(Time now) const;

  /// End of the time for which at() is known without further reports; none: unknown, or the film
  /// stands.
  std::optional<Time> known_until() const;

  /// Whether the next report decides something, so that a query at once helps.
  bool asks_again() const;

private:
  /// The position of at() at the last report.
  struct Anchor
  {
    Time at{ 0 };
    Time position{ 0 };
  };

  void forget();
  void stand(const Report &report);
  void wait(const Report &report);
  void start(const Report &report, std::optional<Estimate> before);
  void follow(const Report &report);
  void doubt(const Report &report);
  bool stands_still(const Report &report) const;
  Report with_position(const Report &report, const std::optional<Estimate> &before) const;
  void count_span(Time received);
  Time told(Time now) const;

  Settings settings_;
  std::string film_;
  std::optional<Time> stands_;       ///< the film stands still here
  std::optional<Evidence> evidence_; ///< of the stretch that plays
  std::optional<Evidence> doubt_;    ///< of reports that do not fit it
  bool leapt_ = false;               ///< doubt_ is far from evidence_
  Anchor anchor_;
  std::uint64_t stretch_ = 0;
  Time last_{ 0 };  ///< local time of the last report with a position
  Time alive_{ 0 }; ///< of the last one with a position, or that the film plays on
  std::optional<Time> last_position_{}; ///< as reported
  Time last_change_{ 0 };               ///< local time of its first report
  std::deque<Time> spans_;              ///< between those
};

} // namespace follow
