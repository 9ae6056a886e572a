// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How well do the maps follow what happens? Makes docs/measured/quality.md: films whose events are
// known, films in which nothing happens however much changes, photographs with people's fixations;
// the literal paper, the tuned profile and its peers.
#include "accuracy.h"
#include "cinema_table.h"
#include "clip_table.h"
#include "film_tables.h"
#include "photographs.h"
#include "pictures.h"
#include "steering.h"
#include "summary.h"

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
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>

using namespace quality;

namespace {

struct Options
{
  gboolean check = FALSE;
  gboolean quick = FALSE;
  gboolean full = FALSE;
  gint threads = 2;
  gchar *data = nullptr;
  gchar **tables = nullptr;
  gchar *scene = nullptr;
  gchar *markdown = nullptr;
  gchar *csv = nullptr;
  gchar *films = nullptr;
  gchar *labels = nullptr;
  gchar **methods = nullptr;
};

/// Of the pictures that no weight was tuned on.
SummaryRow
photograph_row(const std::vector<PhotographRow> &rows, std::string figure, bool share,
               double PhotographScores::*score)
{
  SummaryRow summary{ .set = "photographs", .figure = std::move(figure), .share = share };
  for (const auto &row : rows) {
    if (row.split != "validation")
      continue;
    std::vector<Mean> pictures(row.pictures.size());
    for (std::size_t i = 0; i < pictures.size(); ++i)
      pictures[i].add(row.pictures[i].*score);
    const Estimate found = estimate(pictures);
    if (row.model == "tuned spatial")
      summary.ours = found;
    else if (row.model == "paper literal")
      summary.paper = found;
    else if (row.model == "people")
      summary.people = found;
    else if (row.model == "center" || std::ranges::any_of(kPeers, [&](Peer peer) {
               return row.model.starts_with(name(peer));
             }))
      summary.peers.emplace_back(row.model, found);
  }
  return summary;
}

Section
photograph_section(const Extent &extent, Summary &summary)
{
  const auto rows = score_photographs(extent.data / "osie", extent.threads);
  summary.push_back(photograph_row(rows, "NSS", false, &PhotographScores::nss));
  summary.push_back(photograph_row(rows, "strongest cell is where people look most", true,
                                   &PhotographScores::cell_right));
  Table table(
      "Photographs",
      "How well maps tell where 15 people looked on photographs (OSIE). Weights were tuned on "
      "the training split. People: one half of them tells where the other looked. "
      "× R: weighted with color rarity; × R·B²: with border rarity, too. The last three columns "
      "judge what is felt on 3 × 3 tactors.",
      { "model", "split", "pictures", "NSS", "AUC-Judd", "shuffled AUC", "CC",
        "strongest cell right", "cells' CC", "felt NSS" });
  for (const auto &row : rows) {
    const PhotographScores s = row.mean();
    table.add({ row.model, row.split, std::to_string(row.pictures.size()), figure(s.nss, 3),
                figure(s.auc_judd, 3), figure(s.shuffled_auc, 3), figure(s.cc, 3),
                figure(s.cell_right, 3), figure(s.cell_cc, 3), figure(s.felt_nss, 3) },
              row.split == "validation" && !row.model.ends_with("× R"));
  }
  return { table };
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

/// A weight of the center may move the strongest cell of a ball that lies in two cells.
std::unique_ptr<Model>
unweighted_model()
{
  tactile::MappingSettings mapping = tactile::MappingSettings::tuned();
  mapping.center_weight = 0;
  return std::make_unique<AnalyzerModel>("tuned, center-weight=0", saliency::Profile::tuned(),
                                         mapping);
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
  for (std::size_t i = balls; i < disturbed; ++i)
    if (cases[i].ball)
      cases[i].models = { unweighted_model };

  const auto scores = score_films(cases, options.threads, "check");
  bool good = true;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const FilmCase &film = cases[i];
    const Scores &s = scores[i][0].scores;
    if (i < balls) {
      // A ball that begins to move in noise is felt once its way is beyond the noise.
      const bool unclear = film.film == "dynamic-motion" && film.noise > 0;
      good &= holds(film, "(a)", s.strongest.value(), unclear ? 0.88 : 0.98, true);
      good &= holds(film, "(b)", s.energy.value(), 0.96, true);
      good &= holds(film, "(c)", s.silent.value(), 0.99, true);
      good &= holds(film, "(d)", s.delay.value(), unclear ? 3 : 0.6, false);
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
  Section (*make)(const Extent &, Summary &);
  bool needs_data;
};

/// In the order of the page.
constexpr std::array kTables{
  NamedTable{ "clips", clip_section, true },
  NamedTable{ "photographs", photograph_section, true },
  NamedTable{ "films", ball_section, false },
  NamedTable{ "phantoms", phantom_section, false },
  NamedTable{ "cinema", [](const Extent &e, Summary &s) { return Section{ cinema_table(e, s) }; },
              false },
  NamedTable{ "cues",
              [](const Extent &e, Summary &) { return Section{ cue_limit_table(e.threads) }; },
              false },
  NamedTable{ "viewports",
              [](const Extent &e, Summary &) { return Section{ viewport_table(e.threads) }; },
              false },
  NamedTable{ "densities",
              [](const Extent &e, Summary &) { return Section{ density_table(e.data / "clips") }; },
              true },
  NamedTable{ "choices",
              [](const Extent &e, Summary &) { return Section{ choice_table(e.threads) }; },
              false },
  NamedTable{ "accuracy",
              [](const Extent &e, Summary &) {
                return Section{ accuracy_table(e.data, e.threads,
                                               e.full    ? OracleExtent::all
                                               : e.quick ? OracleExtent::few
                                                         : OracleExtent::some) };
              },
              false },
};

std::string
table_names()
{
  std::string names;
  for (const NamedTable &table : kTables)
    names += (names.empty()               ? ""
              : &table == &kTables.back() ? " or "
                                          : ", ")
             + std::string(table.name);
  return names;
}

/// The films to judge, and tracks that others made of them.
ClipSet
clips_of(const Options &options)
{
  ClipSet set{ .films = options.films  ? std::filesystem::path(options.films)
                        : options.data ? std::filesystem::path(options.data) / "clips"
                                       : std::filesystem::path(),
               .labels = options.labels ? options.labels : LABELS };
  for (gchar **method = options.methods; method && *method; ++method) {
    const std::string_view text = *method;
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string_view::npos || equals + 1 == text.size())
      throw std::runtime_error("expected --method NAME=DIRECTORY, got '" + std::string(text) + "'");
    set.methods.push_back({ std::string(text.substr(0, equals)), text.substr(equals + 1) });
  }
  return set;
}

/// Whether this table is to be made. Throws std::runtime_error if it was asked for and lacks its
/// data.
bool
is_wanted(const Options &options, const NamedTable &table)
{
  const bool named = options.tables && g_strv_contains(options.tables, table.name);
  if (table.needs_data && !options.data && !(options.films && table.make == clip_section)) {
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
    if (std::ranges::find(kTables, std::string_view(*name), &NamedTable::name) == kTables.end())
      throw std::runtime_error("expected " + table_names() + ", got '" + *name + "'");
}

/// The page, without tables that failed. Whether all is there.
bool
report(const Options &options, const std::vector<std::string> &command)
{
  check_names(options.tables);
  if (options.csv)
    std::filesystem::create_directories(options.csv);
  const Extent extent{ options.quick != FALSE,
                       options.full != FALSE,
                       options.threads,
                       options.data ? options.data : "",
                       options.scene ? options.scene : "",
                       clips_of(options) };
  Summary summary;
  std::ostringstream sections;
  bool good = true;
  for (const auto &table : kTables) {
    if (!is_wanted(options, table))
      continue;
    const gint64 start = g_get_monotonic_time();
    try {
      const Section section = table.make(extent, summary);
      std::filesystem::path file;
      if (options.csv) {
        file = std::filesystem::path(options.csv) / (std::string(table.name) + ".csv");
        std::ostringstream csv;
        (section.every ? *section.every : section.table).write_csv(csv);
        good &= write(file.c_str(), csv.str());
      }
      section.table.write_markdown(
          sections,
          options.markdown && options.csv
              ? file.lexically_proximate(std::filesystem::path(options.markdown).parent_path())
                    .generic_string()
              : file.generic_string());
      std::fprintf(stderr, "%s: %.0f s\n", table.name,
                   static_cast<double>(g_get_monotonic_time() - start) / 1e6);
    } catch (const std::exception &problem) {
      std::fprintf(stderr, "tactile_quality: no %s: %s\n", table.name, problem.what());
      good = false;
    }
  }
  for (const Peer peer : kPeers)
    if (!is_available(peer))
      std::fprintf(stderr, "%s left out: run tools/setup.sh quality, then configure again\n",
                   name(peer));
  std::ostringstream markdown;
  write_page_head(markdown, "Quality of the maps", command);
  if (!summary.empty())
    summary_table(summary).write_markdown(markdown);
  markdown << sections.str();
  std::cout << markdown.str();
  if (options.markdown)
    good &= write(options.markdown, markdown.str());
  return good;
}

} // namespace

int
main(int argc, char **argv)
{
  Options options;
  const std::vector<std::string> command(argv, argv + argc);
  const std::string only_table = "Only this: " + table_names() + "; may be repeated";
  const GOptionEntry entries[] = {
    { "check", 0, 0, G_OPTION_ARG_NONE, &options.check,
      "Hold the tuned profile to its floors; exit status 1 if it is below", nullptr },
    { "quick", 0, 0, G_OPTION_ARG_NONE, &options.quick, "One size and frame rate of each film",
      nullptr },
    { "data", 0, 0, G_OPTION_ARG_FILENAME, &options.data,
      "Where osie/ (photographs with fixations) and clips/ (films) lie", "DIRECTORY" },
    { "full", 0, 0, G_OPTION_ARG_NONE, &options.full,
      "Peers at all sizes and frame rates, the oracle for whole films: an hour and a half",
      nullptr },
    { "table", 0, 0, G_OPTION_ARG_STRING_ARRAY, &options.tables, only_table.c_str(), "NAME" },
    { "scene", 0, 0, G_OPTION_ARG_STRING, &options.scene,
      "Of the scenes of cinema those whose name has TEXT in it", "TEXT" },
    { "markdown", 0, 0, G_OPTION_ARG_FILENAME, &options.markdown, "Write the page", "FILE" },
    { "csv", 0, 0, G_OPTION_ARG_FILENAME, &options.csv, "Write every figure, one file a table",
      "DIRECTORY" },
    { "films", 0, 0, G_OPTION_ARG_FILENAME, &options.films, "Films of clips (DATA/clips)",
      "DIRECTORY" },
    { "labels", 0, 0, G_OPTION_ARG_FILENAME, &options.labels,
      "Their labels, FILM.csv (tests/quality/labels)", "DIRECTORY" },
    { "method", 0, 0, G_OPTION_ARG_STRING_ARRAY, &options.methods,
      "Judge a method of yours on clips, by its tracks DIRECTORY/FILM.csv; may be repeated",
      "NAME=DIRECTORY" },
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
  g_setenv("VISUOTACTILE_MODULES", PEOPLE_MODULES, FALSE); // those of this build
  try {
    const bool good = options.check ? accuracy_holds(options.threads) & check(options)
                                          & cinema_holds(options.threads)
                                    : report(options, command);
    return good ? 0 : 1;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "tactile_quality: %s\n", problem.what());
    return 1;
  }
}
