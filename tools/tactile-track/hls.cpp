// SPDX-License-Identifier: LGPL-2.1-or-later
//
// hls: a track beside a film that is streamed by HTTP Live Streaming.
#include "commands.h"
#include "hls_playlist.h"

#include "files/regular_file.h"
#include "film/program.h"
#include "tracks/cue_builder.h"
#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt_timing.h"
#include "tracks/text_cue.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace fs = std::filesystem;
using tactile::Time;

namespace {

constexpr const char *kFolder = "tactile";
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
    throw std::runtime_error("cannot read '" + path.string() + "': " + text.error().reason);
  return *std::move(text);
}

/// The time stamp of the first picture, in 90 000 Hz.
std::int64_t
start_of(const fs::path &playlist)
{
  double start = 0;
  bool is_known = false;
  const ProgramEnd end
      = run_program({ "ffprobe", "-v", "error", "-live_start_index", "0", "-allowed_extensions",
                      "ALL", "-select_streams", "v:0", "-show_entries", "stream=start_time", "-of",
                      "csv=p=0", playlist.string() },
                    "ffmpeg", [&](std::string_view line) {
                      if (!is_known)
                        is_known = std::from_chars(line.data(), line.data() + line.size(), start).ec
                                   == std::errc();
                    });
  if (!is_known || !(start >= 0 && start <= 1e6))
    throw std::runtime_error("'" + playlist.string() + "': expected segments with a picture"
                             + (end.complaint.empty() ? "" : ", got " + end.complaint));
  constexpr double kClock = 90'000;
  return std::llround(start * kClock);
}

/// The cues of a stretch as a segment. A cue beyond the end is cut, so that each part is played
/// once.
std::string
segment_text(const std::deque<tactile::Cue> &cues, const tactile::Track &track, std::int64_t start,
             Time begin, Time end)
{
  std::string text = "WEBVTT\nX-TIMESTAMP-MAP=MPEGTS:" + std::to_string(start)
                     + ",LOCAL:00:00:00.000\n\nNOTE tactile "
                     + tactile::write_grid({ track.rows(), track.columns() }, track.rate()) + "\n";
  const auto ms = [](Time time) {
    return std::chrono::floor<std::chrono::milliseconds>(time);
  };
  const auto first = std::ranges::upper_bound(cues, begin, {}, &tactile::Cue::end);
  for (auto cue = first; cue != cues.end() && cue->begin < end; ++cue) {
    const Time from = ms(std::max(cue->begin, begin));
    const Time to = ms(std::min(cue->end, end));
    if (from < to)
      text += "\n" + tactile::write_webvtt_timing(from, to) + "\n"
              + tactile::write_text_cue(cue->map) + "\n";
  }
  return text;
}

struct Stream
{
  fs::path variant;
  fs::path folder; ///< of the rendition
};

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
    rendition = { .segments = std::move(segments), .start = start_of(stream.variant) };
  } else {
    const hls::Rendition before = valid(hls::read_rendition(read_text(index)), index);
    rendition = valid(hls::followed(before, std::move(segments)), stream.variant);
    std::int64_t number = before.segments.sequence;
    for (; number < rendition.segments.sequence; number++)
      fs::remove(stream.folder / (std::to_string(number) + ".vtt"));
    if (!is_first_call)
      done = before.segments.durations.size()
             - static_cast<std::size_t>(number - before.segments.sequence);
  }
  Time begin = rendition.first;
  for (std::size_t i = 0; i < rendition.segments.durations.size(); i++) {
    const Time end = begin + rendition.segments.durations[i];
    const std::int64_t number = rendition.segments.sequence + static_cast<std::int64_t>(i);
    if (i >= done)
      write_bytes(segment_text(cues, track, rendition.start, begin, end),
                  (stream.folder / (std::to_string(number) + ".vtt")).string());
    begin = end;
  }
  write_bytes(hls::write_rendition(rendition), index.string());
  return rendition.segments.is_ended;
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
      "Address of PLAYLIST's folder on the server, for Apple's players", "URL" },
    { "live", 0, 0, G_OPTION_ARG_NONE, &live, "Go on until the stream ends", nullptr },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "PLAYLIST TRACK",
        .summary
        = "Adds a track to a film that is streamed by HLS: WebVTT in the folder 'tactile' "
          "beside the\nmultivariant PLAYLIST, and tactile.ahap, which Apple's players play. "
          "A playlist that has a\ntrack gets the new one. Needs ffprobe.",
        .least = 2,
        .most = 2 });
  const fs::path playlist = names[0];
  const std::string text = read_text(playlist);
  const std::string uri = valid(hls::first_variant(text), playlist);
  if (uri.find("://") != std::string::npos)
    throw std::runtime_error("'" + names[0] + "': expected variants in files, got '" + uri + "'");
  const Stream stream{ .variant = playlist.parent_path() / uri,
                       .folder = playlist.parent_path() / kFolder };
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const std::deque<tactile::Cue> cues = tactile::cues_of(track);
  const SignalsStop stop;
  fs::create_directory(stream.folder);
  bool is_ended = update(stream, track, cues, true);
  std::string address = url.text();
  if (!address.empty() && !address.ends_with('/'))
    address += '/';
  write_track_file(track, (playlist.parent_path() / "tactile.ahap").string());
  write_bytes(hls::with_track(text, std::string(kFolder) + "/index.m3u8", address + "tactile.ahap"),
              playlist.string());
  while (live && !is_ended) {
    constexpr gulong kPause = 200'000; // µs
    g_usleep(kPause);
    signals_stop_here();
    is_ended = update(stream, track, cues, false);
  }
  return 0;
}
