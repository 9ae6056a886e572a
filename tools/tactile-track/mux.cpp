// SPDX-License-Identifier: LGPL-2.1-or-later
//
// mux: a copy of a film's file that has a track besides.
#include "commands.h"
#include "film_copy.h"

#include "film/output.h"
#include "film/program.h"
#include "film/progress.h"
#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt_timing.h"
#include "tracks/text_cue.h"
#include "translation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>

namespace {

namespace fs = std::filesystem;

/// Status of a copy that lacks something of the film.
constexpr int kIncomplete = 3;

/// Tolerance of the track's times: Matroska's milliseconds.
constexpr double kTolerance = 0.002;

Container
container_of(const std::string &name)
{
  if (name.ends_with(".mkv"))
    return Container::matroska;
  if (name.ends_with(".mp4"))
    return Container::mp4;
  if (name.ends_with(".ts"))
    return Container::transport_stream;
  throw UsageError(in_text("expected a name that ends in .mkv, .mp4 or .ts, got '{}'", name));
}

/// Subtitles in SubRip: WebVTT would become a kind of subtitles that few players know.
std::string
as_subrip(const std::deque<tactile::Cue> &cues)
{
  std::string text;
  for (std::size_t i = 0; i < cues.size(); i++) {
    std::string timing = tactile::write_webvtt_timing(cues[i].begin, cues[i].end);
    std::ranges::replace(timing, '.', ',');
    text += std::to_string(i + 1) + "\n" + timing + "\n" + tactile::write_text_cue(cues[i].map)
            + "\n\n";
  }
  return text;
}

/// Tries one way of copying after the other, and keeps the best copy.
class Muxing
{
public:
  Muxing(FilmAndTrack what, Container container, const std::string &folder, const std::string &name,
         bool quiet)
      : what_(std::move(what)), container_(container), output_(folder, name),
        other_(folder, name + ".other"), between_(folder, name + ".between"),
        scratch_(folder, name + ".scratch"), quiet_(quiet)
  {
  }

  /// Returns the losses. Throws std::runtime_error if there is no copy, and Stopped.
  std::vector<std::string> operator()()
  {
    const FilmContents &film = what_.film;
    const bool lacks_times = film.lacks_times();
    // ffmpeg moves what begins later to 0, but not MP4, whose times count from 0:00.
    const double zero_by_ffmpeg = film.is_in("mp4") ? 0 : film.zero() - film.start;
    if (container_ == Container::matroska) {
      const bool suits_mkvmerge = lacks_times || film.is_in("matroska");
      for (const bool by_mkvmerge : { suits_mkvmerge, !suits_mkvmerge })
        if (!is_complete())
          attempt(
              [&](double at, const std::string &to) {
                if (by_mkvmerge)
                  copy_by_mkvmerge(what_, at, to, progress("copied"));
                else
                  by_ffmpeg(what_, at, to);
              },
              !by_mkvmerge             ? zero_by_ffmpeg
              : film.is_in("matroska") ? std::max(film.zero(), 0.0) // sound may begin before
                                       : 0);
    } else {
      if (container_ == Container::transport_stream && film.is_in("mpegts"))
        attempt(
            [&](double at, const std::string &to) {
              copy_transport_stream(what_, what_.path, at, to, progress("copied"));
            },
            film.zero());
      if (!lacks_times && !is_a_copy())
        attempt([&](double at, const std::string &to) { by_ffmpeg(what_, at, to); },
                zero_by_ffmpeg);
      if (!is_a_copy())
        attempt([&](double at, const std::string &to) { with_times_first(at, to); }, 0);
    }
    if (!is_a_copy())
      throw std::runtime_error(in_text("no copy of '{}' can be made: {}", what_.path, why_not_));
    signals_stop_here();
    output_.commit();
    return best_->lost;
  }

private:
  bool is_a_copy() const
  {
    return best_ && best_->broken.empty();
  }
  bool is_complete() const
  {
    return is_a_copy() && best_->lost.empty();
  }

  OnProgress progress(const char *step)
  {
    return [this, step](double share) {
      if (!quiet_ && progress_.is_on_terminal())
        progress_.show(std::to_string(std::lround(100 * share)) + " % " + step);
    };
  }

  using Write = std::function<void(double at, const std::string &to)>;

  void attempt(const Write &write, double at)
  {
    const fs::path &to = best_ ? other_.part_path() : output_.part_path();
    try {
      Differences differences = written(write, at, to.string());
      const auto rank = [](const Differences &of) {
        return std::pair(of.broken.size(), of.lost.size());
      };
      if (!differences.broken.empty() && why_not_.empty())
        why_not_ = differences.broken.front();
      if (!best_ || rank(differences) < rank(*best_)) {
        if (best_)
          fs::rename(other_.part_path(), output_.part_path());
        best_ = std::move(differences);
      }
    } catch (const std::runtime_error &error) {
      if (why_not_.empty())
        why_not_ = error.what();
    }
    progress_.clear();
  }

  /// Writes a copy and compares it. Only the copy shows where the film's time 0 is in it.
  Differences written(const Write &write, double at, const std::string &to)
  {
    for (bool is_again = false;; is_again = true) {
      signals_stop_here();
      write(at, to);
      const FilmContents copy = read_contents(to, progress("checked"));
      const int track = track_in(copy);
      Differences differences = compare(what_.film, what_.taken_out, copy, track);
      const bool has_picture = std::ranges::any_of(copy.streams, &FilmStream::is_picture);
      if (!has_picture)
        differences.broken.push_back("its container takes none of its pictures");
      const auto *packets
          = track < 0 ? nullptr : &copy.streams[static_cast<std::size_t>(track)].packets;
      if (packets == nullptr || packets->size() != what_.cues.size()) {
        differences.broken.push_back("the track is not whole");
        return differences;
      }
      // Some decoders hold sound up, so that it begins before 0.
      const double off
          = std::max(what_.film.zero() + differences.shift, 0.0) - packets->front().time;
      if (std::abs(off) <= kTolerance)
        return differences;
      if (is_again || std::isnan(off)) {
        differences.broken.push_back("the track is not at its time");
        return differences;
      }
      at += off;
    }
  }

