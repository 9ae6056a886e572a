// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_scores.h"

#include "parallel.h"

#include <algorithm>

namespace quality {

namespace {

CinemaScores
score(const CinemaCase &one, cv::Size size, std::uint64_t seed, const ModelMaker &make_model)
{
  const auto film = one.make(seed);
  const auto model = make_model();
  const tactile::SensorNoise noise(one.noise, seed);
  CinemaJudge judge;
  Frame frame(size);
  cv::Mat bgr;
  tactile::TactileMap map(3, 3);
  const Time second = std::chrono::seconds(1);
  for (int i = 0; i * second / one.fps < kCinemaLength; ++i) {
    const Time time = i * second / one.fps;
    const Time duration = (i + 1) * second / one.fps - time;
    const Expected expected = film->draw(time, bgr);
    frame.draw(bgr);
    frame.add_noise(noise, time);
    model->frame(frame, time, duration, map);
    judge.frame(expected, time, duration, map);
  }
  return judge.scores();
}

} // namespace

void
CinemaJudge::frame(const Expected &expected, Time time, Time duration,
                   const tactile::TactileMap &map)
{
  constexpr Time kPrompt = std::chrono::milliseconds(500);
  constexpr Time kSecond = std::chrono::seconds(1);
  const auto strongest = std::ranges::max_element(map.levels);
  const bool felt = *strongest > 0;
  const bool right
      = felt && expected.cells[static_cast<std::size_t>(strongest - map.levels.begin())];

  const bool quiet = expected.verdict == Verdict::quiet;
  if (quiet)
    scores_.phantoms.add(felt);
  if (!quiet || !felt)
    phantoms_since_.reset();
  else if (!phantoms_since_)
    phantoms_since_ = time;
  if (phantoms_since_)
    scores_.longest = std::max(
        scores_.longest, std::chrono::duration<double>(time + duration - *phantoms_since_).count());
  if (felt && !expected.cells.all())
    scores_.right.add(right);

  if (expected.events > events_) {
    scores_.found.count += 1;
    event_ = time;
    found_ = false;
  }
  events_ = expected.events;
  bool there = false;
  for (std::size_t i = 0; i < map.levels.size(); ++i)
    there |= expected.cells[i] && map.levels[i] > 0;
  if (!found_ && there && time - event_ <= kPrompt) {
    found_ = true;
    scores_.found.sum += 1;
  }

  if (expected.verdict != Verdict::felt) {
    second_since_.reset();
    return;
  }
  if (!second_since_) {
    second_since_ = time;
    told_ = false;
  }
  told_ |= right;
  if (time + duration - *second_since_ >= kSecond - Time(1)) {
    scores_.told.add(told_);
    second_since_.reset();
  }
}

std::vector<std::vector<CinemaScores>>
score_cinema(const std::vector<CinemaCase> &cases, cv::Size size, int seeds,
             const ModelMaker &model, int threads, const char *what)
{
  const auto per_case = static_cast<std::size_t>(seeds);
  std::vector<std::vector<CinemaScores>> scores(cases.size(), std::vector<CinemaScores>(per_case));
  in_parallel(
      threads, cases.size() * per_case,
      [&](std::size_t i) {
        const std::size_t seed = i % per_case;
        scores[i / per_case][seed] = score(cases[i / per_case], size, seed + 1, model);
      },
      what);
  return scores;
}

} // namespace quality
