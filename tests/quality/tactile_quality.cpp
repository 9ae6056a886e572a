// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How well do the maps follow what happens? Tables of docs/measured/quality.md: films whose events are
// known, films in which nothing happens however much changes, photographs with people's fixations;
// the literal paper, the tuned profile and its peers.
#include "accuracy.h"
#include "choices.h"
#include "clips.h"
#include "film_cases.h"
#include "photographs.h"
#include "pictures.h"
#include "steering.h"
#include "table.h"

#include <gst/gst.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string_view>

using namespace quality;

namespace {

constexpr std::array kDisturbances{ Disturbance::still, Disturbance::flicker,
                                    Disturbance::fade,  Disturbance::cut,
                                    Disturbance::pan,   Disturbance::pan_and_rest,
                                    Disturbance::zoom,  Disturbance::shake };

struct Options
{
  gboolean check = FALSE;
  gboolean quick = FALSE;
  gint threads = 2;
  gchar *data = nullptr;
  gchar **tables = nullptr;
  gchar *markdown = nullptr;
  gchar *csv = nullptr;
};

std::vector<ModelMaker>
our_models()
{
  return { paper_model, tuned_model };
}

/// For one case: models of the same peer share its maps.
std::vector<ModelMaker>
peer_models(bool weighted_too)
{
  std::vector<ModelMaker> models;
  for (const Peer peer : kPeers) {
    if (!is_available(peer))
      continue;
    const auto maps = std::make_shared<PeerMaps>(peer);
    models.emplace_back([maps] { return peer_model(maps, false); });
    if (weighted_too)
      models.emplace_back([maps] { return peer_model(maps, true); });
  }
  return models;
}

std::string
size_text(cv::Size size)
{
  return std::to_string(size.width) + "×" + std::to_string(size.height);
}

std::vector<std::vector<FilmScores>>
score(const std::vector<FilmCase> &cases, const Options &options, const char *what)
{
  auto scores = score_films(cases, options.threads, [&](std::size_t done) {
    std::fprintf(stderr, "\r%s: %zu of %zu", what, done, cases.size());
  });
  std::fputc('\n', stderr);
  return scores;
}

Table
film_table(const Options &options)
{
  std::vector<FilmCase> cases;
  for (const cv::Size size : { cv::Size(320, 240), cv::Size(640, 480), cv::Size(1920, 1080) })
    for (const int fps : { 24, 30, 60 })
      for (const auto pattern :
           { tactile::FilmPattern::static_motion, tactile::FilmPattern::dynamic_motion })
        for (const double noise : { 0.0, 2.0, 4.0 }) {
          FilmCase film = ball_case(pattern, size, fps, noise);
          film.seeds = 1;
          if (options.quick && (size.width > 320 || fps != 30))
            continue;
          film.models = { tuned_model };
          film.seconds = size.width == 320 ? 30 : size.width == 640 ? 20 : 10;
          cases.push_back(film);
          // The slowest peers take 0.3 s for a large frame; the first pair comes at 5.8 s.
          film.models = peer_models(true);
          film.models.insert(film.models.begin(), paper_model);
          film.seconds = size.width == 320                                ? 20
                         : size.width == 640                              ? 10
                         : pattern == tactile::FilmPattern::static_motion ? 6.3
                                                                          : 4;
          cases.push_back(film);
        }
  Table table("Balls on an even background",
              { "film", "size", "fps", "σ", "model", "(a) strongest", "(b) energy", "(c) silent",
                "(d) frames", "felt in the first frame", "(e) pairs", "onsets" });
  const auto scores = score(cases, options, "films");
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const auto &[model, s] : scores[i])
      table.add({ cases[i].film, size_text(cases[i].size), std::to_string(cases[i].fps),
                  figure(cases[i].noise, 0), model, figure(s.strongest.value(), 3),
                  figure(s.energy.value(), 3), figure(s.silent.value(), 3),
                  figure(s.delay.value(), 2), figure(s.prompt.value(), 3),
                  figure(s.pair.value(), 3), figure(s.delay.count, 0) });
  return table;
}

