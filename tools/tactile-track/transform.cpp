// SPDX-License-Identifier: LGPL-2.1-or-later
//
// convert, edit: a track in, a track out.
#include "commands.h"

#include "text.h"
#include "tracks/formats/funscript.h"
#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt_text.h"
#include "tracks/text_cue.h"
#include "tracks/track_edit.h"
#include "translation.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>

using tactile::Time;
using tactile::Track;

namespace {

struct Operation
{
  template <typename Run>
  Operation(Run of, Time by = Time(0)) : run(std::move(of)), offset(by) // NOLINT: a function is one
  {
  }

  std::function<tl::expected<Track, tactile::FormatError>(const Track &)> run;
  Time offset; ///< by which it moves the track
};

/// A track and the text of its file.
struct TrackFile
{
  std::string text;
  tactile::TrackFormat format;
  Track track;
  std::vector<std::string> ignored; ///< parts of the file that a track cannot represent
};

/// `clip` is that of a project; empty: the one that was open.
TrackFile
read_file(const std::string &path, const std::string &clip = "")
{
  auto [text, format] = or_throw(tactile::read_track_text(path));
  if (!clip.empty() && format != tactile::TrackFormat::hasp)
    throw UsageError(in_text("--part is for a .hasp project, '{}' is none", path));
  std::vector<std::string> ignored;
  Track track
      = or_throw(tactile::read_track(text, format, &ignored, clip).map_error([&](auto error) {
          return std::move(error).within("'" + path + "'");
        }));
  return { .text = std::move(text),
           .format = format,
           .track = std::move(track),
           .ignored = std::move(ignored) };
}

/// Writes a changed track. From WebVTT to WebVTT, unchanged parts stay as they are; from funscript
/// to funscript, other axes and the additions of other tools.
void
write_file(const TrackFile &file, const Track &track, Time offset, const std::string &path)
{
  constexpr auto kText = tactile::TrackFormat::webvtt;
  constexpr auto kScript = tactile::TrackFormat::funscript;
  const tactile::TrackFormat format = or_throw(tactile::written_format(path));
  if (format == kScript && file.format == kScript)
    return write_bytes(or_throw(tactile::funscript_with(file.text, track)), path);
  if (format != kText || file.format != kText)
    return write_track_file(track, path);
  const tactile::Grid grid{ file.track.rows(), file.track.columns() };
  write_bytes(tactile::WebvttText(file.text, grid).with(track, offset), path);
}

/// The sharpness of Apple and Meta has 3 decimals of 235 Hz, which nobody feels.
constexpr float kLeastLoss = 0.15F;

/// Of the frequencies that a track had before it was written.
void
add_lost_frequencies(const Track &track, const Track &written, std::vector<std::string> &lost)
{
  const auto &entries = track.entries();
  std::string other; // the first one that differs by more than rounding
  bool is_rounded = false;
  bool is_gained = false;
  for (std::size_t i = 0; i < entries.size(); i++) {
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    const float before = entries[i].map.frequency;
    const float after = written.at((entries[i].time + end) / 2).frequency; // times may be rounded
    is_gained |= before == 0 && after > 0 && !is_silent(entries[i].map);
    is_rounded |= before > 0 && std::abs(before - after) > kLeastLoss;
    if (before > 0 && std::abs(before - after) >= 1 && other.empty())
      other = std::to_string(std::lround(before)) + " Hz, which is "
              + (after > 0 ? std::to_string(std::lround(after)) + " Hz" : "none");
  }
  if (!other.empty())
    lost.push_back("some frequencies, such as " + other);
  else if (is_rounded)
    lost.emplace_back("frequencies finer than 1 Hz");
  if (is_gained)
    lost.emplace_back("that some vibrations have no frequency");
}

/// What `path`, in its format, has not of the track, as nouns.
std::vector<std::string>
losses(const Track &track, const std::string &path)
{
  const auto read = tactile::read_track_file(path);
  if (!read) // a format that is not read
    return {};
  const Track &written = *read;
  std::vector<std::string> lost;
  if (written.rows() != track.rows() || written.columns() != track.columns())
    lost.push_back("the place of each vibration: it has the strongest cell of "
                   + std::to_string(track.rows() * track.columns()));
  else if (const auto differs = diff(tune(written, 0), tune(track, 0));
           differs && !differs->empty())
    lost.emplace_back("times finer than 1 ms or levels finer than 1 %");
  if (has_frequency(track) && !has_frequency(written))
    lost.emplace_back("the frequencies");
  else if (has_frequency(track))
    add_lost_frequencies(track, written, lost);
  if (track.rate() != 0 && written.rate() == 0)
    lost.emplace_back("the rate");
  return lost;
}

double
parse_number(const std::string &text, const char *option, double least, double most)
{
  const auto value = visuotactile::read_number<double>(text);
  if (!value)
    throw UsageError(in_text("{} is a number, got '{}'", option, text));
  expect_range(option, *value, least, most);
  return *value;
}

/// The texts before and after a separator.
std::pair<std::string, std::string>
parse_pair(const std::string &text, char separator, const char *option, const char *form)
{
  const std::size_t at = text.find(separator, 1);
  if (at == std::string::npos)
    throw UsageError(in_text("{}: expected {}, got '{}'", option, form, text));
  return { text.substr(0, at), text.substr(at + 1) };
}

Operation
parse_mask(const std::string &text)
{
  std::vector<std::pair<int, int>> places;
  std::string rest = text;
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    int row = 0;
    int column = 0;
    int used = 0;
    const std::string word = rest.substr(0, comma);
    if (std::sscanf(word.c_str(), "r%2dc%2d%n", &row, &column, &used) != 2
        || static_cast<std::size_t>(used) != word.size())
      throw UsageError(in_text("--mask: expected cells such as r0c2,r1c1, got '{}'", text));
    places.emplace_back(row, column);
    rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
  }
  return [places](const Track &track) {
    std::vector<int> cells;
    for (const auto &[row, column] : places) {
      if (row >= track.rows() || column >= track.columns())
        throw UsageError(in_text("--mask: the track has no cell r{}c{}", std::to_string(row),
                                 std::to_string(column)));
      cells.push_back(row * track.columns() + column);
    }
    return mask(track, cells);
  };
}

