// SPDX-License-Identifier: LGPL-2.1-or-later
//
// hls: a track beside a film that is streamed by HTTP Live Streaming.
#include "commands.h"
#include "hls_playlist.h"
#include "hls_segment.h"

#include "files/regular_file.h"
#include "film/program.h"
#include "tracks/cue_builder.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace fs = std::filesystem;
using tactile::Time;

namespace {

constexpr const char *kFolder = "tactile";
constexpr const char *kAhap = "tactile.ahap";
constexpr double kUnknown = 1e6; ///< s
constexpr std::size_t kMostPlaylist = std::size_t{ 64 } << 20;

template <typename Value>
Value
valid(hls::Read<Value> read, const fs::path &path)
{
  if (!read)
    throw std::runtime_error("'" + path.string() + "': " + read.error());
  return *std::move(read);
}

std::string
read_text(const fs::path &path)
{
  auto text = files::read(path.string(), kMostPlaylist);
  if (!text)
    throw std::runtime_error(in_text("cannot read '{}': {}", path.string(), text.error().reason));
  return *std::move(text);
}

/// Leaves a file that has this text untouched: a live stream is read five times a second.
void
write_changed(const std::string &text, const fs::path &path)
{
  const auto there = files::read(path.string(), kMostPlaylist);
  if (!there || *there != text)
    write_bytes(text, path.string());
}

/// The time stamp of the film's 0:00 in 90 000 Hz: of its first picture or sound.
std::int64_t
start_of(const fs::path &playlist)
{
  double start = kUnknown;
  const ProgramEnd end = run_program(
      { "ffprobe", "-v", "error", "-live_start_index", "0", "-allowed_extensions", "ALL",
        "-show_entries", "stream=codec_type,start_time", "-of", "csv=p=0",
        "file:" + fs::absolute(playlist).string() },
      "ffmpeg", [&](std::string_view line) {
        const std::size_t comma = std::min(line.find(','), line.size() - 1) + 1;
        double time = 0;
        if ((line.starts_with("video,") || line.starts_with("audio,"))
            && std::from_chars(line.data() + comma, line.data() + line.size(), time).ec
                   == std::errc())
          start = std::min(start, time);
      });
  if (!(start >= 0 && start < kUnknown))
    throw std::runtime_error(in_text("'{}': expected segments with a film{}", playlist.string(),
                                     (end.complaint.empty() ? "" : ", got " + end.complaint)));
  constexpr double kClock = 90'000;
  return std::llround(start * kClock);
}

struct Stream
{
  fs::path variant;
  fs::path folder; ///< of the rendition
};

/// Removes segments with smaller numbers.
void
remove_before(std::int64_t number, const fs::path &folder)
{
  for (std::int64_t gone = number - 1; gone >= 0; gone--)
    if (!fs::remove(folder / (std::to_string(gone) + ".vtt")))
      return;
}

/// Writes the segments, after the first call only new ones, and the rendition's playlist. A live
/// stream continues from the end of the last call. Returns whether the stream has ended.
bool
update(const Stream &stream, const tactile::Track &track, const std::deque<tactile::Cue> &cues,
       bool is_first_call)
{
  hls::Segments segments = valid(hls::read_segments(read_text(stream.variant)), stream.variant);
  const fs::path index = stream.folder / "index.m3u8";
  hls::Rendition rendition;
  std::size_t done = 0; // of the segments
  if ((segments.sequence == 0 && is_first_call) || !fs::exists(index)) {
    rendition = valid(hls::begun(std::move(segments)), stream.variant);
    rendition.start = start_of(stream.variant);
  } else {
    const hls::Rendition before = valid(hls::read_rendition(read_text(index)), index);
    rendition = valid(hls::followed(before, std::move(segments)), stream.variant);
    if (!is_first_call)
      done = before.segments.durations.size()
             - static_cast<std::size_t>(rendition.segments.sequence - before.segments.sequence);
  }
  Time begin = rendition.first;
  for (std::size_t i = 0; i < rendition.segments.durations.size(); i++) {
    const Time end = begin + rendition.segments.durations[i];
    const std::int64_t number = rendition.segments.sequence + static_cast<std::int64_t>(i);
    if (i >= done)
      write_changed(hls::segment_text(cues, track, rendition.start, begin, end),
                    stream.folder / (std::to_string(number) + ".vtt"));
    begin = end;
  }
  write_changed(hls::write_rendition(rendition), index);
  remove_before(hls::oldest_kept(rendition.segments), stream.folder);
  return rendition.segments.is_ended;
}

/// Throws std::runtime_error if files of others would be replaced.
void
expect_own(const fs::path &folder, const fs::path &ahap)
{
  std::error_code error;
  const auto index = files::read((folder / "index.m3u8").string(), kMostPlaylist);
  if (index && hls::read_rendition(*index))
    return;
  for (const fs::path &path : { ahap, folder })
    if (fs::exists(path, error) && !fs::is_empty(path, error))
      throw std::runtime_error(
          in_text("'{}' was not written by this command; expected no such file, or --force",
                  path.string()));
}

} // namespace

int
stream_hls(int argc, char **argv)
{
  TextOption url;
  gboolean live = FALSE;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "url", 0, 0, G_OPTION_ARG_STRING, &url.value,
      N_("Address of PLAYLIST's folder on the server, for Apple's players"), "URL" },
    { "live", 0, 0, G_OPTION_ARG_NONE, &live, N_("Continue until the stream ends"), nullptr },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "PLAYLIST TRACK",
        .summary
        = N_("Adds a track to a film that is streamed by HLS: WebVTT in the folder 'tactile' "
             "beside\nthe multivariant PLAYLIST and, if the stream has ended, tactile.ahap, which "
             "Apple's\nplayers play. An older track is replaced. The command needs ffprobe."),
        .least = 2,
        .most = 2,
        .force_help = N_("Also replace files and haptics that this command did not write") });
  const fs::path playlist = names[0];
  const fs::path folder = playlist.parent_path() / kFolder;
  std::string address = valid(hls::checked_address(url.text()), "--url");
  if (!address.empty() && !address.ends_with('/'))
    address += '/';
  const fs::path ahap = playlist.parent_path() / kAhap;
  if (!common.force)
    expect_own(folder, ahap);
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const std::deque<tactile::Cue> cues = tactile::cues_of(track);
  const SignalsStop stop;
  fs::create_directory(folder);
  // An encoder's playlists may be missing or half written for a moment, and it may write the
  // multivariant one anew.
  constexpr gulong kPause = 200'000; // µs
  constexpr int kMostFaults = 150;
  bool is_begun = false;
  bool is_ended = false;
  for (int faults = 0; !is_begun || (live && !is_ended);) {
    try {
      const fs::path variant
          = playlist.parent_path()
            / valid(hls::first_variant(read_text(playlist)).and_then(hls::path_of), playlist);
      const bool has_ended
          = update({ .variant = variant, .folder = folder }, track, cues, !is_begun);
      // A pattern from 0:00 on fits no viewer who joins a live stream.
      if (has_ended)
        write_track_file(track, ahap.string());
      write_changed(valid(hls::with_track(read_text(playlist), std::string(kFolder) + "/index.m3u8",
                                          has_ended ? address + kAhap : "", common.force),
                          playlist),
                    playlist);
      is_begun = true;
      is_ended = has_ended;
      faults = 0;
    } catch (const std::runtime_error &) {
      if (!live || ++faults > kMostFaults)
        throw;
    }
    if (live && !is_ended) {
      g_usleep(kPause);
      signals_stop_here();
    }
  }
  return 0;
}
