// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Commands that R computes.
#include "commands.h"

#include "files/whole_file.h"
#include "film/command_line.h"
#include "film/or_throw.h"
#include "film/output.h"
#include "film/program.h"
#include "study/folder.h"
#include "study/table.h"
#include "translation.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace {

using study::Factor;
using study::Folder;

constexpr const char *kDictionary = "/dictionary.tsv";

std::string
script(const char *name)
{
  const char *set = g_getenv("VISUOTACTILE_STUDY_R");
  return std::string(set ? set : STUDY_R) + "/" + name;
}

/// Runs a script and prints its output.
int
run_r(std::vector<std::string> arguments, bool quiet)
{
  arguments.insert(arguments.begin(), { "Rscript", "--vanilla" });
  const ProgramEnd end
      = run_program(arguments, "r-base-core; report also needs r-cran-afex and r-cran-emmeans",
                    [quiet](std::string_view line) {
                      if (!quiet)
                        std::printf("%.*s\n", static_cast<int>(line.size()), line.data());
                    });
  if (end.status != 0)
    throw std::runtime_error(end.complaint.empty() ? "R failed" : end.complaint);
  return 0;
}

/// Throws std::runtime_error if a file of the report would replace one that is of no earlier report
/// of the study.
void
expect_own_folder(const std::string &folder, const std::string &dictionary)
{
  const std::string title
      = dictionary.substr(0, dictionary.find('\n', dictionary.find('\n') + 1) + 1);
  const auto earlier = files::read_whole(folder + kDictionary, study::kMostText);
  if (earlier && earlier->starts_with(title))
    return;
  g_autoptr(GDir) entries = g_dir_open(folder.c_str(), 0, nullptr);
  if (entries != nullptr && g_dir_read_name(entries) != nullptr)
    throw std::runtime_error(in_text("'{}' has other files than a report of this study; expected "
                                     "an empty folder with --output, or --force",
                                     folder));
}

/// The study's factors, levels and questions for R: name, kind, label.
std::string
dictionary(const study::Study &study)
{
  std::string text = "what\tname\tof\tlabel\n";
  const auto add = [&text](const char *what, const std::string &name, const std::string &of,
                           std::string label) {
    for (char &c : label)
      if (c == '\t' || c == '\n' || c == '"')
        c = ' ';
    text += std::string(what) + "\t" + name + "\t" + of + "\t" + label + "\n";
  };
  add("title", "", "", study.title);
  add("values", "", "", study.description);
  for (const Factor &factor : study.factors) {
    add(factor.between ? "between" : "within", factor.name, "", factor.label);
    for (const study::Level &level : factor.levels)
      add("level", level.name, factor.name, level.label);
  }
  for (const study::Question &question : study.questions)
    add("question", question.name, name_of(question.kind), question.text);
  for (const study::Question &question : study.questions) {
    const bool is_likert = question.kind == study::Question::Kind::likert;
    add("scale", question.name, "",
        study::write_number(is_likert ? 1 : question.low) + " "
            + study::write_number(is_likert ? static_cast<double>(question.labels.size())
                                            : question.high));
  }
  return text;
}

} // namespace

int
write_report(int argc, char **argv)
{
  CommonOptions common;
  TextOption output;
  gboolean with_marked = FALSE;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("Folder for report.html, report.pdf, figure.png and answers.csv (default: FOLDER/report)"),
      "DIR" },
    { "with-marked", 0, 0, G_OPTION_ARG_NONE, &with_marked,
      N_("Also use marked sessions, such as late ones"), nullptr },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Analyzes with R (packages r-cran-afex and r-cran-emmeans) the answers of "
                      "participants who\nhave finished: analysis of variance with effect sizes, "
                      "comparisons of levels, and a figure,\nbeside the results in published.csv. "
                      "The report names marked sessions and leaves them out."),
        .least = 1,
        .most = 1,
        .force_help = N_("Also replace files that no earlier report of the study wrote") });
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::reads));
  print_damaged("visuotactile-study report", *folder);
  const std::string to = output.text((folder->path() + "/report").c_str());
  const std::string words = dictionary(folder->study());
  prepare_directory(to);
  if (!common.force)
    expect_own_folder(to, words);
  for (const auto &[name, text] :
       { std::pair{ "/answers.csv", study::answer_table(*folder) },
         std::pair{ "/orders.csv", study::order_table(*folder) }, std::pair{ kDictionary, words } })
    write_private(to + name, text);
  run_r({ script("report.R"), to, folder->path() + "/published.csv",
          with_marked ? "with-marked" : "without-marked" },
        common.quiet);
  if (!common.quiet)
    std::printf(_("written: %s/report.html, %s/report.pdf\n"), to.c_str(), to.c_str());
  return 0;
}

int
compute_power(int argc, char **argv)
{
  CommonOptions common;
  TextOption factor;
  gdouble effect = 15;
  gdouble spread = 15;
  gdouble correlation = 0.5;
  gdouble power = 0.8;
  gint studies = 1000;
  gint seed = 1;
  const GOptionEntry entries[] = {
    { "factor", 0, 0, G_OPTION_ARG_STRING, &factor.value,
      N_("The factor that has an effect (default: the first)"), "NAME" },
    { "effect", 0, 0, G_OPTION_ARG_DOUBLE, &effect,
      N_("Difference between the last and the first level of the factor (default: 15)"), "POINTS" },
    { "spread", 0, 0, G_OPTION_ARG_DOUBLE, &spread,
      N_("Standard deviation of ratings in a condition (default: 15)"), "POINTS" },
    { "correlation", 0, 0, G_OPTION_ARG_DOUBLE, &correlation,
      N_("Correlation of a participant's ratings in two conditions, 0 to 0.99 (default: 0.5)"),
      "R" },
    { "power", 0, 0, G_OPTION_ARG_DOUBLE, &power,
      N_("Required chance to find the effect, 0.05 to 0.99 (default: 0.8)"), "CHANCE" },
    { "studies", 0, 0, G_OPTION_ARG_INT, &studies,
      N_("Number of simulated studies for each number of people, 100 to 100000 (default: 1000)"),
      "N" },
    { "seed", 0, 0, G_OPTION_ARG_INT, &seed, N_("Seed of the simulation (default: 1)"), "N" },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Computes how many people a study needs to find an effect at the 5 % level, "
                      "by simulated\nstudies with R (package r-base-core)."),
        .least = 1,
        .most = 1 });
  if (!std::isfinite(effect))
    throw UsageError(_("--effect is a number"));
  if (!(spread > 0 && std::isfinite(spread)))
    throw UsageError(_("--spread is a number above 0"));
  expect_range("--correlation", correlation, 0, 0.99);
  expect_range("--power", power, 0.05, 0.99);
  expect_range("--studies", studies, 100, 100000);
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::reads));
  std::vector<std::string> words{ script("power.R") };
  for (const double number : { effect, spread, correlation, power })
    words.push_back(study::write_number(number));
  words.push_back(std::to_string(studies));
  words.push_back(std::to_string(seed));
  const std::string wanted = expect_factor(factor, folder->study());
  if (wanted.empty())
    throw std::runtime_error(_("the study has no factor; expected one in study.ini"));
  for (const Factor &one : folder->study().factors)
    words.push_back(one.name + ":" + std::to_string(one.levels.size()) + ":"
                    + (one.between ? "between" : "within") + ":"
                    + (one.name == wanted ? "effect" : "none"));
  return run_r(words, common.quiet);
}
