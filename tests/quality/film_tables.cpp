// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_tables.h"

#include "choices.h"
#include "photographs.h"
#include "pictures.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace quality {

namespace {

std::vector<ModelMaker>
our_models()
{
  return { paper_model, tuned_model };
}

/// For one case: models of the same peer share its maps, all of them the rarity.
std::vector<ModelMaker>
peer_models(bool weighted_too)
{
  std::vector<ModelMaker> models;
  const auto rarity = std::make_shared<RarityMaps>();
  for (const Peer peer : kPeers) {
    if (!is_available(peer))
      continue;
    const auto maps = std::make_shared<PeerMaps>(peer);
    models.emplace_back([maps] { return peer_model(maps); });
    if (weighted_too)
      models.emplace_back([=] { return peer_model(maps, rarity); });
  }
  return models;
}

/// The least or the most of what is a number; NaN of nothing.
class Worst
{
public:
  explicit Worst(bool least) : least_(least)
  {
  }
  void add(double value)
  {
    if (std::isnan(value_) || (least_ ? value < value_ : value > value_))
      value_ = value;
  }
  double value() const
  {
    return value_;
  }

private:
  bool least_;
  double value_ = std::nan("");
};

/// Of the films of one size, for one model.
struct WorstScores
{
  Worst strongest{ true };
  Worst energy{ true };
  Worst silent{ true };
  Worst delay{ false };
  Worst pair{ true };

  void add(const Scores &s)
  {
    strongest.add(s.strongest.value());
    energy.add(s.energy.value());
    silent.add(s.silent.value());
    delay.add(s.delay.value());
    pair.add(s.pair.value());
  }
};

void
note(std::vector<std::string> &names, const std::string &name)
{
  if (std::ranges::find(names, name) == names.end())
    names.push_back(name);
}

/// The share felt, for each model of the kind of film of which it is largest. An object that comes
/// in is no disturbance.
SummaryRow
worst_disturbance(const std::map<std::string, UnitsByModel> &felt)
{
  UnitsByModel worst;
  std::map<std::string, double> most;
  for (const Disturbance disturbance : kDisturbances)
    if (const auto films = felt.find(name(disturbance)); films != felt.end())
      for (const auto &[model, means] : films->second) {
        const double share = estimate(means).value;
        if (const auto [known, first] = most.try_emplace(model, share);
            !first && share <= known->second)
          continue;
        most[model] = share;
        worst[model] = means;
      }
  SummaryRow row = summary_row("nothing happens", "frames felt, worst kind of film", worst);
  row.higher = false;
  return row;
}

/// Films for all have one length, so that a row of the summary compares the same.
std::vector<FilmCase>
ball_cases(const Extent &extent)
{
  std::vector<FilmCase> cases;
  for (const cv::Size size : { cv::Size(320, 240), cv::Size(640, 480), cv::Size(1920, 1080) })
    for (const int fps : { 24, 30, 60 })
      for (const auto pattern :
           { tactile::FilmPattern::static_motion, tactile::FilmPattern::dynamic_motion })
        for (const double noise : { 0.0, 2.0, 4.0 }) {
          if (extent.quick && (size.width > 320 || fps != 30))
            continue;
          FilmCase film = ball_case(pattern, size, fps, noise);
          film.seeds = 1;
          film.models = { tuned_model };
          film.seconds = size.width < 1920 ? 20 : 10;
          cases.push_back(film);
          if (!extent.full && (size.width == 1920 || fps != 30))
            continue;
          film.models = peer_models(true);
          film.models.insert(film.models.begin(), paper_model);
          cases.push_back(film);
        }
  return cases;
}

std::vector<Backgrounds>
backgrounds(const Extent &extent)
{
  std::vector<Backgrounds> all{ { "leaves", {} } };
  for (const std::uint64_t seed : { 1, 2, 3 })
    all[0].pictures.push_back(dead_leaves({ 1280, 960 }, seed));
  if (!extent.data.empty()) {
    all.push_back({ "photographs", {} });
    for (const char *file : { "1001.jpg", "1017.jpg", "1033.jpg", "1049.jpg" })
      all[1].pictures.push_back(read_photograph(extent.data / "osie" / file));
  }
  return all;
}

std::vector<FilmCase>
phantom_cases(const Extent &extent)
{
  struct Setting
  {
    cv::Size size;
    int fps;
  };
  std::vector<FilmCase> cases;
  for (const auto &background : backgrounds(extent))
    for (const Setting setting : { Setting{ { 640, 360 }, 30 },
                                   { { 320, 180 }, 30 },
                                   { { 1920, 1080 }, 30 },
                                   { { 640, 360 }, 24 },
                                   { { 640, 360 }, 60 } })
      for (const auto disturbance : kDisturbances)
        for (const double noise : { 0.0, 2.0, 4.0, 6.0 })
          for (const bool ball : { false, true }) {
            // Noise alone is what a still picture is for.
            if (noise != 2 && (disturbance != Disturbance::still || ball))
              continue;
            const bool standard = setting.size.width == 640 && setting.fps == 30;
            const bool synthetic = background.kind == "leaves";
            if (!standard && (extent.quick || (!synthetic && setting.size.width != 320)))
              continue;
            FilmCase film = disturbed_case(disturbance, background, setting.size, ball, noise);
            film.fps = setting.fps;
            film.models = standard && !ball ? our_models() : std::vector<ModelMaker>{ tuned_model };
            film.seeds = setting.size.width > 640 ? 1 : 2;
            film.seconds = setting.fps == 60 ? 6 : 10;
            if (extent.quick) {
              film.seeds = 1;
              film.seconds = 4;
            }
            cases.push_back(film);
            film.models = peer_models(false);
            film.seconds = 4;
            if (standard && synthetic && !ball && !film.models.empty())
              cases.push_back(film);
          }
  for (const double share : { 0.1, 0.3, 0.6 })
    for (const double contrast : { 1.0, 0.15 }) {
      FilmCase film = entering_case(share, { 640, 360 }, contrast);
      film.models = our_models();
      cases.push_back(film);
    }
  return cases;
}

} // namespace

