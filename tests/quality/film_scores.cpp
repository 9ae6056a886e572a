// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_scores.h"

#include "parallel.h"

namespace quality {

namespace {

std::vector<FilmScores>
score(const FilmCase &film_case)
{
  std::vector<FilmScores> all(film_case.models.size());
  const auto frames = static_cast<int>(film_case.seconds * film_case.fps);
  const Time second = std::chrono::seconds(1);
  for (int seed = 1; seed <= film_case.seeds; ++seed) {
    const auto film = film_case.make(static_cast<std::uint64_t>(seed));
    const tactile::SensorNoise noise(film_case.noise, static_cast<std::uint64_t>(seed));
    std::vector<std::unique_ptr<Model>> models;
    std::vector<Judge> judges;
    for (std::size_t m = 0; m < all.size(); ++m) {
      models.push_back(film_case.models[m]());
      all[m].model = models[m]->name();
      judges.emplace_back(all[m].films.emplace_back(), film_case.size);
    }
    Frame frame(film_case.size);
    tactile::TactileMap map(3, 3);
    for (int i = 0; i < frames; ++i) {
      const Time time = i * second / film_case.fps;
      const Time duration = (i + 1) * second / film_case.fps - time;
      const auto balls = film->draw(time, frame);
      frame.add_noise(noise, time);
      for (std::size_t m = 0; m < all.size(); ++m) {
        models[m]->frame(frame, time, duration, map);
        judges[m].frame(*film, time, balls, map);
        all[m].films.back().camera.add(models[m]->camera_moves());
      }
    }
    for (std::size_t m = 0; m < all.size(); ++m) {
      judges[m].finish();
      all[m].scores.add(all[m].films.back());
    }
  }
  return all;
}

} // namespace

std::vector<std::vector<FilmScores>>
score_films(const std::vector<FilmCase> &cases, int threads, const char *what)
{
  std::vector<std::vector<FilmScores>> scores(cases.size());
  in_parallel(
      threads, cases.size(), [&](std::size_t i) { scores[i] = score(cases[i]); }, what);
  return scores;
}

} // namespace quality
