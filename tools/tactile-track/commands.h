// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/command_line.h"
#include "film/or_throw.h"
#include "tracks/track.h"

#include <string>
#include <utility>

// The commands: main() of each, see film/command_line.h.
int author(int argc, char **argv);
int info(int argc, char **argv);
int validate(int argc, char **argv);
int diff(int argc, char **argv);
int convert(int argc, char **argv);
int edit(int argc, char **argv);
int plot(int argc, char **argv);
int preview(int argc, char **argv);
int mux(int argc, char **argv);
int extract(int argc, char **argv);
int stream_hls(int argc, char **argv);
int find(int argc, char **argv);
int make_index(int argc, char **argv);
int learn(int argc, char **argv);
int desk(int argc, char **argv);

/// Seconds with three decimals.
std::string seconds(tactile::Time time);

/// "12", "12.5", "-0.04" (seconds) or "1:02:03.5". Throws UsageError naming `option`.
tactile::Time parse_time(const std::string &text, const char *option);

/// Writes a track in the format that the file name's ending selects. The file appears under its
/// name when it is complete. `made_with`: of a draft (lib/tracks/formats/draft_note.h).
void write_track_file(const tactile::Track &track, const std::string &path,
                      const std::string &made_with = "");

/// Writes a file in the same way.
void write_bytes(const std::string &bytes, const std::string &path);

/// The folder, "." where the path has none, and the name of a file to write, to which a link leads.
std::pair<std::string, std::string> folder_and_name(const std::string &path);

/// Throws UsageError if the output would overwrite the film.
void refuse_same_file(const std::string &film, const std::string &output);

/// The path of a film's file, which may be given as its URI. Throws std::runtime_error.
std::string film_path(const std::string &name);