std::string
size_text(cv::Size size)
{
  return std::to_string(size.width) + "×" + std::to_string(size.height);
}

Section
ball_section(const Extent &extent, Summary &summary)
{
  const auto cases = ball_cases(extent);
  const auto scores = score_films(cases, extent.threads, "films");
  const char *const title = "Balls on an even background";
  Table every(title, "",
              { "film", "size", "fps", "σ", "model", "(a) strongest", "(b) energy", "(c) silent",
                "(d) frames", "felt in the first frame", "(e) pairs", "onsets" });
  std::vector<std::string> models; // tuned first
  std::vector<std::string> sizes;
  std::map<std::pair<std::string, std::string>, WorstScores> worst;
  UnitsByModel strongest; // of the films that all were shown
  UnitsByModel energy;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const auto &[model, s, films] : scores[i]) {
      const std::string size = size_text(cases[i].size);
      every.add({ cases[i].film, size, std::to_string(cases[i].fps), figure(cases[i].noise, 0),
                  model, figure(s.strongest.value(), 3), figure(s.energy.value(), 3),
                  figure(s.silent.value(), 3), figure(s.delay.value(), 2),
                  figure(s.prompt.value(), 3), figure(s.pair.value(), 3),
                  figure(s.delay.count, 0) });
      note(models, model);
      note(sizes, size);
      worst[{ model, size }].add(s);
      if (cases[i].fps == 30 && cases[i].size.width < 1920)
        for (const Scores &film : films) {
          strongest[model].push_back(film.strongest);
          energy[model].push_back(film.energy);
        }
    }
  summary.push_back(summary_row("two balls", "(a) the strongest cell is a ball's", strongest));
  summary.push_back(summary_row("two balls", "(b) energy in the balls' cells", energy));
  Table table(
      title,
      "A smoke test: a rival of 35 lines passes it, too. "
      "The paper's two films; the worst of both, of 24, 30 and 60 fps, and of noise of σ 0, "
      "2 and 4 codes. "
          + std::string(extent.full ? "" : "Paper and peers at 30 fps only. ")
          + "(a): share of the frames around an event whose strongest cell is a ball's. "
            "(b): share of the map's energy in the balls' cells. "
            "(c): share of the frames that are silent where nothing moves. "
            "(d): frames from an onset to the first level above 0. "
            "(e): share of the frames in which both balls of a pair are felt.",
      { "model", "size", "(a)", "(b)", "(c)", "(d)", "(e)" });
  for (const auto &model : models)
    for (const auto &size : sizes)
      if (const auto found = worst.find({ model, size }); found != worst.end()) {
        const WorstScores &w = found->second;
        table.add({ model, size, figure(w.strongest.value(), 3), figure(w.energy.value(), 3),
                    figure(w.silent.value(), 3), figure(w.delay.value(), 2),
                    figure(w.pair.value(), 3) },
                  model == "tuned" || (size == "640×480" && !model.ends_with("× R")));
      }
  return { table, every };
}

