// SPDX-License-Identifier: LGPL-2.1-or-later
//
// info, validate, diff: the contents of tracks.
#include "commands.h"

#include "tracks/formats/track_file.h"
#include "tracks/track_edit.h"
#include "translation.h"

#include <algorithm>
#include <cstdio>
#include <limits>

using tactile::Time;
using tactile::Track;

namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

void
print_info(const std::string &path, const Track &track)
{
  const auto &entries = track.entries();
  const std::size_t cells = entries.front().map.levels.size();
  std::vector<double> felt(cells, 0);
  std::vector<int> events(cells, 0);
  double any = 0;
  float strongest = 0;
  for (std::size_t i = 0; i < entries.size(); i++) {
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    const double length = std::chrono::duration<double>(end - entries[i].time).count();
    any += is_silent(entries[i].map) ? 0 : length;
    for (std::size_t cell = 0; cell < cells; cell++) {
      const float level = entries[i].map.levels[cell];
      strongest = std::max(strongest, level);
      felt[cell] += level > 0 ? length : 0;
      events[cell] += level > 0 && (i == 0 || !(entries[i - 1].map.levels[cell] > 0));
    }
  }
  const double length = std::chrono::duration<double>(track.end()).count();
  std::printf(_("Track     %s\n"), path.c_str());
  std::printf(_("Grid      %d x %d"), track.rows(), track.columns());
  if (track.rate() > 0)
    std::printf(_(", authored at %g Hz"), track.rate());
  std::printf(_("\nLength    %.3f s, %zu changes\n"), length, entries.size() - 1);
  std::printf(_("Felt      %.3f s (%.0f %%), up to %.0f %% of full scale\n"), any,
              length > 0 ? 100 * any / length : 0, 100 * static_cast<double>(strongest));
  std::printf(_("Cells     events, share of the time\n"));
  for (int row = 0; row < track.rows(); row++) {
    std::printf("         ");
    for (int column = 0; column < track.columns(); column++) {
      const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(track.columns())
                        + static_cast<std::size_t>(column);
      std::printf(" %5d %3.0f%%", events[cell], length > 0 ? 100 * felt[cell] / length : 0);
    }
    std::printf("\n");
  }
}

} // namespace

int
info(int argc, char **argv)
{
  CommonOptions common;
  const GOptionEntry entries[] = { {} };
  const std::vector<std::string> tracks
      = parse_options(argc, argv, entries, common,
                      { .arguments = "TRACK...",
                        .summary = N_("Prints grid, length and events of tracks."),
                        .least = 1,
                        .most = kAny });
  for (const std::string &path : tracks) {
    const Track track = or_throw(tactile::read_track_file(path));
    if (!common.quiet)
      print_info(path, track);
  }
  return 0;
}

int
validate(int argc, char **argv)
{
  CommonOptions common;
  const GOptionEntry entries[] = { {} };
  const std::vector<std::string> tracks = parse_options(
      argc, argv, entries, common,
      { .arguments = "TRACK...",
        .summary = N_("Checks that files are tracks, and prints the first error of each file that "
                      "is not.\nThe exit status is 0 if all are valid, else 1."),
        .least = 1,
        .most = kAny,
        .quiet_help = N_("Print only invalid tracks") });
  int status = 0;
  for (const std::string &path : tracks) {
    const tl::expected<Track, tactile::FormatError> track = tactile::read_track_file(path);
    if (track && common.quiet)
      continue;
    if (track) {
      std::printf(_("%s: valid, %d x %d, %s s\n"), path.c_str(), track->rows(), track->columns(),
                  seconds(track->end()).c_str());
    } else {
      std::printf(_("invalid: %s\n"), track.error().text().c_str());
      status = 1;
    }
  }
  return status;
}

int
diff(int argc, char **argv)
{
  CommonOptions common;
  gdouble tolerance = 0;
  const GOptionEntry entries[] = { { "tolerance", 't', 0, G_OPTION_ARG_DOUBLE, &tolerance,
                                     N_("Ignore differences of levels up to PERCENT and, unless "
                                        "this is 0, of frequencies up to 0.5 Hz (default: 0)"),
                                     "PERCENT" },
                                   {} };
  const std::vector<std::string> tracks = parse_options(
      argc, argv, entries, common,
      { .arguments = "BEFORE AFTER",
        .summary = N_("Prints where two tracks differ: a line for each interval, with the levels "
                      "of cells in percent.\nThe exit status is 0 if they are the same, 1 if they "
                      "differ, 2 if they cannot be compared."),
        .least = 2,
        .most = 2,
        .quiet_help = N_("Print nothing; only the exit status shows whether they differ") });
  std::vector<tactile::Difference> differences;
  try {
    differences = or_throw(tactile::diff(or_throw(tactile::read_track_file(tracks[0])),
                                         or_throw(tactile::read_track_file(tracks[1])),
                                         static_cast<float>(tolerance / 100)));
  } catch (const std::runtime_error &error) {
    throw UsageError(error.what());
  }
  if (common.quiet)
    return differences.empty() ? 0 : 1;
  Time changed{ 0 };
  for (const tactile::Difference &difference : differences) {
    std::printf("%s - %s", seconds(difference.begin).c_str(), seconds(difference.end).c_str());
    for (int row = 0; row < difference.before.rows; row++)
      for (int column = 0; column < difference.before.columns; column++) {
        const double before = static_cast<double>(difference.before.at(row, column));
        const double after = static_cast<double>(difference.after.at(row, column));
        if (std::abs(before - after) > tolerance / 100)
          std::printf("  r%dc%d %.0f > %.0f", row, column, 100 * before, 100 * after);
      }
    if (!tactile::is_same_frequency(difference.before, difference.after,
                                    static_cast<float>(tolerance)))
      std::printf("  %g > %g Hz", static_cast<double>(difference.before.frequency),
                  static_cast<double>(difference.after.frequency));
    std::printf("\n");
    changed += difference.end - difference.begin;
  }
  if (!differences.empty())
    std::printf(_("%zu differences, %s s in all\n"), differences.size(), seconds(changed).c_str());
  return differences.empty() ? 0 : 1;
}