/// Throws UsageError.
Operation
parse_operation(const std::string &name, const std::string &value)
{
  const char *option = name.c_str();
  if (name == "--prune-shorter") {
    const Time shortest = parse_time(value, option);
    return [=](const Track &track) {
      return prune_short(track, shortest);
    };
  }
  if (name == "--prune-weaker") {
    const auto weakest = static_cast<float>(parse_number(value, option, 0, 100) / 100);
    return [=](const Track &track) {
      return prune_weak(track, weakest);
    };
  }
  if (name == "--merge") {
    const auto tolerance = static_cast<float>(parse_number(value, option, 0, 100) / 100);
    return [=](const Track &track) {
      return merge_equal(track, tolerance);
    };
  }
  if (name == "--limit") {
    const auto [longest, rest] = parse_pair(value, ',', option, "LONGEST,REST in seconds");
    const tactile::CueLimits limits{ .max_duration = parse_time(longest, option),
                                     .refractory = parse_time(rest, option) };
    return [=](const Track &track) {
      return limit_events(track, limits);
    };
  }
  if (name == "--shift") {
    const Time offset = parse_time(value, option);
    return { [=](const Track &track) { return shift(track, offset); }, offset };
  }
  if (name == "--scale") {
    const auto factor = static_cast<float>(parse_number(value, option, 0, 100));
    return [=](const Track &track) {
      return scale(track, factor);
    };
  }
  if (name == "--clip" || name == "--silence") {
    const auto [from, to] = parse_pair(value, '-', option, "FROM-TO in seconds");
    const Time begin = parse_time(from, option);
    const Time end = parse_time(to, option);
    if (end <= begin)
      throw UsageError(in_text("{}: expected an end after the beginning, got '{}'", name, value));
    if (name == "--clip")
      return { [=](const Track &track) { return clip(track, begin, end); }, -begin };
    return [=](const Track &track) {
      return silence(track, begin, end);
    };
  }
  if (name == "--frequency") {
    const auto frequency = static_cast<float>(parse_number(value, option, 0, 1000));
    if (frequency > 0 && frequency < 1)
      throw UsageError(in_text("--frequency: expected 1 to 1000 Hz, or 0, got '{}'", value));
    return [=](const Track &track) {
      return tune(track, frequency);
    };
  }
  if (name == "--mask")
    return parse_mask(value);
  if (name == "--quantize") {
    const auto steps = static_cast<int>(parse_number(value, option, 1, 1000));
    return [=](const Track &track) {
      return quantize(track, steps);
    };
  }
  if (name == "--resample") {
    const tl::expected<tactile::GridHeader, tactile::FormatError> header
        = tactile::read_grid("grid=" + value, 1);
    if (!header || !header->grid)
      throw UsageError(in_text("{}: expected ROWSxCOLUMNS, 1 to 64 each, got '{}'", name, value));
    return [grid = *header->grid](const Track &track) {
      return resample(track, grid.rows, grid.columns);
    };
  }
  const tactile::Mix mix = name == "--overlay-max" ? tactile::Mix::max : tactile::Mix::replace;
  return [=](const Track &track) {
    return overlay(track, or_throw(tactile::read_track_file(value)), mix);
  };
}

gboolean
on_operation(const gchar *name, const gchar *value, gpointer data, GError **error)
{
  try {
    static_cast<std::vector<Operation> *>(data)->push_back(parse_operation(name, value));
    return TRUE;
  } catch (const std::exception &failure) {
    g_set_error_literal(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE, failure.what());
    return FALSE;
  }
}

} // namespace

