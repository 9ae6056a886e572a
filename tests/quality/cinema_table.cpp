// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_table.h"

#include "cinema_light.h"
#include "cinema_scores.h"
#include "cinema_talk.h"
#include "cinema_textures.h"
#include "cinema_titles.h"
#include "cinema_travel.h"
#include "photographs.h"
#include "pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace quality {

namespace {

const cv::Size kSize{ 640, 360 };
constexpr CinemaLimits kTravels{ .phantoms = 0.1 };
constexpr CinemaLimits kMoves{ .right = 0.85, .found = 0.9 };
constexpr CinemaLimits kLight{ .phantoms = 0.02 };
constexpr CinemaLimits kStirs{ .phantoms = 0.05 };
constexpr CinemaLimits kTalks{ .told = 0.8 };

using Pictures = std::shared_ptr<const std::vector<cv::Mat>>;

Pictures
leaves()
{
  std::vector<cv::Mat> pictures;
  for (const std::uint64_t seed : { 11, 12, 13, 14, 15 })
    pictures.push_back(dead_leaves(kSize * 2, seed));
  return std::make_shared<const std::vector<cv::Mat>>(std::move(pictures));
}

const cv::Mat &
picture_of(const Pictures &pictures, std::uint64_t seed)
{
  return (*pictures)[seed % pictures->size()];
}

void
add_travels(std::vector<CinemaCase> &cases, const Pictures &pictures, const std::string &where = "")
{
  struct Scene
  {
    const char *film;
    Travel travel;
    Mover mover;
    CinemaLimits floor{};
    int fps = 30;
  };
  const Scene scenes[] = {
    { "truck", Travel::truck, Mover::none },
    { "truck, 24 fps", Travel::truck, Mover::none, {}, 24 },
    { "dolly", Travel::dolly, Mover::none },
    { "hand-held walk", Travel::walk, Mover::none },
    { "pan with parallax", Travel::pan, Mover::none },
    { "truck, people walk across", Travel::truck, Mover::across },
    { "truck, people walk across, 24 fps", Travel::truck, Mover::across, {}, 24 },
    { "dolly, people walk across", Travel::dolly, Mover::across, { .right = 0.7, .found = 0.8 } },
    { "dolly, people walk to or fro", Travel::dolly, Mover::heading },
    { "walk, people walk across", Travel::walk, Mover::across },
    { "pan, people walk across", Travel::pan, Mover::across },
    { "truck, things appear", Travel::truck, Mover::appears },
    { "dolly, things appear", Travel::dolly, Mover::appears },
    { "walk, things appear", Travel::walk, Mover::appears },
    { "pan, things appear", Travel::pan, Mover::appears },
  };
  for (const Scene &scene : scenes) {
    // Of photographs, the plainest and the hardest.
    if (!where.empty()
        && (scene.fps != 30 || (scene.travel != Travel::truck && scene.travel != Travel::walk)
            || scene.mover == Mover::appears))
      continue;
    CinemaCase one;
    one.film = scene.film + where;
    one.make = [=](std::uint64_t seed) {
      return travelling_film(
          { .travel = scene.travel, .mover = scene.mover, .size = kSize, .seed = seed }, *pictures);
    };
    one.target = scene.mover == Mover::none ? kTravels : kMoves;
    one.floor = scene.floor;
    one.fps = scene.fps;
    cases.push_back(one);
  }
}

void
add_light(std::vector<CinemaCase> &cases, const Pictures &pictures)
{
  struct Scene
  {
    const char *film;
    Light light;
    CinemaLimits floor{};
  };
  const Scene scenes[] = {
    { "dissolve", Light::dissolve },
    { "fade to black or white", Light::fade, kLight },
    { "exposure ramp", Light::exposure, kLight },
    { "flash", Light::flash, kLight },
    { "firelight", Light::glow, kLight },
    { "fire", Light::fire },
    { "fast pan", Light::fast_pan },
    { "zoom", Light::zoom, kLight },
  };
  for (const Scene &scene : scenes) {
    CinemaCase one;
    one.film = scene.film;
    one.make = [=](std::uint64_t seed) {
      return light_film(scene.light, *pictures, kSize, seed);
    };
    one.target = kLight;
    if (scene.light == Light::fire)
      one.target.found = kMoves.found;
    one.floor = scene.floor;
    cases.push_back(one);
  }
}

void
add_titles(std::vector<CinemaCase> &cases, const Pictures &pictures)
{
  struct Scene
  {
    const char *film;
    Title title;
    bool picture;
    CinemaLimits floor{};
  };
  const Scene scenes[] = {
    { "titles fade in", Title::fades, false },
    { "titles fade in over a picture", Title::fades, true, kLight },
    { "titles pop in", Title::pops, false },
    { "titles pop in over a picture", Title::pops, true, kLight },
    { "credits", Title::credits, false },
    { "credits over a picture", Title::credits, true },
  };
  for (const Scene &scene : scenes) {
    CinemaCase one;
    one.film = scene.film;
    one.make = [=](std::uint64_t seed) {
      return title_film(scene.title, scene.picture ? picture_of(pictures, seed) : cv::Mat(), kSize,
                        seed);
    };
    one.target = scene.title == Title::credits ? kStirs : kLight;
    one.floor = scene.floor;
    cases.push_back(one);
  }
}

void
add_textures(std::vector<CinemaCase> &cases, const Pictures &pictures)
{
  struct Scene
  {
    const char *film;
    Stir stir;
    CinemaLimits floor{};
  };
  const Scene scenes[] = {
    { "rain", Stir::rain, kStirs },
    { "leaves in the wind", Stir::leaves, kStirs },
    { "water", Stir::water },
    { "crowd", Stir::crowd },
    { "grain, σ 4", Stir::grain, kStirs },
    { "grain, σ 8", Stir::coarse_grain, kStirs },
  };
  for (const Scene &scene : scenes) {
    CinemaCase one;
    one.film = scene.film;
    one.make = [=](std::uint64_t seed) {
      return stirring_film(scene.stir, picture_of(pictures, seed), kSize, seed);
    };
    one.target = kStirs;
    one.floor = scene.floor;
    one.noise = scene.stir == Stir::grain || scene.stir == Stir::coarse_grain ? 0 : 2;
    cases.push_back(one);
  }
}

void
add_talks(std::vector<CinemaCase> &cases, const Pictures &pictures)
{
  for (const bool listener : { false, true }) {
    CinemaCase one;
    one.film = listener ? "one talks, one listens" : "one talks";
    one.make = [=](std::uint64_t seed) {
      return talking_film(listener, picture_of(pictures, seed), kSize, seed);
    };
    one.target = kTalks;
    one.floor = kTalks;
    cases.push_back(one);
  }
}

std::vector<CinemaCase>
cinema_cases(const Extent &extent)
{
  std::vector<CinemaCase> cases;
  const Pictures pictures = leaves();
  add_travels(cases, pictures);
  if (!extent.data.empty() && !extent.quick) {
    std::vector<cv::Mat> photographs;
    for (const char *file : { "1001.jpg", "1017.jpg", "1033.jpg", "1049.jpg" })
      photographs.push_back(read_photograph(extent.data / "osie" / file));
    add_travels(cases, std::make_shared<const std::vector<cv::Mat>>(std::move(photographs)),
                ", photographs");
  }
  add_light(cases, pictures);
  add_titles(cases, pictures);
  add_textures(cases, pictures);
  add_talks(cases, pictures);
  return cases;
}

struct CinemaShares
{
  Estimate phantoms;
  Estimate right;
  Estimate found;
  Estimate told;
  double longest;
};

CinemaShares
shares_of(const std::vector<CinemaScores> &films)
{
  const auto share = [&](Mean CinemaScores::*what) {
    std::vector<Mean> units;
    for (const CinemaScores &film : films)
      units.push_back(film.*what);
    return estimate(units);
  };
  return { share(&CinemaScores::phantoms), share(&CinemaScores::right), share(&CinemaScores::found),
           share(&CinemaScores::told),
           std::ranges::max_element(films, {}, &CinemaScores::longest)->longest };
}

std::string
text(const CinemaLimits &target)
{
  std::string all;
  const auto add = [&](const char *what, double limit) {
    if (!std::isinf(limit))
      all += (all.empty() ? "" : ", ") + std::string(what) + percent(limit, 0);
  };
  add("phantoms ≤ ", target.phantoms);
  add("right ≥ ", target.right);
  add("found ≥ ", target.found);
  add("told ≥ ", target.told);
  return all;
}

/// Films without events have no right cells.
bool
has_events(const CinemaCase &one)
{
  return !std::isinf(one.target.found) || !std::isinf(one.target.told);
}

std::vector<std::vector<CinemaScores>>
score_with_progress(const std::vector<CinemaCase> &cases, int seeds, const ModelMaker &model,
                    int threads, const char *what)
{
  auto scores = score_cinema(cases, kSize, seeds, model, threads, [&](std::size_t done) {
    std::fprintf(stderr, "\r%s: %zu of %zu", what, done,
                 cases.size() * static_cast<std::size_t>(seeds));
  });
  std::fputc('\n', stderr);
  return scores;
}

using ScoresOfCases = std::vector<std::vector<CinemaScores>>;

/// Over all films.
SummaryRow
cinema_row(const char *figure, const ScoresOfCases &tuned, const ScoresOfCases &paper,
           Mean CinemaScores::*score)
{
  UnitsByModel units;
  for (const auto &[model, cases] : { std::pair{ "tuned", &tuned }, { "paper", &paper } })
    for (const auto &films : *cases)
      for (const CinemaScores &film : films)
        units[model].push_back(film.*score);
  return summary_row("cinema scenes", figure, units);
}

} // namespace

