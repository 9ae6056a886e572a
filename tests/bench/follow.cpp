// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How exactly the position of a player's film is known from its reports, simulated for two hours,
// and what others' methods make of the same reports. As Markdown.
#include "follow/position_estimator.h"

#include "support/follow_peers.h"
#include "support/simulated_player.h"

#include <cstdio>
#include <string>

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr Time kBegin = 100s;
constexpr Time kLength = 2h;
constexpr Time kStep = 10ms;
constexpr Time kSettling = 3s; ///< after each seek, pause or change of rate

struct Errors
{
  std::vector<double> ms{};

  void add(Time error)
  {
    ms.push_back(std::abs(static_cast<double>(error.count()) / 1e6));
  }
  double quantile(double share)
  {
    std::ranges::sort(ms);
    return ms.empty() ? 0
                      : ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
  std::string row()
  {
    char text[64];
    std::snprintf(text, sizeof text, "%.1f / %.1f", quantile(0.5), quantile(0.95));
    return text;
  }
};

/// Somebody seeks, pauses and plays faster, every minute or so.
WatchedFilm
restless(double skew)
{
  WatchedFilm film(kBegin, 0s, skew);
  visuotactile::Random random(7);
  for (Time at = kBegin + 60s; at < kBegin + kLength; at += 60s) {
    if (random.below(3) == 0) {
      film.change(at, Doing::paused);
      film.change(at + 5s, Doing::playing, random.below(2) ? 1 : 1.25);
    } else {
      film.seek(at, std::chrono::milliseconds(random.below(7'000'000)));
    }
  }
  return film;
}

void
print_row(const char *name, const WatchedFilm &film, const Telling &telling, const char *watched)
{
  PositionEstimator estimator({ .habits = { .coarseness = telling.coarseness } });
  MedianOfOffsets median;
  ThirdOfTheWay third;
  Errors ours;
  Errors medians;
  Errors thirds;
  std::size_t asked = 0;
  const std::vector<Report> reports = reports_of(film, telling, kBegin + kLength, 3);
  Time now = kBegin;
  for (const Report &report : reports) {
    for (; now < report.received; now += kStep) {
      const WatchedFilm::Stretch &stretch = film.stretch(now);
      if (stretch.doing != Doing::playing || now < stretch.begin + kSettling)
        continue;
      const Time truth = film.position(now);
      asked++;
      if (const auto estimate = estimator.at(now); estimate && estimate->rate > 0)
        ours.add(estimate->position - truth);
      medians.add(median.at(now) - truth);
      thirds.add(third.at(now) - truth);
    }
    estimator.report(report);
    median.report(report);
    third.report(report);
  }
  std::printf("| %s | %s | %s | %.1f %% | %s | %s |\n", name, watched, ours.row().c_str(),
              100 * static_cast<double>(ours.ms.size()) / static_cast<double>(asked),
              medians.row().c_str(), thirds.row().c_str());
}

} // namespace

int
main()
{
  std::printf("| reports | watched | error | known | median of offsets | a third of the way |\n"
              "|---|---|---|---|---|---|\n");
  const struct
  {
    const char *name;
    Telling telling;
  } kinds[] = { { "each frame (mpv)", told_by_frame() },
                { "asked four times a second (MPRIS)", told_when_asked(250ms) },
                { "asked once a second (MPRIS)", told_when_asked(1s) },
                { "asked once a second, in whole seconds (Kodi)", told_in_seconds() } };
  for (const auto &[name, telling] : kinds) {
    print_row(name, WatchedFilm(kBegin, 0s, 200e-6), telling, "+200 ppm");
    print_row(name, WatchedFilm(kBegin, 0s, -200e-6), telling, "−200 ppm");
    print_row(name, restless(50e-6), telling, "restlessly");
  }
}
