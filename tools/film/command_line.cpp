// SPDX-License-Identifier: LGPL-2.1-or-later
#include "command_line.h"

#include "program.h"
#include "translation.h"

#include <algorithm>
#include <clocale>
#include <cstdio>
#include <numeric>
#include <string_view>
#include <utility>

namespace {

/// GLib's help text in the form that help2man reads.
std::string
help_text(GOptionContext *context)
{
  g_autofree gchar *own = g_option_context_get_help(context, TRUE, nullptr);
  std::string text = own;
  const auto replace = [&text](std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
      text.replace(at, what.size(), by);
  };
  const auto glib = [](const char *own) -> std::string {
    return g_dgettext("glib20", own);
  };
  replace(glib("Usage:") + "\n  ", std::string(_("Usage:")) + " ");
  const std::string heading = std::string("\n") + _("Options:") + "\n";
  for (const char *own : { "Application Options:", "Options:" }) // with --help-all, and without
    replace("\n" + glib(own) + "\n", heading);
  replace("…", "...");
  text.erase(text.find_last_not_of('\n') + 2);
  return text;
}

/// Texts in the user's language, from here on. Sets no other part of the locale.
void
use_translations()
{
  const char *folder = g_getenv("VISUOTACTILE_LOCALE"); // of a build that is not installed
  std::setlocale(LC_CTYPE, "");
  std::setlocale(LC_MESSAGES, "");
  bindtextdomain(PACKAGE, folder != nullptr ? folder : LOCALE_DIR);
  bind_textdomain_codeset(PACKAGE, "UTF-8");
  textdomain(PACKAGE); // without it, GLib translates nothing
}

bool
wants_help(int argc, char **argv)
{
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; i++)
    if (std::string_view(argv[i]) == "--help" || std::string_view(argv[i]) == "-h")
      return true;
  return false;
}

/// The parts of a command's --help.
struct CommandHelp
{
  std::string usage; ///< without the word
  std::string summary;
  std::string options; ///< without the heading
};

CommandHelp
help_of(const char *program, const Command &command)
{
  std::string name = std::string(program) + " " + command.name;
  std::string option = "--help";
  char *arguments[] = { name.data(), option.data(), nullptr };
  try {
    command.run(2, arguments);
  } catch (const Help &help) {
    const std::size_t usage = std::string_view(_("Usage:")).size() + 1;
    const std::string heading = std::string("\n\n") + _("Options:") + "\n";
    const std::size_t summary = help.text.find("\n\n");
    const std::size_t options = help.text.find(heading);
    return { .usage = help.text.substr(usage, summary - usage),
             .summary = help.text.substr(summary + 2, options - summary - 2),
             .options = help.text.substr(options + heading.size()) };
  }
  return {};
}

/// Levenshtein distance: letters to insert, remove or replace.
std::size_t
distance(std::string_view a, std::string_view b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{ 0 });
  for (std::size_t i = 0; i < a.size(); i++) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); j++)
      diagonal = std::exchange(
          row[j + 1], std::min({ row[j] + 1, row[j + 1] + 1, diagonal + (a[i] == b[j] ? 0 : 1) }));
  }
  return row.back();
}

/// The commands whose names are near to a wrong one, or all.
std::string
suggestion(std::span<const Command> commands, const std::string &wrong)
{
  constexpr std::size_t kNear = 2;
  std::string near;
  std::string all;
  for (const Command &command : commands) {
    all += (all.empty() ? "" : ", ") + std::string(command.name);
    if (distance(wrong, command.name) <= kNear)
      near += (near.empty() ? "" : _(" or ")) + ("'" + std::string(command.name) + "'");
  }
  return near.empty() ? in_text("expected one of {}", all) : in_text("did you mean {}?", near);
}

void
print_summary(std::span<const Command> commands, std::FILE *file)
{
  std::fprintf(file, "%s\n", _("Commands:"));
  for (const Command &command : commands)
    std::fprintf(file, "  %-9s %s\n", command.name, _(command.summary));
}