Table
cinema_table(const Extent &extent, Summary &summary)
{
  const auto cases = cinema_cases(extent);
  const int seeds = extent.quick ? 2 : 5;
  const auto tuned
      = score_with_progress(cases, seeds, tuned_model, extent.threads, "cinema, tuned");
  const auto paper = score_with_progress(cases, 1, paper_model, extent.threads, "cinema, paper");
  summary.push_back(
      cinema_row("frames felt where nothing is to be felt", tuned, paper, &CinemaScores::phantoms));
  summary.back().higher = false;
  summary.push_back(
      cinema_row("strongest cell is what moves by itself", tuned, paper, &CinemaScores::right));
  Table table(
      "Scenes of cinema",
      "Drawn films of 12 s at 640×360 and 30 fps with noise of σ 2; " + std::to_string(seeds)
          + " seeds each [bootstrap 95 % over them], one for the paper's profile. "
            "Phantoms: share of the frames felt in which nothing is to be felt; longest: "
            "stretch of them. "
            "Right: of all frames felt, those whose strongest cell is what moves by itself. "
            "Found: onsets felt there within 0.5 s. "
            "Told: seconds with a right frame, of those in which something is to be felt.",
      { "film", "target", "phantoms", "longest, s", "right", "found", "told", "paper: phantoms",
        "right", "found", "told" });
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const CinemaShares ours = shares_of(tuned[i]);
    const CinemaShares theirs = shares_of(paper[i]);
    const bool events = has_events(cases[i]);
    const auto if_any = [&](const std::string &text) {
      return events ? text : "–";
    };
    table.add({ cases[i].film, text(cases[i].target), percent_text(ours.phantoms),
                figure(ours.longest, 1), if_any(percent_text(ours.right)),
                if_any(percent_text(ours.found)), if_any(percent_text(ours.told)),
                percent(theirs.phantoms.value, 0), if_any(percent(theirs.right.value, 0)),
                if_any(percent(theirs.found.value, 0)), if_any(percent(theirs.told.value, 0)) });
  }
  return table;
}