int
convert(int argc, char **argv)
{
  TextOption output;
  TextOption part;
  CommonOptions common;
  const GOptionEntry entries[]
      = { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
            N_("The track to write or replace; its name selects the format"), "TRACK" },
          { "part", 'p', 0, G_OPTION_ARG_STRING, &part.value,
            N_("The clip of a .hasp project (default: the clip that was open in Haptics Studio)"),
            "NAME" },
          {} };
  const std::vector<std::string> tracks = parse_options(
      argc, argv, entries, common,
      { .arguments = "IN -o OUT",
        .summary
        = N_("Converts a track to the format of OUT's name: .vtt (WebVTT), .csv, .hjif "
             "(MPEG\nhaptics), .sem.xml (MPEG-V), .haptic (Meta Haptics Studio), .ahap (Apple) "
             "or\n.funscript. IN may also be .hasp (a project of Haptics Studio) or .tact "
             "(bHaptics).\nThe command prints the parts of IN that OUT cannot hold."),
        .least = 1,
        .most = 1 });
  if (!output.is_set())
    throw UsageError(_("expected -o OUT"));
  const TrackFile file = read_file(tracks[0], part.text());
  write_file(file, file.track, Time(0), output.text());
  for (const std::string &part : file.ignored)
    g_printerr("tactile-track: not read from '%s': %s\n", tracks[0].c_str(), part.c_str());
  for (const std::string &part : losses(file.track, output.text()))
    g_printerr("tactile-track: not in '%s': %s\n", output.text().c_str(), part.c_str());
  return 0;
}

int
edit(int argc, char **argv)
{
  TextOption output;
  gboolean in_place = FALSE;
  CommonOptions common;
  std::vector<Operation> operations;
  const auto callback = reinterpret_cast<gpointer>(on_operation);
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The track to write or replace; its name selects the format"), "TRACK" },
    { "in-place", 'i', 0, G_OPTION_ARG_NONE, &in_place, N_("Overwrite IN"), nullptr },
    { "prune-shorter", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Silence events of a cell that are shorter than this"), "SECONDS" },
    { "prune-weaker", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Silence events of a cell whose peak is weaker than this"), "PERCENT" },
    { "merge", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Merge a map with the one before if no level differs by more than this"), "PERCENT" },
    { "limit", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Limit events of a cell to LONGEST seconds, with at least REST seconds of silence between "
         "them"),
      "LONGEST,REST" },
    { "shift", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Delay all events; negative: advance them"), "SECONDS" },
    { "scale", 0, 0, G_OPTION_ARG_CALLBACK, callback, N_("Multiply levels by a factor"), "FACTOR" },
    { "frequency", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Set the frequency of all events, for shakers and other wide-band actuators; 0: none"),
      "HZ" },
    { "clip", 0, 0, G_OPTION_ARG_CALLBACK, callback,
      N_("Keep only this part, which then begins at 0"), "FROM-TO" },
    { "silence", 0, 0, G_OPTION_ARG_CALLBACK, callback, N_("Silence this part"), "FROM-TO" },
    { "mask", 0, 0, G_OPTION_ARG_CALLBACK, callback, N_("Silence these cells"), "r0c2,r1c1,..." },
    { "quantize", 0, 0, G_OPTION_ARG_CALLBACK, callback, N_("Round levels to N steps"), "N" },
    { "resample", 0, 0, G_OPTION_ARG_CALLBACK, callback, N_("Convert the track to another grid"),
      "ROWSxCOLUMNS" },
    { "overlay-max", 0, G_OPTION_FLAG_FILENAME, G_OPTION_ARG_CALLBACK, callback,
      N_("Use the stronger level of both tracks in each cell"), "TRACK" },
    { "overlay-replace", 0, G_OPTION_FLAG_FILENAME, G_OPTION_ARG_CALLBACK, callback,
      N_("Use TRACK instead wherever TRACK is not silent"), "TRACK" },
    {},
  };
  const std::vector<std::string> tracks = parse_options(
      argc, argv, entries, common,
      { .arguments = "IN -o OUT OPERATION...",
        .summary = N_("Applies operations to a track, in the order of the command line. IN is "
                      "overwritten\nonly with --in-place. Times are seconds or H:MM:SS.mmm."),
        .least = 1,
        .most = 1,
        .callback_data = &operations });
  const std::string &in = tracks[0];
  if (in_place == output.is_set())
    throw UsageError(_("expected either -o OUT or --in-place"));
  const std::string out = in_place ? in : output.text();
  std::error_code ignored;
  if (!in_place && std::filesystem::equivalent(in, out, ignored))
    throw UsageError(in_text("'{}' is the track itself; use --in-place to overwrite it", out));

  const TrackFile file = read_file(in);
  Track track = file.track;
  Time offset{ 0 };
  for (const Operation &operation : operations) {
    track = or_throw(operation.run(track));
    offset += operation.offset;
  }
  write_file(file, track, offset, out);
  return 0;
}
