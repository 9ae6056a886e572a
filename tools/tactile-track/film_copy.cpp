// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_copy.h"

#include "film/or_throw.h"
#include "film/program.h"
#include "tracks/formats/film_file.h"
#include "tracks/formats/transport_stream.h"
#include "translation.h"
#include "json/json_reader.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace json = visuotactile::json;

namespace {

using Arguments = std::vector<std::string>;

template <typename... Text>
void
add(Arguments &to, const Text &...more)
{
  (to.emplace_back(more), ...);
}

/// For programs that read other things than paths in names.
std::string
whole_path(const std::string &path)
{
  return std::filesystem::absolute(path).string();
}

/// For mkvmerge, which else appends files whose names go on counting: VTS_01_2.VOB to VTS_01_1.VOB.
std::string
alone(const std::string &path)
{
  return "=" + whole_path(path);
}

bool
contains(const std::vector<int> &numbers, int number)
{
  return std::ranges::find(numbers, number) != numbers.end();
}

std::string
decimal(double value, int digits)
{
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

/* ---- mkvmerge ---- */

struct ParserUnref
{
  void operator()(JsonParser *parser) const
  {
    g_object_unref(parser);
  }
};

/// What mkvmerge can copy, in the file's order: "0:" and its number, and whether it is subtitles.
std::vector<std::pair<std::string, bool>>
tracks_for_mkvmerge(const std::string &path)
{
  std::string text;
  run_program({ "mkvmerge", "-J", alone(path) }, "mkvtoolnix",
              [&](std::string_view line) { text.append(line).append("\n"); });
  const std::unique_ptr<JsonParser, ParserUnref> parser(json::parse(text));
  JsonNode *root = parser ? json_parser_get_root(parser.get()) : nullptr;
  JsonArray *tracks = root && JSON_NODE_HOLDS_OBJECT(root)
                          ? json::array(json_node_get_object(root), "tracks")
                          : nullptr;
  std::vector<std::pair<std::string, bool>> found;
  for (guint i = 0; tracks && i < json_array_get_length(tracks); i++)
    if (JsonObject *one = json::object(tracks, i))
      if (const auto id = json::integer(one, "id"))
        found.emplace_back("0:" + std::to_string(*id), json::text(one, "type") == "subtitles");
  return found;
}

/// What FFmpeg 5.1 and mkvmerge leave away: how a phone was held, and when.
void
complete_matroska(const FilmContents &film, const std::string &path)
{
  Arguments edits = { "mkvpropedit", whole_path(path) };
  int videos = 0;
  for (const FilmStream &stream : film.streams) {
    videos += stream.kind == "video" ? 1 : 0;
    const auto matrix = stream.facts.find("display matrix");
    const std::string rotation = "rotation=";
    if (stream.kind == "video" && matrix != stream.facts.end()
        && matrix->second.starts_with(rotation))
      add(edits, "--edit", "track:v" + std::to_string(videos), "--set",
          "projection-pose-roll=" + matrix->second.substr(rotation.size()));
  }
  if (const auto date = film.facts.find("creation_time"); date != film.facts.end())
    add(edits, "--edit", "info", "--set", "date=" + date->second + "Z");
  if (edits.size() > 2)
    run_program(edits, "mkvtoolnix", [](std::string_view) {});
}

/* ---- ffmpeg ---- */

const char *
format_of(Container container)
{
  return container == Container::matroska ? "matroska"
         : container == Container::mp4    ? "mp4"
                                          : "mpegts";
}

/// The encoder for a stream: copy, but for text, for which containers have types of their own.
std::string
encoder_for(Container container, const FilmStream &stream)
{
  if (container == Container::mp4 && stream.is_text())
    return "mov_text";
  return container == Container::matroska && stream.codec == "mov_text" ? "srt" : "copy";
}

Arguments
ffmpeg_reading(const std::string &path)
{
  return { "ffmpeg",    "-nostdin", "-y",          "-v",  "error",
           "-progress", "pipe:1",   "-probesize",  "50M", "-analyzeduration",
           "50M",       "-i",       "file:" + path };
}

void
finish_ffmpeg(Arguments arguments, Container container, double duration, const std::string &to,
              const OnProgress &on_progress)
{
  add(arguments, "-copy_unknown", "-copyinkf", "-max_muxing_queue_size", "65536", "-strict",
      "experimental");
  if (container == Container::matroska)
    add(arguments, "-default_mode", "passthrough");
  if (container == Container::transport_stream) // players that count from its clock begin at 0:00
    add(arguments, "-muxdelay", "0", "-muxpreload", "0");
  add(arguments, "-f", format_of(container), "file:" + to);
  const ProgramEnd end = run_program(arguments, "ffmpeg", [&](std::string_view line) {
    constexpr std::string_view kTime = "out_time_us=";
    double time = 0;
    if (duration > 0 && line.starts_with(kTime)
        && std::from_chars(line.data() + kTime.size(), line.data() + line.size(), time).ec
               == std::errc())
      on_progress(std::clamp(time / 1e6 / duration, 0.0, 1.0));
  });
  if (end.status != 0)
    throw std::runtime_error(in_text("ffmpeg: {}", end.complaint));
}

/// The tool marks a track that is the only subtitle stream as enabled, and players would show it.
void
disable_track(const std::string &path)
{
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  struct stat status = {};
  void *bytes = MAP_FAILED;
  if (file >= 0 && fstat(file, &status) == 0)
    bytes = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ | PROT_WRITE,
                 MAP_SHARED, file, 0);
  if (file >= 0)
    close(file);
  if (bytes == MAP_FAILED)
    throw std::runtime_error(in_text("cannot mark the track: {}", g_strerror(errno)));
  const auto size = static_cast<std::size_t>(status.st_size);
  tactile::disable_by_default({ static_cast<std::uint8_t *>(bytes), size });
  munmap(bytes, size);
}

/* ---- transport streams ---- */

struct CloseFile
{
  void operator()(std::FILE *file) const
  {
    std::fclose(file);
  }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

File
open_file(const std::string &path, const char *mode)
{
  File file(std::fopen(path.c_str(), mode));
  if (!file)
    throw std::runtime_error(in_text("cannot open '{}': {}", path, g_strerror(errno)));
  return file;
}

using TransportPacket = std::array<std::uint8_t, tactile::TransportTrack::kPacket>;

/// Returns how many bytes there were.
std::size_t
read_packet(const File &file, TransportPacket &packet)
{
  signals_stop_here();
  return std::fread(packet.data(), 1, packet.size(), file.get());
}

} // namespace

std::vector<int>
older_tracks(const std::string &path, const FilmContents &film)
{
  std::vector<int> older;
  std::set<int> pids;
  if (film.is_in("mpegts")
      && std::ranges::any_of(film.streams, [](const auto &one) { return one.codec == "klv"; })) {
    tactile::TransportTrack track({}, 0);
    const File file = open_file(path, "rbe");
    for (TransportPacket packet{}; read_packet(file, packet) == packet.size();)
      track.scan(packet);
    pids = track.old_tracks();
  }
  for (int i = 0; i < static_cast<int>(film.streams.size()); i++)
    if (const FilmStream &stream = film.streams[static_cast<std::size_t>(i)];
        stream.is_tactile() || (stream.codec == "klv" && pids.contains(stream.id)))
      older.push_back(i);
  return older;
}

void
copy_by_mkvmerge(const FilmAndTrack &what, double at, const std::string &to,
                 const OnProgress &on_progress)
{
  Arguments arguments
      = { "mkvmerge", "--ui-language", "en_US", "--gui-mode", "-o", whole_path(to) };
  if (what.film.is_in("avi"))
    add(arguments, "--engage", "native_mpeg4"); // with times of presentation
  std::string others;
  for (const int index : what.taken_out)
    if (what.film.streams[static_cast<std::size_t>(index)].kind == "subtitle")
      others += (others.empty() ? "!" : ",") + std::to_string(index);
  if (!others.empty())
    add(arguments, "--subtitle-tracks", others);
  add(arguments, alone(what.path));
  if (!what.subtitles.empty()) {
    std::string order;
    bool is_placed = !what.first;
    for (const auto &[track, is_subtitles] : tracks_for_mkvmerge(what.path)) {
      if (is_subtitles && !std::exchange(is_placed, true))
        order += "1:0,";
      order += track + ",";
    }
    add(arguments, "--language", "0:zxx", "--track-name", "0:Tactile", "--default-track-flag",
        "0:no", "--compression", "0:none", "--sync", "0:" + decimal(at * 1000, 0),
        alone(what.subtitles), "--track-order", order + "1:0");
  }
  std::string complaint;
  const ProgramEnd end = run_program(arguments, "mkvtoolnix", [&](std::string_view line) {
    constexpr std::string_view kProgress = "#GUI#progress ";
    constexpr std::string_view kError = "#GUI#error ";
    int percent = 0;
    if (line.starts_with(kError))
      complaint = line.substr(kError.size());
    else if (line.starts_with(kProgress)
             && std::from_chars(line.data() + kProgress.size(), line.data() + line.size(), percent)
                        .ec
                    == std::errc())
      on_progress(percent / 100.0);
  });
  if (end.status > 1) // 1: with warnings
    throw std::runtime_error(
        in_text("mkvmerge: {}", (complaint.empty() ? end.complaint : complaint)));
  complete_matroska(what.film, to);
}

void
copy_by_ffmpeg(const FilmAndTrack &what, Container container, const std::vector<int> &left_out,
               double at, const std::string &to, const OnProgress &on_progress)
{
  Arguments inputs = ffmpeg_reading(what.path);
  Arguments options;
  int count = 0;
  const bool has_track = container != Container::transport_stream;
  const auto add_track = [&] {
    const std::string index = std::to_string(count++);
    add(options, "-map", "1:0", "-c:" + index, container == Container::mp4 ? "mov_text" : "copy");
    for (const char *tag : { "title=Tactile", "handler_name=Tactile", "language=zxx" })
      add(options, "-metadata:s:" + index, tag);
    add(options, "-disposition:" + index, "0");
  };
  bool is_placed = !has_track || !what.first;
  for (int i = 0; i < static_cast<int>(what.film.streams.size()); i++) {
    const FilmStream &stream = what.film.streams[static_cast<std::size_t>(i)];
    if (contains(what.taken_out, i) || contains(left_out, i))
      continue;
    if (stream.kind == "subtitle" && !std::exchange(is_placed, true))
      add_track();
    const std::string index = std::to_string(count++);
    add(options, "-map", "0:" + std::to_string(i), "-c:" + index, encoder_for(container, stream));
    if (container == Container::transport_stream && stream.codec == "mpeg4")
      add(options, "-bsf:" + index, "dump_extra"); // headers, for who joins in
    if (const auto title = stream.facts.find("title");
        container == Container::mp4 && title != stream.facts.end())
      add(options, "-metadata:s:" + index, "handler_name=" + title->second);
  }
  if (count == 0)
    throw std::runtime_error(_("its container takes none of its streams"));
  if (has_track) {
    if (!what.first || !is_placed)
      add_track();
    add(inputs, "-itsoffset", decimal(at, 6), "-f", "srt", "-i", "file:" + what.subtitles);
  }
  inputs.insert(inputs.end(), options.begin(), options.end());
  if (const auto date = what.film.facts.find("creation_time"); date != what.film.facts.end())
    add(inputs, "-metadata", "creation_time=" + date->second + "Z"); // ffmpeg drops it
  if (what.film.is_in("mp4"))
    add(inputs, "-copyts"); // its times count from 0:00
  finish_ffmpeg(inputs, container, what.film.duration, to, on_progress);
  if (container == Container::matroska)
    complete_matroska(what.film, to);
  else if (container == Container::mp4)
    disable_track(to);
}

std::vector<int>
streams_not_for(Container container, const FilmAndTrack &what, const std::string &scratch)
{
  std::vector<int> not_for;
  for (int i = 0; i < static_cast<int>(what.film.streams.size()); i++) {
    Arguments arguments = ffmpeg_reading(what.path);
    add(arguments, "-t", "1", "-map", "0:" + std::to_string(i), "-c",
        encoder_for(container, what.film.streams[static_cast<std::size_t>(i)]));
    try {
      finish_ffmpeg(arguments, container, 0, scratch, [](double) {});
    } catch (const std::runtime_error &) {
      not_for.push_back(i);
    }
  }
  return not_for;
}

void
copy_transport_stream(const FilmAndTrack &what, const std::string &from, double at,
                      const std::string &to, const OnProgress &on_progress)
{
  using tactile::TransportTrack;
  tactile::TransportTrack track(what.cues, std::llround(at * 90'000));
  const File film = open_file(from, "rbe");
  const File copy = open_file(to, "wbe");
  TransportPacket packet{};
  std::size_t size = 0;
  const auto next = [&] {
    return (size = read_packet(film, packet)) == packet.size();
  };
  while (next())
    track.scan(packet);
  or_throw(track.check());
  const long bytes = std::max(std::ftell(film.get()), 1L);
  std::rewind(film.get());
  std::vector<std::uint8_t> out;
  const auto write = [&] {
    if (std::fwrite(out.data(), 1, out.size(), copy.get()) != out.size())
      throw std::runtime_error(in_text("cannot write '{}': {}", to, g_strerror(errno)));
    out.clear();
  };
  for (long count = 0; next(); count++) {
    track.copy(packet, out);
    if (out.size() >= 1 << 20) {
      write();
      on_progress(static_cast<double>(count) * TransportTrack::kPacket
                  / static_cast<double>(bytes));
    }
  }
  track.finish(out);
  out.insert(out.end(), packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(size));
  write();
  if (std::fflush(copy.get()) != 0 || std::ferror(film.get()))
    throw std::runtime_error(in_text("cannot copy '{}': {}", from, g_strerror(errno)));
}
