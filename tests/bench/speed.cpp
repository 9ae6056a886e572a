// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What the analysis of a frame costs, beside what others take: makes docs/measured/speed.md and its
// plot. Contenders take turns in one run. One thread is measured in CPU time, more on the wall.
#include "analysis.h"
#include "frame_loop.h"
#include "quality/peers.h"
#include "quality/table.h"
#include "race.h"
#include "support/allocations.h"
#include "svg_plot.h"

#include <glib.h>

#include <hwy/targets.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>

using namespace bench;
using quality::figure;
using quality::percent;
using quality::Table;

namespace {

struct Options
{
  gboolean quick = FALSE;
  gboolean stages = FALSE;
  gint runs = 1;
  gchar *instruction_set = nullptr;
  gchar **sizes = nullptr;
  gchar *markdown = nullptr;
  gchar *csv = nullptr;
  gchar *svg = nullptr;
};

/// The race of one frame size.
struct Result
{
  cv::Size size;
  std::vector<Contender> contenders;

  /// Null if it was left out.
  const Contender *find(std::string_view method, std::string_view input = "I420",
                        int threads = 1) const
  {
    for (const Contender &one : contenders)
      if (one.method.starts_with(method) && one.input == input && one.threads == threads)
        return &one;
    return nullptr;
  }

  double ms(std::string_view method, std::string_view input = "I420", int threads = 1) const
  {
    const Contender *one = find(method, input, threads);
    return one ? median(one->ms) : std::nan("");
  }
};

/// Speedup of one over the other.
double
quicker(const Contender *one, const Contender *other)
{
  return one && other ? ratio(other->ms, one->ms) : std::nan("");
}

std::string
size_text(cv::Size size)
{
  return std::to_string(size.width) + "×" + std::to_string(size.height);
}

cv::Size
parse_size(std::string_view text)
{
  cv::Size size;
  const char *end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const auto valid = [](int side) {
    return side >= 16 && side <= 8192 && side % 2 == 0;
  };
  if (width.ec != std::errc{} || width.ptr == end || *width.ptr != 'x'
      || std::from_chars(width.ptr + 1, end, size.height).ptr != end || !valid(size.width)
      || !valid(size.height))
    throw std::runtime_error("expected sizes like 1920x1080, even and from 16 to 8192, got '"
                             + std::string(text) + "'");
  return size;
}

std::vector<cv::Size>
sizes(const Options &options)
{
  std::vector<cv::Size> all;
  for (gchar **text = options.sizes; text && *text; text++)
    all.push_back(parse_size(*text));
  if (all.empty())
    all = { { 640, 480 }, { 1000, 1000 }, { 1920, 1080 }, { 3840, 2160 } };
  std::ranges::sort(all, {}, &cv::Size::area);
  return all;
}

/// Leaves out the instruction sets that this project would prefer to the named one, or none for an
/// empty name. OpenCV keeps its own choice.
void
limit_instructions(std::string_view name)
{
  hwy::DisableTargets(0);
  std::string known;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name.empty() || name == hwy::TargetName(target)) {
      hwy::DisableTargets(name.empty() ? 0 : target - 1); // better ones have lower bits
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      return;
    }
    known += std::string(known.empty() ? "" : ", ") + hwy::TargetName(target);
  }
  throw std::runtime_error("expected an instruction set of this CPU (" + known + "), got '"
                           + std::string(name) + "'");
}

std::string
times(double ratio)
{
  return std::isnan(ratio) ? "–" : figure(ratio, ratio < 10 ? 2 : 1);
}

std::string
milliseconds(double ms)
{
  return figure(ms, ms < 0.1 ? 4 : ms < 10 ? 3 : 1);
}

/// The method without the size to which a peer scales the frame down.
std::string
method_name(const Contender &one)
{
  return one.method.substr(0, one.method.find(" ("));
}

