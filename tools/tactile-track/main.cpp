// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactile-track: tactile tracks of films, from the first draft to the film that carries them.
#include "commands.h"

#include "../visuotactile-play/output.h"
#include "tracks/formats/track_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace {

struct Command
{
  const char *name;
  int (*run)(int, char **);
  const char *what;
};

constexpr std::array kCommands = {
  Command{ "author", author, "make tracks of films" },
  Command{ "info", info, "say what is in a track" },
  Command{ "convert", convert, "write a track in another form" },
  Command{ "edit", edit, "prune, merge, limit, shift, scale, clip, mask, resample, overlay" },
  Command{ "diff", diff, "say where two tracks differ" },
  Command{ "plot", plot, "draw a track over time, as PNG or SVG" },
  Command{ "preview", preview, "play or record a film with a track" },
  Command{ "mux", mux, "put a track into a film's file" },
  Command{ "validate", validate, "say whether files are tracks" },
};

void
print_help(std::FILE *file)
{
  std::fputs("Usage: tactile-track COMMAND [OPTION...] ...\n\nCommands:\n", file);
  for (const Command &command : kCommands)
    std::fprintf(file, "  %-9s %s\n", command.name, command.what);
  std::fputs("\nAll take --force (-f) and --quiet (-q). 'tactile-track COMMAND --help' tells of "
             "each. Tracks are .vtt, .csv, .hjif, .sem.xml "
             "and (to write) .funscript.\n",
             file);
}

/// Every error is one line, whatever the names in it.
int
complain(std::string message, int status)
{
  std::ranges::replace_if(
      message, [](char c) { return g_ascii_iscntrl(c); }, ' ');
  std::fprintf(stderr, "tactile-track: %s\n", message.c_str());
  return status;
}

/// Now, or what SOURCE_DATE_EPOCH says, so that the same track makes the same file.
std::string
date()
{
  const char *epoch = g_getenv("SOURCE_DATE_EPOCH");
  const gint64 now = epoch ? g_ascii_strtoll(epoch, nullptr, 10) : std::time(nullptr);
  g_autoptr(GDateTime) time = g_date_time_new_from_unix_utc(now);
  g_autofree gchar *text = time ? g_date_time_format(time, "%Y-%m-%dT%H:%M:%S+00:00") : nullptr;
  return text ? text : "1970-01-01T00:00:00+00:00";
}

} // namespace

std::vector<std::string>
parse_options(int argc, char **argv, const GOptionEntry *entries, Manner &manner,
              const Usage &usage)
{
  gchar **rest = nullptr;
  const GOptionEntry remaining[]
      = { { G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &rest, nullptr, nullptr }, {} };
  const auto common = manner.entries(usage.force_means, usage.quiet_means);
  g_autoptr(GOptionContext) context = g_option_context_new(usage.arguments);
  g_option_context_set_summary(context, usage.summary);
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_main_entries(context, common.data(), nullptr);
  g_option_context_add_main_entries(context, remaining, nullptr);
  g_autoptr(GError) error = nullptr;
  const std::string command = std::string("tactile-track ") + argv[0];
  g_set_prgname(command.c_str());
  const bool parsed = g_option_context_parse(context, &argc, &argv, &error);
  std::vector<std::string> names;
  for (gchar **name = rest; name && *name; name++)
    names.emplace_back(*name);
  g_strfreev(rest);
  if (!parsed)
    throw UsageError(error->message);
  if (names.size() < usage.least || names.size() > usage.most)
    throw UsageError(std::string("expected ") + usage.arguments);
  return names;
}

std::string
seconds(tactile::Time time)
{
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.3f", std::chrono::duration<double>(time).count());
  return text.data();
}

tactile::Time
parse_time(const std::string &text, const char *option)
{
  const bool negative = text.starts_with('-');
  double value = 0;
  int parts = 0;
  const char *begin = text.c_str() + (negative || text.starts_with('+') ? 1 : 0);
  const char *end = text.c_str() + text.size();
  bool valid = true;
  while (valid) {
    double part = 0;
    const auto [stop, error] = std::from_chars(begin, end, part, std::chars_format::fixed);
    valid = error == std::errc() && part >= 0 && ++parts <= 3;
    value = value * 60 + part;
    if (stop == end)
      break;
    valid = valid && *stop == ':';
    begin = stop + 1;
  }
  if (!valid || !(value <= 360'000))
    throw UsageError(std::string(option)
                     + ": expected seconds, or H:MM:SS.mmm, up to 100 hours, got '" + text + "'");
  const tactile::Time time(std::llround(value * 1e9));
  return negative ? -time : time;
}

std::pair<std::string, std::string>
folder_and_name(const std::string &path)
{
  const std::filesystem::path whole(path);
  const std::string folder = whole.parent_path().string();
  return { folder.empty() ? "." : folder, whole.filename().string() };
}

void
write_track_file(const tactile::Track &track, const std::string &path)
{
  const std::string bytes
      = tactile::write_track(track, or_throw(tactile::track_format(path)), date());
  const auto [folder, name] = folder_and_name(path);
  Output output(folder, name);
  std::ofstream file(output.part_path(), std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
    throw std::runtime_error("cannot write '" + path + "': " + g_strerror(errno));
  output.commit();
}

int
main(int argc, char **argv)
{
  if (argc < 2) {
    print_help(stderr);
    return 2;
  }
  const std::string name = argv[1];
  if (name == "--help" || name == "-h" || name == "help") {
    print_help(stdout);
    return 0;
  }
  if (name == "--version") {
    std::puts("tactile-track " PACKAGE_VERSION);
    return 0;
  }
  const auto *command
      = std::ranges::find_if(kCommands, [&](const Command &known) { return name == known.name; });
  if (command == kCommands.end())
    return complain("there is no command '" + name + "'; see tactile-track --help", 2);
  try {
    return command->run(argc - 1, argv + 1);
  } catch (const UsageError &error) {
    return complain(name + ": " + error.what() + "; see tactile-track " + name + " --help", 2);
  } catch (const std::exception &error) {
    return complain(error.what(), 1);
  }
}
