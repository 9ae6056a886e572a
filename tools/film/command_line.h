// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "translation.h"

#include <glib.h>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// A wrong command line: exit status 2.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// A text option, freed with the object.
struct TextOption
{
  gchar *value = nullptr;

  TextOption() = default;
  explicit TextOption(const char *text) : value(g_strdup(text))
  {
  }
  ~TextOption()
  {
    g_free(value);
  }
  TextOption(const TextOption &) = delete;
  TextOption &operator=(const TextOption &) = delete;

  bool is_set() const
  {
    return value != nullptr;
  }
  std::string text(const char *otherwise = "") const
  {
    return value ? value : otherwise;
  }
};

/// The options that every command of every program takes.
struct CommonOptions
{
  gboolean force = FALSE;
  gboolean quiet = FALSE;
};

/// What a command takes.
struct Usage
{
  static constexpr const char *kOnlyErrors = N_("Print only errors");

  const char *arguments; ///< as in --help
  const char *summary;   ///< likewise, in lines of at most 80 columns
  std::size_t least;     ///< number of arguments
  std::size_t most;
  const char *force_help = N_("No effect in this command");
  const char *quiet_help = kOnlyErrors;
  const GOptionEntry *more = nullptr; ///< entries that several programs share, ended likewise
  gpointer callback_data = nullptr;   ///< for G_OPTION_ARG_CALLBACK
  GOptionGroup *group = nullptr;      ///< of a library, transfer full
};

/// What --help prints, thrown where that is given.
struct Help
{
  std::string text;
};

/// The texts of the program, those of `entries` too, are in the user's language from here on. Reads
/// `entries` (ended by an empty one), --force and --quiet, and returns the other arguments.
/// argv[0] is what to call: a program, or a program and its command. Throws UsageError or Help.
std::vector<std::string> parse_options(int argc, char **argv, const GOptionEntry *entries,
                                       CommonOptions &common, const Usage &usage);

/// Throws UsageError unless the value of an option is from `least` to `most`.
void expect_range(const char *option, double value, double least, double most);

/// Throws UsageError unless the value of an option is one of those known.
void expect_one_of(const char *option, std::string_view value,
                   std::span<const std::string_view> known);

/// A command of a program.
struct Command
{
  const char *name;
  /// Its main(), which begins with parse_options(). Another exception than those of parse_options()
  /// is exit status 1.
  int (*run)(int argc, char **argv);
  const char *summary;
};

/// main() of a program with commands. Its --help has that of each command.
int run_commands(const char *program, std::span<const Command> commands, int argc, char **argv);

/// Prints an error on standard error, in one line whatever the names in it.
void print_error(const char *program, std::string message);