/// All figures of one size: of the speed of memory is the time of reading the frame once, as a
/// share.
Table
race_table(const Result &result)
{
  Table table("A frame of " + size_text(result.size), "",
              { "method", "format", "threads", "ms", "ns a pixel", "of the speed of memory",
                "bytes allocated", "× literal paper", "× OpenCV rewrite",
                "× the same, decimating first", "× spectral residual", "× fine-grained",
                "× BinWang" });
  for (const Contender &one : result.contenders) {
    std::vector<std::string> row{ one.method,
                                  one.input,
                                  std::to_string(one.threads),
                                  milliseconds(median(one.ms)),
                                  figure(1e6 * median(one.ms) / result.size.area(), 2),
                                  percent(1 / quicker(result.find(kReading, one.input), &one)),
                                  allocations::are_counted() ? figure(one.allocated, 0) : "–" };
    for (const char *peer : { "literal paper", "OpenCV rewrite", "OpenCV rewrite, decimating first",
                              "spectral residual", "fine-grained", "BinWang" })
      row.push_back(one.method == kReading ? "" : times(quicker(&one, result.find(peer))));
    table.add(row);
  }
  return table;
}

/// A frame of I420 at each size.
Table
cost_table(const std::vector<Result> &results)
{
  std::vector<std::string> header{ "ms a frame" };
  for (const Result &result : results)
    header.push_back(size_text(result.size));
  Table table(
      "Cost",
      "I420 in which an object moves, on one thread, in CPU time; with two threads, the time "
      "on the wall, and the CPU time of both. Medians. *Reading the frame*, which adds up its "
      "bytes, is the bound. *Stills* repeat a frame, and in *talking head* a disc a quarter of the "
      "width wide moves by a pixel, both with `skip-unchanged`. With the default `n-threads`, "
      "there "
      "is one thread.",
      header);
  for (const Contender &one : results.front().contenders) {
    const bool is_two = one.threads == 2 && one.method == "tuned";
    if (one.input != "I420" || (one.threads != 1 && !is_two) || one.method == kTwoFrames
        || one.method == kPlayed)
      continue;
    const std::string name = method_name(one);
    std::vector<std::string> row{ name + (is_two ? ", two threads" : "") };
    for (const Result &result : results)
      row.push_back(milliseconds(result.ms(name, "I420", one.threads)));
    table.add(row);
    if (!is_two)
      continue;
    row = { name + ", CPU of two threads" };
    for (const Result &result : results)
      row.push_back(milliseconds(median(result.find(name, "I420", 2)->all_ms)));
    table.add(row);
  }
  return table;
}

/// What the analysis takes with each instruction set that this project has for this CPU, and how
/// many times as quick as the literal paper, with OpenCV's best, it is.
Table
instruction_table(const std::vector<cv::Size> &sizes, int rounds)
{
  std::vector<std::string> header{ "instruction set" };
  for (const cv::Size size : sizes)
    header.push_back(size_text(size));
  Table table("Instruction sets",
              "`tuned`, ms a frame; in parentheses, while the camera moves. [NEON and "
              "SVE](instructions.md) were counted in an emulator.",
              header);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (target == HWY_SCALAR) // not a choice of any CPU
      continue;
    limit_instructions(hwy::TargetName(target));
    std::vector<std::string> row{ hwy::TargetName(target) };
    for (const cv::Size size : sizes) {
      std::vector<Contender> all = own_contenders(size);
      race(all, rounds);
      row.push_back(milliseconds(median(all[0].ms)) + " (" + milliseconds(median(all[1].ms)) + ")");
    }
    table.add(row);
  }
  limit_instructions("");
  return table;
}

/// A ratio that is to be reached, at each size.
struct Target
{
  std::string name;
  std::vector<double> ratios;
};

