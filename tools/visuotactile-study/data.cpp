// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Commands that read and write the data.
#include "commands.h"

#include "files/whole_file.h"
#include "film/command_line.h"
#include "film/or_throw.h"
#include "study/folder.h"
#include "study/simulation.h"
#include "study/table.h"
#include "translation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

namespace {

using study::Folder;
using study::Participant;
using study::Step;

std::string
marks_of(const Participant &participant)
{
  std::string text;
  for (int session = 1; session <= participant.sessions(); session++)
    for (const std::string &mark : participant.marks(session))
      text += " " + std::to_string(session) + ":" + mark;
  return text;
}

constexpr const char *kProgram = "visuotactile-study";

} // namespace

void
write_private(const std::string &path, const std::string &text)
{
  const std::string warning = or_throw(files::replace_file(path, text, files::Readers::user));
  if (!warning.empty())
    print_error(kProgram, warning);
}

std::string
expect_factor(const TextOption &factor, const study::Study &study)
{
  const std::string wanted
      = factor.text(study.factors.empty() ? "" : study.factors.front().name.c_str());
  if ((factor.is_set() || !study.factors.empty())
      && std::ranges::find(study.factors, wanted, &study::Factor::name) == study.factors.end())
    throw UsageError(in_text("expected --factor=NAME, a factor of the study, got '{}'", wanted));
  return wanted;
}

void
print_damaged(const char *program, const Folder &folder)
{
  for (const auto &[name, why] : folder.damaged())
    print_error(program, in_text("{} is left out: {}; put back a copy of the file, or forget the "
                                 "participant: the next one who starts has the same order",
                                 name, why));
}

int
print_status(int argc, char **argv)
{
  CommonOptions common;
  gboolean orders = FALSE;
  const GOptionEntry entries[] = {
    { "orders", 0, 0, G_OPTION_ARG_NONE, &orders, N_("Print the order of conditions, as CSV"),
      nullptr },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary
        = N_("Prints the place and state of each participant, and the marks of sessions: repeated, "
             "late,\ndropped-frames, chair (the chair reported a fault), stopped, failed, "
             "interrupted,\nnot-shown, no-commands, no-noise, simulated."),
        .least = 1,
        .most = 1 });
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::reads));
  if (orders) {
    std::fputs(study::order_table(*folder).c_str(), stdout);
    return 0;
  }
  print_damaged(kProgram, *folder);
  unsigned done = 0;
  const Participant *first = nullptr;
  std::string other_studies;
  for (const auto &one : folder->participants()) {
    done += one->state() == Participant::State::done ? 1 : 0;
    if (one->state() == Participant::State::forgotten) {
      std::printf("%-6s %s\n", one->name().c_str(), name_of(one->state()));
      continue; // it had a study and a place
    }
    std::printf(_("%-6s %-9s group %zu row %2zu  %zu of %zu steps%s%s\n"), one->name().c_str(),
                name_of(one->state()), one->place().group + 1, one->place().row + 1,
                one->steps_done(), one->steps().size() - 1,
                marks_of(*one).empty() ? "" : "  marked:", marks_of(*one).c_str());
    first = first ? first : one.get();
    if (one->study_sum() != first->study_sum())
      other_studies += " " + one->name();
  }
  for (const auto &[name, why] : folder->damaged())
    std::printf(_("%-6s damaged\n"), name.c_str());
  std::printf(_("%u of %u people have finished\n"), done, folder->study().people);
  if (!other_studies.empty())
    std::printf(
        _("study.ini was changed between participants; with another one than the first:%s\n"),
        other_studies.c_str());
  return 0;
}

int
export_table(int argc, char **argv)
{
  CommonOptions common;
  TextOption output{ "answers.csv" };
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The file to write (default: answers.csv)"), "FILE" },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary
        = N_("Writes all answers as CSV. The row of an answer has participant and levels, and "
             "the\nsettings, versions, command trace, timing error and marks of its session."),
        .least = 1,
        .most = 1,
        .force_help = N_("Replace an existing file") });
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::reads));
  print_damaged(kProgram, *folder);
  std::error_code error;
  if (!common.force && std::filesystem::exists(output.text(), error))
    throw std::runtime_error(
        in_text("'{}' exists; expected another name with --output, or --force", output.text()));
  write_private(output.text(), study::answer_table(*folder));
  if (!common.quiet)
    std::printf(_("written: %s\n"), output.text().c_str());
  return 0;
}

int
simulate(int argc, char **argv)
{
  CommonOptions common;
  gint people = 0;
  gint seed = 1;
  gdouble effect = 15;
  gdouble spread = 15;
  TextOption factor;
  const GOptionEntry entries[] = {
    { "people", 0, 0, G_OPTION_ARG_INT, &people,
      N_("Number of participants (default: the study's)"), "N" },
    { "seed", 0, 0, G_OPTION_ARG_INT, &seed, N_("Seed of the answers (default: 1)"), "N" },
    { "factor", 0, 0, G_OPTION_ARG_STRING, &factor.value,
      N_("The factor that has an effect (default: the first)"), "NAME" },
    { "effect", 0, 0, G_OPTION_ARG_DOUBLE, &effect,
      N_("Difference between the last and the first level of the factor (default: 15)"), "POINTS" },
    { "spread", 0, 0, G_OPTION_ARG_DOUBLE, &spread,
      N_("Standard deviation of answers, and of participants (default: 15)"), "POINTS" },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Writes data of simulated participants to a study that has no data, to try "
                      "export and\nreport before the first real participant. No film is played."),
        .least = 1,
        .most = 1 });
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::writes));
  if (!folder->participants().empty() || !folder->damaged().empty())
    throw std::runtime_error(
        in_text("'{}' has data; expected a study without participants", arguments[0]));
  expect_range("--people", people, 0, 1000);
  if (!std::isfinite(effect))
    throw UsageError(_("--effect is a number"));
  if (!std::isfinite(spread) || spread < 0)
    throw UsageError(_("--spread is a number from 0"));
  expect_factor(factor, folder->study());
  study::Simulation simulation{ .seed = static_cast<std::uint64_t>(seed),
                                .factor = factor.text(),
                                .effect = effect,
                                .spread = spread };
  const auto count = people > 0 ? static_cast<unsigned>(people) : folder->study().people;
  for (unsigned i = 0; i < count; i++)
    or_throw(study::simulate_participant(*folder, simulation));
  if (!common.quiet)
    std::printf(_("written: %u participants in %s\n"), count, folder->data("").c_str());
  return 0;
}

int
forget(int argc, char **argv)
{
  CommonOptions common;
  const GOptionEntry none[] = { {} };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, none, common,
      { .arguments = "FOLDER PARTICIPANT",
        .summary = N_("Removes all answers and command traces of a participant, such as P03, at "
                      "once. The next\nparticipant gets this place. Earlier exports and reports "
                      "still contain the answers."),
        .least = 2,
        .most = 2 });
  const auto folder = or_throw(Folder::open(arguments[0], Folder::Use::writes));
  or_throw(folder->forget(arguments[1]));
  if (!common.quiet)
    std::printf(_("%s is forgotten; remove exports and reports that were written before\n"),
                arguments[1].c_str());
  return 0;
}