Section
phantom_section(const Extent &extent, Summary &summary)
{
  const auto cases = phantom_cases(extent);
  const auto scores = score_films(cases, extent.threads, "phantoms");
  const char *const title = "Nothing happens";
  Table every(
      title, "",
      { "film", "picture", "size", "fps", "σ", "ball", "model", "felt", "found", "right cell" });
  // One row for each film, with and without a ball; a column for each model.
  struct Row
  {
    std::vector<std::string> film;
    std::map<std::string, Worst> felt{}; ///< by model
    Worst found{ true };
    Worst right{ true };
  };
  std::vector<Row> rows;
  std::vector<std::string> models;          // tuned is a column of its own
  std::map<std::string, UnitsByModel> felt; // by film
  Worst camera(false);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const FilmCase &one = cases[i];
    const bool still = one.film == name(Disturbance::still);
    const std::vector<std::string> film{ one.film + (still ? ", σ " + figure(one.noise, 0) : ""),
                                         one.pictures };
    auto row = std::ranges::find(rows, film, &Row::film);
    if (row == rows.end())
      row = rows.insert(row, { film });
    for (const auto &[model, s, films] : scores[i]) {
      every.add({ one.film, one.pictures, size_text(one.size), std::to_string(one.fps),
                  figure(one.noise, 0), one.ball ? "yes" : "no", model, figure(s.active.value(), 4),
                  figure(s.found.value(), 3), figure(s.right.value(), 3) });
      if (model != "tuned")
        note(models, model);
      if (!one.ball) {
        row->felt.try_emplace(model, false).first->second.add(s.active.value());
        if (still && model == "tuned")
          camera.add(s.camera.value());
        for (const Scores &single : films)
          felt[one.film][model].push_back(single.active);
      } else if (model == "tuned") {
        row->found.add(s.found.value());
        row->right.add(s.right.value());
      }
    }
  }
  summary.push_back(worst_disturbance(felt));

  std::vector<std::string> header{ "film", "picture", "tuned", "ball found / right cell" };
  header.insert(header.end(), models.begin(), models.end());
  Table table(title,
              "Share of the frames that are felt, of films in which nothing happens: the worst of "
              "640×360 at 24, 30 and 60 fps, of 320×180, and of 1920×1080; paper and peers at "
              "640×360 and 30 fps. "
              "Found: the same film with a ball, felt within 1/3 s. "
              "Right cell: the strongest is the ball's. "
              "Objects that come in are to be felt in 50 % of the frames. "
              "The camera counts as moving in at most "
                  + percent(camera.value()) + " of the frames of still pictures.",
              header);
  const auto felt_by = [](const Row &row, const std::string &model) {
    const auto found = row.felt.find(model);
    return found == row.felt.end() ? "" : percent(found->second.value());
  };
  for (const Row &row : rows) {
    std::vector<std::string> cells = row.film;
    cells.push_back(felt_by(row, "tuned"));
    cells.push_back(std::isnan(row.found.value())
                        ? ""
                        : percent(row.found.value()) + " / " + percent(row.right.value()));
    for (const auto &model : models)
      cells.push_back(felt_by(row, model));
    table.add(cells, row.film[1] != "photographs");
  }
  return { table, every };
}

Table
choice_table(int threads)
{
  constexpr std::size_t kBalls = 4; // films on an even background, first
  const auto all = choices();
  const Backgrounds leaves{ "leaves",
                            { dead_leaves({ 1280, 960 }, 1), dead_leaves({ 1280, 960 }, 2) } };
  std::vector<FilmCase> cases;
  for (const auto pattern :
       { tactile::FilmPattern::static_motion, tactile::FilmPattern::dynamic_motion })
    for (const double noise : { 0.0, 4.0 })
      cases.push_back(ball_case(pattern, { 640, 480 }, 30, noise));
  for (const auto disturbance : kDisturbances)
    for (const bool ball : { false, true })
      cases.push_back(disturbed_case(disturbance, leaves, { 640, 360 }, ball,
                                     disturbance == Disturbance::still && !ball ? 6 : 2));
  const std::size_t disturbed = cases.size();
  cases.push_back(entering_case(0.6, { 640, 360 }, 0.15));
  for (auto &film : cases) {
    for (const auto &choice : all)
      film.models.push_back(choice.model);
    film.seconds = film.ball ? 15 : std::min(film.seconds, 15.0);
    film.seeds = 1;
  }
  std::vector<std::string> header{ "parameter", "value", "(a)", "(b)", "(c)", "(d)", "(e)" };
  for (const auto disturbance : kDisturbances)
    header.emplace_back(name(disturbance));
  header.insert(header.end(), { "ball found", "right cell", "60 % object comes in (of 50 %)" });
  Table table("One choice made otherwise",
              "The tuned profile at 640 wide with one parameter changed; the worst of the films. "
              "Columns (a) to (e) as above, then the share of frames felt where nothing happens.",
              header);
  const auto scores = score_films(cases, threads, "choices");
  for (std::size_t c = 0; c < all.size(); ++c) {
    // Of the first `films`.
    const auto worst = [&](Mean Scores::*what, std::size_t films, bool least) {
      Worst value(least);
      for (std::size_t i = 0; i < films; ++i)
        value.add((scores[i][c].scores.*what).value());
      return value.value();
    };
    std::vector<std::string> row{ all[c].parameter,
                                  all[c].value,
                                  figure(worst(&Scores::strongest, kBalls, true), 3),
                                  figure(worst(&Scores::energy, kBalls, true), 3),
                                  figure(worst(&Scores::silent, kBalls, true), 3),
                                  figure(worst(&Scores::delay, kBalls, false), 2),
                                  figure(worst(&Scores::pair, kBalls, true), 3) };
    for (std::size_t i = kBalls; i < disturbed; i += 2)
      row.push_back(percent(scores[i][c].scores.active.value()));
    row.push_back(percent(worst(&Scores::found, cases.size(), true)));
    row.push_back(percent(worst(&Scores::right, cases.size(), true)));
    row.push_back(percent(scores[disturbed][c].scores.active.value()));
    table.add(row, false);
  }
  return table;
}

} // namespace quality