bool
cinema_holds(int threads)
{
  constexpr int kChecked = 2; // seeds
  auto cases = cinema_cases({});
  std::erase_if(cases, [](const CinemaCase &one) {
    const CinemaLimits &floor = one.floor;
    return std::isinf(floor.phantoms) && std::isinf(floor.right) && std::isinf(floor.found)
           && std::isinf(floor.told);
  });
  const auto scores = score_with_progress(cases, kChecked, tuned_model, threads, "check of cinema");
  bool good = true;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const CinemaShares ours = shares_of(scores[i]);
    const auto hold = [&](const char *what, double value, double limit, bool most) {
      if (std::isinf(limit) || (most ? value <= limit : value >= limit))
        return;
      std::fprintf(stderr, "tactile_quality: %s: %s is %.4f; expected at %s %.4f\n",
                   cases[i].film.c_str(), what, value, most ? "most" : "least", limit);
      good = false;
    };
    const CinemaLimits &floor = cases[i].floor;
    hold("share of phantoms", ours.phantoms.value, floor.phantoms, true);
    hold("share of right cells", ours.right.value, floor.right, false);
    hold("share found", ours.found.value, floor.found, false);
    hold("share of seconds told", ours.told.value, floor.told, false);
  }
  return good;
}

} // namespace quality