/// Of one run.
std::vector<Target>
targets(const std::vector<Result> &results)
{
  std::vector<Target> all;
  const auto add = [&](const std::string &name, const auto &value) {
    all.push_back({ name, {} });
    for (const Result &result : results)
      all.back().ratios.push_back(value(result));
  };
  const struct
  {
    const char *name;
    const char *method;
    const char *peer;
  } peers[] = {
    { "11, 22, 40, 100 × as quick as the literal paper", "tuned", "literal paper" },
    { "quicker than the OpenCV rewrite, decimating first", "tuned",
      "OpenCV rewrite, decimating first" },
    { "quicker than the rival of 35 lines", "tuned", "rival of 35 lines" },
    { "quicker than it, camera moving", "tuned, camera moving", "rival of 35 lines" },
    { "exact: 5 × as quick as the literal paper", "exact", "literal paper" },
  };
  for (const auto &[name, method, peer] : peers)
    add(name, [method = method, peer = peer](const Result &result) {
      return quicker(result.find(method), result.find(peer));
    });
  add("camera moving: at most 1.6 × as long", [](const Result &result) {
    return quicker(result.find("tuned"), result.find("tuned, camera moving"));
  });
  add("R'G'B'x: at most 2 × as long as I420", [](const Result &result) {
    return quicker(result.find("tuned"), result.find("tuned", "RGBx"));
  });
  return all;
}

/// The least and the most of all runs.
Table
target_table(const std::vector<cv::Size> &sizes, const std::vector<std::vector<Target>> &runs)
{
  std::vector<std::string> header{ "target" };
  for (const cv::Size size : sizes)
    header.push_back(size_text(size));
  Table table("Targets",
              "Ratios: the least and the most of " + std::to_string(runs.size())
                  + (runs.size() == 1 ? " run." : " runs.")
                  + " The other tables are of the last run.",
              header);
  for (std::size_t i = 0; i < runs.front().size(); i++) {
    std::vector<std::string> row{ runs.front()[i].name };
    for (std::size_t size = 0; size + 1 < header.size(); size++) {
      std::vector<double> ratios;
      for (const auto &run : runs)
        ratios.push_back(run[i].ratios[size]);
      const auto [least, most] = std::ranges::minmax(ratios);
      const std::string low = times(least);
      const std::string high = times(most);
      row.push_back(low == high ? low : low + "–" + high);
    }
    table.add(row);
  }
  return table;
}

Table
stage_table(const std::vector<cv::Size> &all, bool quick)
{
  std::vector<std::string> header{ "size", "profile" };
  header.insert(header.end(), kStageNames.begin(), kStageNames.end());
  header.insert(header.begin() + 3, "of it Lab"); // after the front end
  header.insert(header.end(), { "pooling", "sum" });
  Table table("Stages", "CPU time of each stage, in ms a frame.", header);
  struct Case
  {
    const char *name;
    Scene scene;
    saliency::Profile profile;
    tactile::MappingSettings mapping;
  };
  auto exact = saliency::Profile::tuned();
  exact.exact = true;
  const auto mapping = tactile::MappingSettings::tuned();
  for (const cv::Size size : all)
    for (const auto &[name, scene, profile, map] :
         { Case{ "tuned", Scene::disc, saliency::Profile::tuned(), mapping },
           Case{ "tuned, camera moving", Scene::pan, saliency::Profile::tuned(), mapping },
           Case{ "exact", Scene::disc, exact, mapping },
           Case{ "paper", Scene::disc, saliency::Profile::paper(),
                 tactile::MappingSettings::paper() } }) {
      const bool slow = profile.exact && size.area() > 1'000'000;
      const int frames = quick ? 5 : slow ? 10 : 60;
      const StageTimes times
          = stage_times(profile, map, FrameLoop(size, scene), slow ? 5 : 80, frames);
      std::vector<std::string> row{ size_text(size), name };
      double sum = times.pooling;
      for (const double ms : times.stages) {
        row.push_back(milliseconds(ms));
        sum += ms;
      }
      row.insert(row.begin() + 3, milliseconds(times.lab));
      row.insert(row.end(), { milliseconds(times.pooling), milliseconds(sum) });
      table.add(row);
    }
  return table;
}

struct GridTime
{
  int side;
  double ms;
};

