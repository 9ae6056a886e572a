// SPDX-License-Identifier: LGPL-2.1-or-later
#include "steering.h"

#include "decode.h"
#include "film_cases.h"
#include "tactile/cue_limiter.h"
#include "tactile/density.h"
#include "tactile/viewport.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace quality {

namespace {

using namespace std::chrono_literals;

constexpr std::array kPatterns{ tactile::FilmPattern::static_motion,
                                tactile::FilmPattern::dynamic_motion };
const cv::Size kSize(320, 240);

/// The tuned model with cue limits.
class LimitedModel : public Model
{
public:
  explicit LimitedModel(const tactile::CueLimits &limits) : Model("limited"), limits_(limits)
  {
  }

  void frame(const Frame &frame, Time time, Time duration, tactile::TactileMap &map) override
  {
    model_->frame(frame, time, duration, map);
    limiter_.limit(map, time, limits_);
  }

private:
  std::unique_ptr<Model> model_ = tuned_model();
  tactile::CueLimiter limiter_;
  tactile::CueLimits limits_;
};

/// The tuned model with an adaptive viewport.
class AdaptiveModel : public Model
{
public:
  AdaptiveModel() : Model("adaptive")
  {
  }

  void frame(const Frame &frame, Time time, Time duration, tactile::TactileMap &map) override
  {
    const auto &found = model_->frame(frame.view(), time, duration, map);
    if (found.cut)
      viewport_.reset();
    const auto mapping = tactile::MappingSettings::tuned();
    const auto view = view_of(found);
    tactile::map_saliency(view, mapping, map,
                          viewport_.follow(view, mapping.floor, mapping.threshold, time));
  }

private:
  std::unique_ptr<AnalyzerModel> model_ = tuned_model();
  tactile::AdaptiveViewport viewport_;
};

std::size_t
strongest(const tactile::TactileMap &map)
{
  return static_cast<std::size_t>(std::ranges::max_element(map.levels) - map.levels.begin());
}

/// For active frames, whether both have the same strongest cell.
Mean
agreement(const FilmCase &film_case)
{
  Mean same;
  for (int seed = 1; seed <= film_case.seeds; ++seed) {
    const auto film = film_case.make(static_cast<std::uint64_t>(seed));
    const auto fixed = tuned_model();
    AdaptiveModel adaptive;
    Frame frame(film_case.size);
    tactile::TactileMap one(3, 3);
    tactile::TactileMap other(3, 3);
    const Time second = 1s;
    for (int i = 0; i < static_cast<int>(film_case.seconds * film_case.fps); ++i) {
      const Time time = i * second / film_case.fps;
      film->draw(time, frame);
      static_cast<Model &>(*fixed).frame(frame, time, second / film_case.fps, one);
      adaptive.frame(frame, time, second / film_case.fps, other);
      if (*std::ranges::max_element(one.levels) > 0)
        same.add(strongest(one) == strongest(other));
    }
  }
  return same;
}

} // namespace

Table
cue_limit_table(int threads)
{
  constexpr std::array<std::pair<Time, Time>, 7> kLimits{
    { { 0s, 0s }, { 0s, 500ms }, { 0s, 1s }, { 2s, 0s }, { 1s, 0s }, { 1s, 500ms }, { 500ms, 0s } }
  };
  std::vector<FilmCase> cases;
  for (const auto pattern : kPatterns) {
    FilmCase film = ball_case(pattern, kSize, 30, 0);
    for (const auto &[longest, refractory] : kLimits) {
      const tactile::CueLimits limits{ longest, refractory };
      film.models.emplace_back([limits] { return std::make_unique<LimitedModel>(limits); });
    }
    cases.push_back(film);
  }
  const auto scores = score_films(cases, threads, "cues");
  Table table(
      "Limits to cues",
      "What limits to a cue's length do to the paper's films; columns as in the first table.",
      { "max-cue-duration, s", "cue-refractory, s", "(a) static", "(a) dynamic",
        "(d) dynamic, frames", "tactors felt, static", "tactors felt, dynamic" });
  const auto seconds = [](Time time) {
    return figure(std::chrono::duration<double>(time).count(), 1);
  };
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    const Scores &still = scores[0][i].scores;
    const Scores &dynamic = scores[1][i].scores;
    table.add({ seconds(kLimits[i].first), seconds(kLimits[i].second),
                figure(still.strongest.value(), 3), figure(dynamic.strongest.value(), 3),
                figure(dynamic.delay.value(), 2), figure(still.cells.value() / 9, 3),
                figure(dynamic.cells.value() / 9, 3) });
  }
  return table;
}

Table
viewport_table(int threads)
{
  std::vector<FilmCase> cases;
  for (const auto pattern : kPatterns) {
    FilmCase film = ball_case(pattern, kSize, 30, 0);
    film.models = { tuned_model, [] {
                     return std::make_unique<AdaptiveModel>();
                   } };
    cases.push_back(film);
  }
  const auto scores = score_films(cases, threads, "viewports");
  Table table("The viewport that adapts",
              "How often viewport=adaptive has the strongest cell that the whole picture has.",
              { "film", "strongest cell is the fixed viewport's", "(a) fixed", "(a) adaptive" });
  for (std::size_t i = 0; i < cases.size(); ++i)
    table.add({ cases[i].film, percent(agreement(cases[i]).value()),
                figure(scores[i][0].scores.strongest.value(), 3),
                figure(scores[i][1].scores.strongest.value(), 3) });
  return table;
}

Table
density_table(const std::filesystem::path &directory)
{
  constexpr std::array kDensities{ 0.0, 0.5, 0.25, 0.1 };
  Table table("Density",
              "How much of the time the films in clips/ are felt, and the longest stretch in "
              "seconds, with `density`.",
              { "clip", "off", "longest", "0.5", "longest", "0.25", "longest", "0.1", "longest" });
  for (const auto &file : list_films(directory)) {
    const auto model = tuned_model();
    tactile::MappingSettings mapping = tactile::MappingSettings::tuned();
    const double floor = mapping.floor;
    struct Run
    {
      tactile::DensityControl control;
      Time felt{ 0 };
      Time stretch{ 0 };
      Time longest{ 0 };
    };
    std::array<Run, kDensities.size()> runs;
    Time length{ 0 };
    tactile::TactileMap map(3, 3);
    Decoder clip(file, "decodebin", "I420");
    while (clip.next()) {
      const auto view = view_of(model->frame(clip.view(), clip.time(), clip.duration(), map));
      length += clip.duration();
      for (std::size_t i = 0; i < runs.size(); ++i) {
        Run &run = runs[i];
        mapping.floor = run.control.follow(view, floor, kDensities[i], clip.time());
        tactile::map_saliency(view, mapping, map);
        const bool is_felt = *std::ranges::max_element(map.levels) > 0;
        run.felt += is_felt ? clip.duration() : 0s;
        run.stretch = is_felt ? run.stretch + clip.duration() : 0s;
        run.longest = std::max(run.longest, run.stretch);
      }
    }
    std::vector<std::string> row{ file.filename().string() };
    for (const Run &run : runs) {
      using Seconds = std::chrono::duration<double>;
      row.push_back(percent(Seconds(run.felt) / Seconds(length)));
      row.push_back(figure(Seconds(run.longest).count(), 1));
    }
    table.add(row);
  }
  return table;
}

} // namespace quality