std::vector<Backgrounds>
backgrounds(const Options &options)
{
  std::vector<Backgrounds> all{ { "leaves", {} } };
  for (const std::uint64_t seed : { 1, 2, 3 })
    all[0].pictures.push_back(dead_leaves({ 1280, 960 }, seed));
  if (options.data) {
    all.push_back({ "photographs", {} });
    for (const char *file : { "1001.jpg", "1017.jpg", "1033.jpg", "1049.jpg" })
      all[1].pictures.push_back(
          read_photograph(std::filesystem::path(options.data) / "osie" / file));
  }
  return all;
}

Table
phantom_table(const Options &options)
{
  struct Setting
  {
    cv::Size size;
    int fps;
  };
  std::vector<FilmCase> cases;
  for (const auto &background : backgrounds(options))
    for (const Setting setting : { Setting{ { 640, 360 }, 30 },
                                   { { 320, 180 }, 30 },
                                   { { 1920, 1080 }, 30 },
                                   { { 640, 360 }, 24 },
                                   { { 640, 360 }, 60 } })
      for (const auto disturbance : kDisturbances)
        for (const bool ball : { false, true })
          for (const double noise : { 0.0, 2.0, 4.0, 6.0 }) {
            // Noise alone is what a still picture is for.
            if (noise != 2 && (disturbance != Disturbance::still || ball))
              continue;
            const bool standard = setting.size.width == 640 && setting.fps == 30;
            const bool synthetic = background.kind == "leaves";
            if (!standard && (options.quick || (!synthetic && setting.size.width != 320)))
              continue;
            FilmCase film = disturbed_case(disturbance, background, setting.size, ball, noise);
            film.fps = setting.fps;
            film.models = standard ? our_models() : std::vector<ModelMaker>{ tuned_model };
            film.seeds = setting.size.width > 640 ? 1 : 2;
            film.seconds = setting.fps == 60 ? 6 : 10;
            cases.push_back(film);
            film.models = peer_models(false);
            film.seeds = 1;
            film.seconds = 6;
            if (standard && synthetic && !film.models.empty())
              cases.push_back(film);
          }
  for (const double share : { 0.1, 0.3, 0.6 })
    for (const double contrast : { 1.0, 0.15 }) {
      FilmCase film = entering_case(share, { 640, 360 }, contrast);
      film.models = our_models();
      cases.push_back(film);
    }
  Table table("Nothing happens, a ball appears, something large comes in",
              { "film", "picture", "size", "fps", "σ", "model", "frames felt", "cells",
                "camera moves", "ball found", "right cell", "balls" });
  const auto scores = score(cases, options, "phantoms");
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const auto &[model, s] : scores[i]) {
      const bool ball = cases[i].ball;
      table.add({ cases[i].film + (ball ? " + ball" : ""), cases[i].pictures,
                  size_text(cases[i].size), std::to_string(cases[i].fps), figure(cases[i].noise, 0),
                  model, percent(s.active.value()), figure(s.cells.value(), 2),
                  percent(s.camera.value()), ball ? percent(s.found.value()) : "",
                  ball ? percent(s.right.value()) : "", ball ? figure(s.found.count, 0) : "" });
    }
  return table;
}

Table
photograph_table(const Options &options)
{
  Table table("Photographs and fixations",
              { "model", "split", "pictures", "NSS", "AUC-Judd", "shuffled AUC", "CC" });
  for (const auto &row :
       score_photographs(std::filesystem::path(options.data) / "osie", options.threads))
    table.add({ row.model, row.split, std::to_string(row.pictures), figure(row.scores.nss, 3),
                figure(row.scores.auc_judd, 3), figure(row.scores.shuffled_auc, 3),
                figure(row.scores.cc, 3) });
  return table;
}

Table
clip_table(const Options &options)
{
  Table table("Real films",
              { "clip", "profile", "frames", "felt", "tactors felt", "at a time", "longest, s",
                "longest of a tactor, s", "cues a minute", "camera moves", "cuts" });
  for (const auto &[clip, profile, s] : score_clips(std::filesystem::path(options.data) / "clips"))
    table.add({ clip, profile, std::to_string(s.frames), percent(s.active), percent(s.tactors),
                figure(s.tactors_active, 2), figure(s.longest, 1), figure(s.longest_tactor, 1),
                figure(s.cues_per_minute, 0), percent(s.camera_moves), std::to_string(s.cuts) });
  return table;
}

