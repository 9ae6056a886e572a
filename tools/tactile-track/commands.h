// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../manner.h"
#include "../or_throw.h"
#include "tracks/track.h"

#include <glib.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// The sub-commands: main() of each. They return the exit status and throw std::exception for what
/// went wrong (status 1) and
/// UsageError for a wrong command line (status 2).
int author(int argc, char **argv);
int info(int argc, char **argv);
int validate(int argc, char **argv);
int diff(int argc, char **argv);
int convert(int argc, char **argv);
int edit(int argc, char **argv);
int plot(int argc, char **argv);
int preview(int argc, char **argv);
int mux(int argc, char **argv);

class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// What a command is called with.
struct Usage
{
  const char *arguments; ///< this and the summary: for --help
  const char *summary;
  std::size_t least; ///< arguments, and most
  std::size_t most;
  const char *force_means = Manner::kWritesAnyway;
  const char *quiet_means = Manner::kSaysOnlyFaults;
};

/// Reads options, those of `manner` as well, and returns the other arguments. Throws UsageError.
std::vector<std::string> parse_options(int argc, char **argv, const GOptionEntry *entries,
                                       Manner &manner, const Usage &usage);

/// A text option, or what stands for it if it was not given.
struct TextOption
{
  gchar *value = nullptr;

  TextOption() = default;
  ~TextOption()
  {
    g_free(value);
  }
  TextOption(const TextOption &) = delete;
  TextOption &operator=(const TextOption &) = delete;

  bool given() const
  {
    return value != nullptr;
  }
  std::string text(const char *otherwise = "") const
  {
    return value ? value : otherwise;
  }
};

/// Seconds with milliseconds, for people.
std::string seconds(tactile::Time time);

/// "12", "12.5", "-0.04" (seconds) or "1:02:03.5". Throws UsageError naming `option`.
tactile::Time parse_time(const std::string &text, const char *option);

/// The track in the form that the name asks for, under that name only when it is complete.
void write_track_file(const tactile::Track &track, const std::string &path);

/// Where a file is, and its name.
std::pair<std::string, std::string> folder_and_name(const std::string &path);
