// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How well do the maps follow what happens? Makes docs/measured/quality.md: films whose events are
// known, films in which nothing happens however much changes, photographs with people's fixations;
// the literal paper, the tuned profile and its peers.
#include "accuracy.h"
#include "clips.h"
#include "film_tables.h"
#include "photographs.h"
#include "pictures.h"
#include "steering.h"

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
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>

using namespace quality;

namespace {

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

Table
photograph_table(const Extent &extent)
{
  Table table(
      "Photographs",
      "How well maps tell where 15 people looked on photographs (OSIE). Weights were tuned on "
      "the training split. "
      "× R: weighted with color rarity; × R·B²: with border rarity, too. The last three columns "
      "judge what is felt on 3 × 3 tactors.",
      { "model", "split", "pictures", "NSS", "AUC-Judd", "shuffled AUC", "CC",
        "strongest cell right", "cells' CC", "felt NSS" });
  for (const auto &row : score_photographs(extent.data / "osie", extent.threads))
    table.add({ row.model, row.split, std::to_string(row.pictures), figure(row.scores.nss, 3),
                figure(row.scores.auc_judd, 3), figure(row.scores.shuffled_auc, 3),
                figure(row.scores.cc, 3), figure(row.scores.cell_right, 3),
                figure(row.scores.cell_cc, 3), figure(row.scores.felt_nss, 3) });
  return table;
}

Table
clip_table(const Extent &extent)
{
  Table table("Real films",
              "What is felt of the films in clips/, as shares of frames and of tactors. Precision "
              "and recall are those of tests/quality/labels.",
              { "clip", "profile", "frames", "felt", "tactors felt", "at a time", "longest, s",
                "longest of a tactor, s", "cues a minute", "camera moves", "cuts", "precision",
                "recall" });
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const auto &[clip, profile, s, labels] : score_clips(extent.data / "clips"))
    table.add({ clip, profile, std::to_string(s.frames), percent(s.active), percent(s.tactors),
                figure(s.tactors_active, 2), figure(s.longest, 1), figure(s.longest_tactor, 1),
                figure(s.cues_per_minute, 0), percent(s.camera_moves), std::to_string(s.cuts),
                figure(labels ? labels->precision : kNone, 2),
                figure(labels ? labels->recall : kNone, 2) });
  return table;
}

/// Checks a floor or ceiling, and prints a violation.
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

/// Checks floors of the tuned profile on some of the films.
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

  const auto scores = score(cases, options.threads, "check");
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
  Table (*make)(const Extent &);
  bool needs_data;
};

/// After "films", which has two.
constexpr std::array kTables{
  NamedTable{ "phantoms", phantom_table, false },
  NamedTable{ "choices", [](const Extent &e) { return choice_table(e.threads); }, false },
  NamedTable{ "cues", [](const Extent &e) { return cue_limit_table(e.threads); }, false },
  NamedTable{ "viewports", [](const Extent &e) { return viewport_table(e.threads); }, false },
  NamedTable{ "accuracy",
              [](const Extent &e) { return accuracy_table(e.data, e.threads, e.quick); }, false },
  NamedTable{ "photographs", photograph_table, true },
  NamedTable{ "clips", clip_table, true }
};

/// Whether this table is to be made. Throws std::runtime_error if it was asked for and lacks its
/// data.
bool
is_wanted(const Options &options, const NamedTable &table)
{
  const bool named = options.tables && g_strv_contains(options.tables, table.name);
  if (table.needs_data && !options.data) {
    if (named)
      throw std::runtime_error(std::string(table.name) + " need --data DIRECTORY");
    if (!options.tables)
      std::fprintf(stderr, "%s left out: no --data\n", table.name);
    return false;
  }
  return named || !options.tables;
}

/// Throws std::runtime_error for a name that is none.
void
check_names(gchar **tables)
{
  for (gchar **name = tables; name && *name; ++name)
    if (std::string_view(*name) != "films"
        && std::ranges::find(kTables, std::string_view(*name), &NamedTable::name) == kTables.end())
      throw std::runtime_error(
          std::string("expected films, phantoms, choices, cues, viewports, accuracy, photographs "
                      "or clips, got '")
          + *name + "'");
}

bool
report(const Options &options, const std::vector<std::string> &command)
{
  check_names(options.tables);
  const Extent extent{ options.quick != FALSE, options.threads, options.data ? options.data : "" };
  std::ostringstream markdown;
  std::ostringstream csv;
  write_page_head(markdown, "Quality of the maps", command);
  if (!options.tables || g_strv_contains(options.tables, "films")) {
    const BallTables films = ball_tables(extent);
    films.worst.write_markdown(markdown);
    films.every.write_csv(csv);
  }
  for (const auto &table : kTables)
    if (is_wanted(options, table))
      table.make(extent).write_markdown(markdown);
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
  const std::vector<std::string> command(argv, argv + argc);
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
    { "markdown", 0, 0, G_OPTION_ARG_FILENAME, &options.markdown, "Write the page", "FILE" },
    { "csv", 0, 0, G_OPTION_ARG_FILENAME, &options.csv, "Write every figure of films as CSV",
      "FILE" },
    { "threads", 0, 0, G_OPTION_ARG_INT, &options.threads, "Films at a time (2)", "N" },
    { nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr },
  };
  g_autoptr(GOptionContext) context = g_option_context_new("- how well maps follow films");
  g_option_context_set_summary(
      context, "Prints docs/measured/quality.md; docs/design/quality.md explains it.");
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
    const bool good = options.check ? accuracy_holds(options.threads) & check(options)
                                    : report(options, command);
    return good ? 0 : 1;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "tactile_quality: %s\n", problem.what());
    return 1;
  }
}