void
print_help(const char *program, std::span<const Command> commands)
{
  std::string usages;
  std::string sections;
  for (const Command &command : commands) {
    const CommandHelp help = help_of(program, command);
    usages += (usages.empty() ? std::string(_("Usage:")) + " " : _("   or: ")) + help.usage + "\n";
    sections += std::string("\n") + program + " " + command.name + ":\n";
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
      end = help.summary.find('\n', begin);
      sections += "  " + help.summary.substr(begin, end - begin) + "\n";
    }
    sections += "\n" + help.options;
  }
  std::printf("%s\n", usages.c_str());
  print_summary(commands, stdout);
  std::fputs(sections.c_str(), stdout);
}

} // namespace

std::vector<std::string>
parse_options(int argc, char **argv, const GOptionEntry *entries, CommonOptions &common,
              const Usage &usage)
{
  use_translations();
  g_auto(GStrv) rest = nullptr;
  const GOptionEntry common_entries[]
      = { { "force", 'f', 0, G_OPTION_ARG_NONE, &common.force, usage.force_help, nullptr },
          { "quiet", 'q', 0, G_OPTION_ARG_NONE, &common.quiet, usage.quiet_help, nullptr },
          { G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &rest, nullptr, nullptr },
          {} };
  g_autoptr(GOptionContext) context = g_option_context_new(usage.arguments);
  GOptionGroup *group = g_option_group_new("main", "Options:", "", usage.callback_data, nullptr);
  g_option_group_set_translation_domain(group, PACKAGE);
  g_option_group_add_entries(group, entries);
  if (usage.more)
    g_option_group_add_entries(group, usage.more);
  g_option_group_add_entries(group, common_entries);
  g_option_context_set_main_group(context, group);
  g_option_context_set_help_enabled(context, usage.group != nullptr); // for --help-all
  if (usage.group)
    g_option_context_add_group(context, usage.group);
  g_option_context_set_summary(context, _(usage.summary));
  g_autofree gchar *name = g_path_get_basename(argv[0]);
  g_set_prgname(name);
  if (wants_help(argc, argv))
    throw Help{ help_text(context) };
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error))
    throw UsageError(error->message);
  std::vector<std::string> arguments;
  for (gchar **argument = rest; argument && *argument; argument++)
    arguments.emplace_back(*argument);
  if (arguments.size() < usage.least || arguments.size() > usage.most)
    throw UsageError(in_text("expected {}", usage.arguments));
  return arguments;
}

void
expect_range(const char *option, double value, double least, double most)
{
  if (value >= least && value <= most)
    return;
  g_autofree gchar *text = g_strdup_printf(_("%s is a number from %.10g to %.10g, got %.10g"),
                                           option, least, most, value);
  throw UsageError(text);
}

void
expect_one_of(const char *option, std::string_view value, std::span<const std::string_view> known)
{
  if (std::ranges::find(known, value) != known.end())
    return;
  std::string names;
  for (const std::string_view name : known)
    names += (names.empty() ? "" : ", ") + std::string(name);
  throw UsageError(in_text("{} is one of {}, got '{}'", option, names, value));
}

int
run_commands(const char *program, std::span<const Command> commands, int argc, char **argv)
{
  use_translations();
  const std::string name = argc > 1 ? argv[1] : "";
  if (name.empty()) {
    std::fprintf(stderr, "%s %s COMMAND [OPTION...] ...\n\n", _("Usage:"), program);
    print_summary(commands, stderr);
    return 2;
  }
  if (name == "--help" || name == "-h" || name == "help") {
    print_help(program, commands);
    return 0;
  }
  if (name == "--version") {
    std::printf("%s %s\n", program, PACKAGE_VERSION);
    return 0;
  }
  const auto command
      = std::ranges::find_if(commands, [&](const Command &known) { return name == known.name; });
  if (command == commands.end()) {
    print_error(program, in_text("there is no command '{}'; {}", name, suggestion(commands, name)));
    return 2;
  }
  std::string program_and_name = std::string(program) + " " + name;
  argv[1] = program_and_name.data();
  try {
    return command->run(argc - 1, argv + 1);
  } catch (const Help &help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const UsageError &error) {
    print_error(program, in_text("{}: {}; see {} --help", name, error.what(), program_and_name));
    return 2;
  } catch (const Stopped &) {
    return 130;
  } catch (const std::exception &error) {
    print_error(program, error.what());
    return 1;
  }
}

void
print_error(const char *program, std::string message)
{
  std::ranges::replace_if(
      message, [](char c) { return g_ascii_iscntrl(c); }, ' ');
  std::fprintf(stderr, "%s: %s\n", program, message.c_str());
}
