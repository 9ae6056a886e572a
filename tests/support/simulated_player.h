// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A player whose position is known exactly, and what it reports of it.
#pragma once

#include "follow/report.h"
#include "random.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

/// A film that somebody watches. Its position is that of formulas, not of an estimate.
class WatchedFilm
{
public:
  using Time = follow::Time;

  /// From a local time on.
  struct Stretch
  {
    Time begin{ 0 };
    Time position{ 0 };
    double rate = 1; ///< as the player says it
    follow::Doing doing = follow::Doing::playing;
    bool sought = false; ///< it begins with a seek
  };

  /// It plays from `position` on at local time `begin`. The player's clock runs by (1 + `skew`).
  WatchedFilm(Time begin, Time position, double skew)
      : skew_(skew), stretches_{ { .begin = begin, .position = position } }
  {
  }

  // In order of local times
  WatchedFilm &seek(Time at, Time to)
  {
    Stretch next = stretches_.back();
    next.begin = at;
    next.position = to;
    next.sought = true;
    stretches_.push_back(next);
    return *this;
  }
  WatchedFilm &change(Time at, follow::Doing doing, double rate = 1)
  {
    stretches_.push_back({ .begin = at, .position = position(at), .rate = rate, .doing = doing });
    return *this;
  }

  const Stretch &stretch(Time at) const
  {
    const auto after = std::ranges::upper_bound(stretches_, at, {}, &Stretch::begin);
    return after == stretches_.begin() ? *after : *std::prev(after);
  }
  Time position(Time at) const
  {
    const Stretch &now = stretch(at);
    if (now.doing != follow::Doing::playing)
      return now.position;
    return now.position
           + Time(std::llround(now.rate * (1 + skew_)
                               * static_cast<double>((at - now.begin).count())));
  }
  const std::vector<Stretch> &stretches() const
  {
    return stretches_;
  }

private:
  double skew_;
  std::vector<Stretch> stretches_;
};

/// How a simulated player tells its position.
struct Telling
{
  follow::Time every{ 0 }; ///< between reports
  double unsteady = 0;     ///< of `every`, from report to report
  follow::Time delay{ 0 }; ///< mean of exponential delays, each way where it is asked
  double hiccups = 0;      ///< share of reports that come up to `hiccup` later
  follow::Time hiccup{ 0 };
  follow::Time coarseness{ 0 }; ///< rounds down to multiples of this
  bool asked = false;
  bool tells_seeks = false;
  double wrong = 0; ///< share of reports that are off by up to `off`, either way
  follow::Time off{ 0 };
};

/// All reports from the film's beginning until a local time, in order of receipt.
inline std::vector<follow::Report>
reports_of(const WatchedFilm &film, const Telling &telling, follow::Time until, std::uint64_t seed)
{
  using follow::Time;
  visuotactile::Random random(seed);
  const auto part = [](Time whole, double share) {
    return Time(std::llround(static_cast<double>(whole.count()) * share));
  };
  const auto delay = [&] {
    Time late = part(telling.delay, -std::log(random.uniform(1e-9, 1)));
    if (random.uniform(0, 1) < telling.hiccups)
      late += part(telling.hiccup, random.uniform(0, 1));
    return late;
  };
  std::vector<follow::Report> reports;
  const WatchedFilm::Stretch *last = nullptr;
  for (Time at = film.stretches().front().begin; at < until;
       at += part(telling.every, 1 + random.uniform(-telling.unsteady, telling.unsteady))) {
    const Time read = telling.asked ? at + delay() : at;
    const WatchedFilm::Stretch &now = film.stretch(read);
    Time position = film.position(read);
    if (telling.coarseness > Time(0))
      position -= position % telling.coarseness;
    if (random.uniform(0, 1) < telling.wrong)
      position = std::max(Time(0), position + part(telling.off, random.uniform(-1, 1)));
    follow::Report report{ .received = read + delay(),
                           .position = position,
                           .doing = now.doing,
                           .rate = now.rate,
                           .film = "film" };
    if (telling.asked)
      report.asked = at;
    report.sought = telling.tells_seeks && last != &now && now.sought;
    last = &now;
    reports.push_back(report);
  }
  std::ranges::stable_sort(reports, {}, &follow::Report::received);
  return reports;
}

/// As mpv tells it: each frame, soon after it, and now and then late.
inline Telling
told_by_frame()
{
  using namespace std::chrono_literals;
  return { .every = std::chrono::nanoseconds(41'708'333),
           .delay = 2ms,
           .hiccups = 0.05,
           .hiccup = 40ms,
           .tells_seeks = true };
}

/// As MPRIS tells it: asked a few times a second.
inline Telling
told_when_asked(follow::Time every)
{
  using namespace std::chrono_literals;
  return { .every = every,
           .unsteady = 0.3,
           .delay = 3ms,
           .hiccups = 0.05,
           .hiccup = 60ms,
           .asked = true,
           .tells_seeks = true };
}

/// As Kodi tells it: asked about once a second, in whole seconds, and nothing of seeks.
inline Telling
told_in_seconds()
{
  using namespace std::chrono_literals;
  return { .every = 1s,
           .unsteady = 0.5,
           .delay = 3ms,
           .hiccups = 0.05,
           .hiccup = 60ms,
           .coarseness = 1s,
           .asked = true };
}
