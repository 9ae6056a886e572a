// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactile-track: tactile tracks of films, from the first draft to the film that carries them.
#include "commands.h"

#include "files/replace.h"
#include "film/output.h"
#include "tracks/formats/draft_note.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace {

constexpr std::array kCommands = {
  Command{ "author", author, N_("make tracks of films") },
  Command{ "info", info, N_("print grid, length and events of tracks") },
  Command{ "convert", convert, N_("convert a track to another format") },
  Command{ "edit", edit,
           N_("prune, merge, limit, shift, scale, clip, mask, quantize, resample, overlay") },
  Command{ "diff", diff, N_("print where two tracks differ") },
  Command{ "plot", plot, N_("draw a track over time as PNG or SVG") },
  Command{ "preview", preview, N_("play or record a film with a track") },
  Command{ "mux", mux, N_("copy a film's file and add a track") },
  Command{ "extract", extract, N_("copy the track of a film's file to its own file") },
  Command{ "hls", stream_hls, N_("add a track to a film that is streamed by HLS") },
#ifdef HAVE_LIBRARY
  Command{ "find", find, N_("find the track of a film in a library") },
  Command{ "index", make_index, N_("list the tracks of a folder for find") },
  Command{ "learn", learn, N_("make the entry by which a film is recognized by its sound") },
#endif
#ifdef DESK_PROGRAM
  Command{ "desk", desk, N_("edit a track beside its film, in a browser") },
#endif
  Command{ "validate", validate, N_("check that files are tracks") },
};

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
    throw UsageError(
        in_text("{}: expected seconds, or H:MM:SS.mmm, up to 100 hours, got '{}'", option, text));
  const tactile::Time time(std::llround(value * 1e9));
  return negative ? -time : time;
}

std::pair<std::string, std::string>
folder_and_name(const std::string &path)
{
  const std::string target = files::target_of(path);
  return { files::folder_of(target), std::filesystem::path(target).filename().string() };
}

void
refuse_same_file(const std::string &film, const std::string &output)
{
  std::error_code none;
  if (std::filesystem::equivalent(film, output, none))
    throw UsageError(in_text("'{}' is the film itself; give another name", output));
}

std::string
film_path(const std::string &name)
{
  std::error_code error;
  if (std::filesystem::is_regular_file(name, error))
    return name;
  g_autofree gchar *path = g_filename_from_uri(name.c_str(), nullptr, nullptr);
  if (path != nullptr && std::filesystem::is_regular_file(path, error))
    return path;
  throw std::runtime_error(in_text("there is no film '{}'; give the path of a film's file", name));
}

void
write_track_file(const tactile::Track &track, const std::string &path, const std::string &made_with)
{
  std::string bytes = tactile::write_track(track, or_throw(tactile::written_format(path)), date());
  if (!made_with.empty())
    bytes = tactile::with_draft_note(std::move(bytes), made_with);
  write_bytes(bytes, path);
}

void
write_bytes(const std::string &bytes, const std::string &path)
{
  const auto [folder, name] = folder_and_name(path);
  Output output(folder, name);
  std::ofstream file(output.part_path(), std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
    throw std::runtime_error(in_text("cannot write '{}': {}", path, g_strerror(errno)));
  output.commit();
}

int
main(int argc, char **argv)
{
  return run_commands("tactile-track", kCommands, argc, argv);
}