std::vector<GridTime>
grid_times(cv::Size size, int rounds)
{
  const auto film = std::make_shared<FrameLoop>(size, Scene::disc);
  std::vector<Contender> all;
  const int sides[] = { 1, 2, 3, 4, 6, 8, 12, 16 };
  for (const int side : sides) {
    const auto analysis = std::make_shared<Analysis>(
        saliency::Profile::tuned(), tactile::MappingSettings::tuned(), cv::Size(side, side), 1);
    all.push_back({ .method = std::to_string(side), .input = "I420", .work = [=](std::size_t i) {
                     analysis->frame(film->view(i), i);
                   } });
  }
  race(all, rounds);
  std::vector<GridTime> times;
  for (std::size_t i = 0; i < all.size(); i++)
    times.push_back({ sides[i], median(all[i].ms) });
  return times;
}

std::string
plots(const std::vector<Result> &results, const std::vector<GridTime> &grids, cv::Size grid_size)
{
  Plot pixels{ .title = "Picture size", .x_label = "pixels", .y_label = "ms a frame, one thread" };
  for (const Result &result : results) {
    pixels.x_ticks.push_back(result.size.area());
    pixels.x_tick_labels.push_back(size_text(result.size));
  }
  for (const Contender &one : results.front().contenders) {
    if (one.input != "I420" || one.threads != 1)
      continue;
    const bool own
        = one.method.starts_with("tuned") || one.method == "exact" || one.method == "paper";
    Series series{ method_name(one), own };
    for (const Result &result : results)
      series.points.push_back({ static_cast<double>(result.size.area()), result.ms(series.name) });
    pixels.series.push_back(series);
  }
  std::vector<Plot> all{ pixels };

  Plot grid{ .title = "Tactors, " + size_text(grid_size),
             .x_label = "tactors",
             .y_label = "ms a frame, one thread",
             .series = { { "tuned", true } } };
  for (const auto &[side, ms] : grids) {
    grid.x_ticks.push_back(side * side);
    grid.x_tick_labels.push_back(std::to_string(side) + "×" + std::to_string(side));
    grid.series[0].points.push_back({ static_cast<double>(side * side), ms });
  }
  all.push_back(grid);

  if (thread_counts().size() > 1) {
    Plot threads{ .title = "Threads", .x_label = "threads", .y_label = "ms a frame" };
    for (const int count : thread_counts()) {
      threads.x_ticks.push_back(count);
      threads.x_tick_labels.push_back(std::to_string(count));
    }
    for (const Result &result : results)
      for (const char *method : { "tuned", "exact" }) {
        Series series{ std::string(method) + " " + size_text(result.size), true };
        for (const int count : thread_counts())
          series.points.push_back({ static_cast<double>(count), result.ms(method, "I420", count) });
        threads.series.push_back(series);
      }
    all.push_back(threads);
  }
  return svg(all);
}

bool
write(const char *path, const std::string &text)
{
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out)
    std::fprintf(stderr, "speed: cannot write '%s'\n", path);
  return static_cast<bool>(out);
}