Table
agreement_table(const Options &options)
{
  return accuracy_table(options.data ? options.data : "", options.threads, options.quick);
}

/// What each choice is worth: the worst of the films.
Table
choice_table(const Options &options)
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
  Table table("One choice made otherwise (frames felt where nothing happens; worst of the films)",
              header);
  const auto scores = score(cases, options, "choices");
  for (std::size_t c = 0; c < all.size(); ++c) {
    // Of the first `films`.
    const auto worst = [&](Mean Scores::*what, std::size_t films, bool least) {
      double value = std::nan("");
      for (std::size_t i = 0; i < films; ++i)
        if (const double v = (scores[i][c].scores.*what).value(); !std::isnan(v))
          value = std::isnan(value) ? v : least ? std::min(value, v) : std::max(value, v);
      return value;
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
    table.add(row);
  }
  return table;
}

/// A floor or a ceiling, and whether it holds; says so if not.
bool
holds(const FilmCase &film, const char *what, double value, double limit, bool least)
{
  if (least ? value >= limit : value <= limit)
    return true;
  std::fprintf(stderr, "tactile_quality: %s %s σ %.0f: %s is %.4f; expected at %s %.4f\n",
               film.film.c_str(), size_text(film.size).c_str(), film.noise, what, value,
               least ? "least" : "most", limit);
  return false;
}

/// The tuned profile against floors, on a part of the films.
bool
check(const Options &options)
{
  std::vector<FilmCase> cases;
  for (const cv::Size size : { cv::Size(320, 240), cv::Size(640, 480) })
    for (const auto pattern :
         { tactile::FilmPattern::static_motion, tactile::FilmPattern::dynamic_motion })
      for (const double noise : { 0.0, 4.0 })
        cases.push_back(ball_case(pattern, size, 30, noise));
  const std::size_t balls = cases.size();
  const Backgrounds leaves{ "leaves",
                            { dead_leaves({ 640, 480 }, 1), dead_leaves({ 640, 480 }, 2) } };
  for (const auto disturbance : kDisturbances)
    for (const bool ball : { false, true })
      cases.push_back(disturbed_case(disturbance, leaves, { 320, 180 }, ball, 2));
  const std::size_t disturbed = cases.size();
  for (const double share : { 0.3, 0.6 })
    cases.push_back(entering_case(share, { 640, 360 }, 0.15));
  for (auto &film : cases)
    film.models = { tuned_model };

  const auto scores = score(cases, options, "check");
  bool good = true;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const FilmCase &film = cases[i];
    const Scores &s = scores[i][0].scores;
    if (i < balls) {
      good &= holds(film, "(a)", s.strongest.value(), 0.99, true);
      good &= holds(film, "(b)", s.energy.value(), 0.96, true);
      good &= holds(film, "(c)", s.silent.value(), 0.99, true);
      good &= holds(film, "(d)", s.delay.value(), 0.45, false);
      if (film.film == "static-motion") // the other has one ball
        good &= holds(film, "(e)", s.pair.value(), 0.99, true);
    } else if (i >= disturbed) {
      good &= holds(film, "share of frames felt, of 0.5", s.active.value(), 0.45, true);
    } else if (film.ball) {
      good &= holds(film, "share of balls found", s.found.value(), 0.99, true);
      good &= holds(film, "share of right cells", s.right.value(), 0.98, true);
    } else {
      const bool moves = film.film == "zoom" || film.film == "shake";
      const double most = film.film == "fade" ? 0.05 : moves ? 0.02 : 0.001;
      good &= holds(film, "share of frames felt", s.active.value(), most, false);
    }
    if (film.film == "still")
      good &= holds(film, "share of frames with camera motion", s.camera.value(), 0.02, false);
  }
  return good;
}

bool
write(const char *path, const std::string &text)
{
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out)
    std::fprintf(stderr, "tactile_quality: cannot write '%s'\n", path);
  return static_cast<bool>(out);
}

struct NamedTable
{
  const char *name;
  Table (*make)(const Options &);
  bool needs_data;
};