  int track_in(const FilmContents &copy) const
  {
    for (int i = static_cast<int>(copy.streams.size()) - 1; i >= 0; i--) {
      const FilmStream &stream = copy.streams[static_cast<std::size_t>(i)];
      if (container_ == Container::transport_stream ? stream.codec == "klv" : stream.is_tactile())
        return i;
    }
    return -1;
  }

  /// Leaves out what ffmpeg refuses and, in a transport stream, into which it writes all, what
  /// nobody can read.
  void by_ffmpeg(const FilmAndTrack &what, double at, const std::string &to)
  {
    const bool needs_track = container_ == Container::transport_stream;
    const std::string first = needs_track ? between_.part_path().string() : to;
    std::vector<int> left_out;
    std::optional<FilmContents> copy; // a transport stream
    for (bool is_whole = false; !is_whole;) {
      std::vector<int> more;
      try {
        copy_by_ffmpeg(what, container_, left_out, at, first, progress("copied"));
        if (needs_track) {
          copy = read_contents(first, progress("checked"));
          more = compare(what.film, what.taken_out, *copy, -1).left_out;
        }
      } catch (const std::runtime_error &) {
        if (left_out.empty())
          more = streams_not_for(container_, what, scratch_.part_path().string());
        if (more.empty())
          throw;
      }
      is_whole = std::ranges::all_of(
          more, [&](int one) { return std::ranges::find(left_out, one) != left_out.end(); });
      left_out.insert(left_out.end(), more.begin(), more.end());
    }
    if (copy)
      copy_transport_stream(
          what_, first, what_.film.zero() + compare(what_.film, what_.taken_out, *copy, -1).shift,
          to, progress("copied"));
  }

  /// Times of presentation come from mkvmerge, which knows the pictures.
  void with_times_first(double at, const std::string &to)
  {
    Output timed(output_.part_path().parent_path(),
                 output_.final_path().filename().string() + ".timed");
    FilmAndTrack alone{ .path = what_.path, .film = what_.film, .taken_out = what_.taken_out };
    copy_by_mkvmerge(alone, 0, timed.part_path().string(), progress("timed"));
    const FilmContents contents = read_contents(timed.part_path().string(), progress("checked"));
    const FilmAndTrack what{ .path = timed.part_path().string(),
                             .film = contents,
                             .cues = what_.cues,
                             .subtitles = what_.subtitles,
                             .first = what_.first };
    by_ffmpeg(what, at, to);
  }

  const FilmAndTrack what_;
  const Container container_;
  Output output_;
  Output other_;   ///< a second copy, beside the best
  Output between_; ///< a transport stream without the track
  Output scratch_;
  const bool quiet_;
  Progress progress_;
  std::optional<Differences> best_;
  std::string why_not_;
};

} // namespace

int
mux(int argc, char **argv)
{
  TextOption output;
  gboolean first = FALSE;
  CommonOptions common;
  const GOptionEntry entries[]
      = { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
            N_("The film to write or replace: .mkv, .mp4 or .ts"), "FILM" },
          { "first", 0, 0, G_OPTION_ARG_NONE, &first,
            N_("Put the track before the film's own subtitles, for players that use the first one "
               "(default: after them)"),
            nullptr },
          {} };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM TRACK -o OUT",
        .summary = N_("Copies a film's file and adds a track: as text cues (subtitles named "
                      "'Tactile') to\n.mkv and .mp4, as KLV to .ts. Players do not select the "
                      "track by default. An older\ntrack is replaced. The command prints the "
                      "streams that OUT cannot hold; its exit\nstatus is then 3."),
        .least = 2,
        .most = 2 });
  if (!output.is_set())
    throw UsageError(_("expected -o OUT"));
  const std::string out = output.text();
  const Container container = container_of(out);
  const std::string path = film_path(names[0]);
  refuse_same_file(path, out);
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const auto [folder, name] = folder_and_name(out);
  const SignalsStop signals_stop;
  const FilmContents film = read_contents(path, [](double) {});
  if (std::ranges::none_of(film.streams, &FilmStream::is_picture))
    throw std::runtime_error(in_text("'{}' has no moving picture; expected a film", path));
  FilmAndTrack what{
    .path = path, .film = film, .taken_out = older_tracks(path, film), .first = first != FALSE
  };
  for (int i = 0; i < static_cast<int>(film.streams.size()); i++)
    if (film.streams[static_cast<std::size_t>(i)].kind == FilmStream::kChapters)
      what.taken_out.push_back(i);
  what.cues
      = tactile::cues_of(container == Container::transport_stream
                             ? track
                             : tactile::at_resolution(track, std::chrono::milliseconds(1), 100));
  if (what.cues.empty())
    throw std::runtime_error(
        in_text("'{}' has no cues; expected a track with one at least", names[1]));
  const Output subtitles(folder, name + ".srt");
  what.subtitles = subtitles.part_path().string();
  std::ofstream(what.subtitles, std::ios::binary) << as_subrip(what.cues);
  const std::vector<std::string> lost
      = Muxing(std::move(what), container, folder, name, common.quiet != FALSE)();
  for (const std::string &one : lost)
    std::fprintf(stderr, _("tactile-track: not in '%s': %s\n"), out.c_str(), one.c_str());
  return lost.empty() ? 0 : kIncomplete;
}