bool
report(const Options &options, const std::vector<std::string> &command)
{
  const auto all = sizes(options);
  if (options.stages) {
    stage_table(all, options.quick).write_markdown(std::cout);
    return true;
  }
  const int rounds = options.quick ? 3 : 15;
  std::vector<Result> results;
  std::vector<std::vector<Target>> runs;
  for (int run = 0; run < options.runs; run++) {
    results.clear();
    for (const cv::Size size : all) {
      std::fprintf(stderr, "run %d: %s\n", run + 1, size_text(size).c_str());
      results.push_back({ size, contenders(size) });
      race(results.back().contenders, rounds);
      for (Contender &one : results.back().contenders)
        one.work = {};
    }
    runs.push_back(targets(results));
  }
  std::fprintf(stderr, "instruction sets\n");
  const std::vector<Table> page{ cost_table(results), target_table(all, runs),
                                 instruction_table(all, rounds) };
  std::vector<Table> every;
  for (const Result &result : results)
    every.push_back(race_table(result));
  std::fprintf(stderr, "stages\n");
  every.push_back(stage_table(all, options.quick));

  const cv::Size grid_size = all[all.size() > 2 ? 2 : all.size() - 1];
  const auto grids = grid_times(grid_size, rounds);
  Table grid_table("Tactors, a frame of " + size_text(grid_size), "CPU time of one thread.",
                   { "tactors", "ms" });
  for (const auto &[side, ms] : grids)
    grid_table.add({ std::to_string(side) + "×" + std::to_string(side), milliseconds(ms) });
  every.push_back(grid_table);

  std::ostringstream markdown;
  std::ostringstream csv;
  quality::write_page_head(markdown, "Speed of the analysis", command);
  const auto file_name = [](const char *path) {
    return std::filesystem::path(path).filename().string();
  };
  if (options.csv)
    markdown << "[All methods, formats, threads, stages and grids](" << file_name(options.csv)
             << ") are in a file of their own.\n\n";
  if (options.svg)
    markdown << "![ms a frame against pixels, tactors and threads](" << file_name(options.svg)
             << ")\n\n";
  for (const Table &table : page) {
    table.write_markdown(markdown);
    table.write_csv(csv);
  }
  for (const Table &table : every)
    table.write_csv(csv);
  std::cout << markdown.str();
  for (const quality::Peer peer : quality::kPeers)
    if (!quality::is_available(peer))
      std::fprintf(stderr, "%s left out: run tools/setup.sh quality, then configure again\n",
                   quality::name(peer));
  bool good = true;
  if (options.markdown)
    good &= write(options.markdown, markdown.str());
  if (options.csv)
    good &= write(options.csv, csv.str());
  if (options.svg)
    good &= write(options.svg, plots(results, grids, grid_size));
  return good;
}

} // namespace

int
main(int argc, char **argv)
{
  Options options;
  const std::vector<std::string> command(argv, argv + argc);
  const GOptionEntry entries[] = {
    { "quick", 0, 0, G_OPTION_ARG_NONE, &options.quick, "Fewer rounds", nullptr },
    { "stages", 0, 0, G_OPTION_ARG_NONE, &options.stages, "Print only the time of each stage",
      nullptr },
    { "runs", 0, 0, G_OPTION_ARG_INT, &options.runs, "Runs whose targets are told (1)", "N" },
    { "sizes", 0, 0, G_OPTION_ARG_STRING_ARRAY, &options.sizes,
      "Only this size; may be repeated (640x480, 1000x1000, 1920x1080, 3840x2160)",
      "WIDTHxHEIGHT" },
    { "instruction-set", 0, 0, G_OPTION_ARG_STRING, &options.instruction_set,
      "Use no better instruction set of the CPU than this", "AVX2|SSE4|…" },
    { "markdown", 0, 0, G_OPTION_ARG_FILENAME, &options.markdown, "Write the page", "FILE" },
    { "csv", 0, 0, G_OPTION_ARG_FILENAME, &options.csv, "Write the tables as CSV", "FILE" },
    { "svg", 0, 0, G_OPTION_ARG_FILENAME, &options.svg, "Write how the cost grows as a plot",
      "FILE" },
    { nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr },
  };
  g_autoptr(GOptionContext) context = g_option_context_new("- what the analysis costs");
  g_option_context_set_summary(context,
                               "Prints docs/measured/speed.md; docs/design/speed.md explains it.");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error) || argc > 1) {
    std::fprintf(stderr, "speed: %s; see --help\n",
                 error ? error->message : "expected options alone");
    return 2;
  }
  if (options.runs < 1 || options.runs > 10) {
    std::fprintf(stderr, "speed: expected 1 to 10 runs, got %d\n", options.runs);
    return 2;
  }
  cv::setNumThreads(1);
  try {
    if (options.instruction_set)
      limit_instructions(options.instruction_set);
    return report(options, command) ? 0 : 1;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "speed: %s\n", problem.what());
    return 1;
  }
}