constexpr std::array kTables{
  NamedTable{ "films", film_table, false },
  NamedTable{ "phantoms", phantom_table, false },
  NamedTable{ "choices", choice_table, false },
  NamedTable{ "cues", [](const Options &o) { return cue_limit_table(o.threads); }, false },
  NamedTable{ "viewports", [](const Options &o) { return viewport_table(o.threads); }, false },
  NamedTable{ "accuracy", agreement_table, false },
  NamedTable{ "photographs", photograph_table, true },
  NamedTable{ "clips", clip_table, true }
};

/// The tables that were asked for, or all that can be made. Throws std::runtime_error for a name
/// that is none, and for a table that lacks its data.
std::vector<Table>
make_tables(const Options &options)
{
  std::vector<Table> tables;
  if (options.tables) {
    for (gchar **name = options.tables; *name; ++name) {
      const auto table = std::ranges::find_if(
          kTables, [&](const NamedTable &t) { return std::string_view(t.name) == *name; });
      if (table == kTables.end())
        throw std::runtime_error(
            std::string("expected films, phantoms, choices, cues, viewports, accuracy, "
                        "photographs or clips, got '")
            + *name + "'");
      if (table->needs_data && !options.data)
        throw std::runtime_error(std::string(*name) + " need --data DIRECTORY");
      tables.push_back(table->make(options));
    }
    return tables;
  }
  for (const auto &table : kTables)
    if (!table.needs_data || options.data)
      tables.push_back(table.make(options));
    else
      std::fprintf(stderr, "%s left out: no --data\n", table.name);
  return tables;
}

bool
report(const Options &options)
{
  const auto tables = make_tables(options);
  std::ostringstream markdown;
  std::ostringstream csv;
  for (const auto &table : tables) {
    table.write_markdown(markdown);
    table.write_csv(csv);
  }
  for (const Peer peer : kPeers)
    if (!is_available(peer))
      std::fprintf(stderr, "%s left out: run tools/setup.sh quality, then configure again\n",
                   name(peer));
  std::cout << markdown.str();
  return (!options.markdown || write(options.markdown, markdown.str()))
         && (!options.csv || write(options.csv, csv.str()));
}

} // namespace

int
main(int argc, char **argv)
{
  Options options;
  const GOptionEntry entries[] = {
    { "check", 0, 0, G_OPTION_ARG_NONE, &options.check,
      "Hold the tuned profile to its floors; exit status 1 if it is below", nullptr },
    { "quick", 0, 0, G_OPTION_ARG_NONE, &options.quick, "One size and frame rate of each film",
      nullptr },
    { "data", 0, 0, G_OPTION_ARG_FILENAME, &options.data,
      "Where osie/ (photographs with fixations) and clips/ (films) lie", "DIRECTORY" },
    { "table", 0, 0, G_OPTION_ARG_STRING_ARRAY, &options.tables,
      "Only this: films, phantoms, choices, cues, viewports, accuracy, photographs or clips; may "
      "be repeated",
      "NAME" },
    { "markdown", 0, 0, G_OPTION_ARG_FILENAME, &options.markdown, "Write the tables as Markdown",
      "FILE" },
    { "csv", 0, 0, G_OPTION_ARG_FILENAME, &options.csv, "Write the tables as CSV", "FILE" },
    { "threads", 0, 0, G_OPTION_ARG_INT, &options.threads, "Films at a time (2)", "N" },
    { nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr },
  };
  g_autoptr(GOptionContext) context = g_option_context_new("- how well maps follow films");
  g_option_context_set_summary(context,
                               "Prints tables of scores; docs/measured/quality.md explains them.");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error) || argc > 1) {
    std::fprintf(stderr, "tactile_quality: %s; see --help\n",
                 error ? error->message : "expected options alone");
    return 2;
  }
  if (options.threads < 1 || options.threads > 64) {
    std::fprintf(stderr, "tactile_quality: expected 1 to 64 threads, got %d\n", options.threads);
    return 2;
  }
  cv::setNumThreads(1);
  try {
    const bool good
        = options.check ? accuracy_holds(options.threads) & check(options) : report(options);
    return good ? 0 : 1;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "tactile_quality: %s\n", problem.what());
    return 1;
  }
}
