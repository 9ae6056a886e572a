// SPDX-License-Identifier: LGPL-2.1-or-later
//
// author: films in, first drafts of their tracks out, as fast as the machine allows.
#include "commands.h"

#include "film/film_part.h"
#include "film/output.h"
#include "film/progress.h"
#include "film/sound.h"
#include "tracks/formats/draft_note.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <glib-unix.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <set>

namespace fs = std::filesystem;
using tactile::Time;
using tactile::Track;

namespace {

/// Grids of parts, whose maps are in memory until the film is whole.
constexpr int kMostCells = 256;

/// A film that is analyzed, and its track.
class Job
{
public:
  Job(std::string film, std::string output, const AnalysisSettings &settings)
      : film_(std::move(film)), output_(std::move(output)), settings_(settings)
  {
  }
  ~Job()
  {
    stop();
  }
  Job(const Job &) = delete;
  Job &operator=(const Job &) = delete;

  const std::string &film() const
  {
    return film_;
  }
  const std::string &output() const
  {
    return output_;
  }

  /// The file with the track's name.
  enum class There
  {
    nothing,  ///< no file, or an unedited draft of another film, version or settings
    same,     ///< made with these settings, newer than its film
    precious, ///< edited, or without a record of its settings
  };
  There there() const
  {
    std::error_code no_film;
    std::error_code no_track;
    const auto film_time = fs::last_write_time(film_, no_film);
    const auto track_time = fs::last_write_time(output_, no_track);
    if (no_track || !fs::is_regular_file(output_, no_track)) // or writing it fails
      return There::nothing;
    const bool is_new = no_film || track_time >= film_time;
    const std::optional<tactile::DraftNote> note = note_of(output_);
    if (is_new && note && note->made_with == made_with(settings_))
      return There::same;
    return note && note->is_unchanged ? There::nothing : There::precious;
  }

  /// Why a precious track is kept.
  std::string why_kept() const
  {
    const std::optional<tactile::DraftNote> note = note_of(output_);
    const bool is_known = note && note->made_with.find("version=") != std::string::npos;
    return "kept, as it "
           + (is_known ? "was edited since it was made with '" + note->made_with + "'"
                       : "may be edited, and does not say what it was made with")
           + "; expected '" + made_with(settings_)
           + "', newer than its film: --force makes it anew";
  }

  /// `finished` is called from the main loop at the end, with the error or an empty text. Throws
  /// std::runtime_error.
  void start(std::function<void(Job &, const std::string &)> finished)
  {
    const Film film = discover_film(film_);
    finished_ = std::move(finished);
    duration_ = GST_CLOCK_TIME_IS_VALID(film.duration) ? Time(static_cast<Time::rep>(film.duration))
                                                       : Time(0);
    recorder_.emplace(settings_);
    began_ = g_get_monotonic_time();
    AnalysisSettings settings = settings_;
    if (!film.has_sound)
      settings.sound = nullptr;
    const auto parts = static_cast<std::size_t>(
        std::clamp<Time::rep>(duration_ / kShortestPart, 1, settings.parts));
    running_ = parts;
    later_.resize(parts - 1);
    for (std::size_t i = 0; i < parts; i++)
      parts_.push_back(std::make_unique<FilmPart>(
          film, settings,
          Span{ .begin = start_of(i, parts),
                .end = i + 1 < parts ? start_of(i + 1, parts) : Time(0) },
          FilmPart::Events{ .analyzed
                            = [this, i](FilmMap map) { return analyzed(i, std::move(map)); },
                            .finished =
                                [this](const std::string &failure) {
                                  part_finished(failure);
                                } }));
    for (const auto &part : parts_)
      part->start();
  }

  void stop()
  {
    for (const auto &part : parts_)
      part->stop();
  }

  /// The part of the film that is done, 0 to 1.
  double progress() const
  {
    return duration_ > Time(0) ? std::min(
               static_cast<double>(done().count()) / static_cast<double>(duration_.count()), 1.0)
                               : 0;
  }

  /// Seconds of film that are done, and seconds since the start.
  std::pair<double, double> times() const
  {
    return { static_cast<double>(done().count()) / GST_SECOND,
             static_cast<double>(g_get_monotonic_time() - began_) / G_USEC_PER_SEC };
  }

private:
  /// A shorter part costs more than it saves, as each one is analyzed from a minute before it on.
  static constexpr Time kShortestPart = std::chrono::minutes(2);

  static std::optional<tactile::DraftNote> note_of(const std::string &track)
  {
    const auto file = tactile::read_track_text(track);
    return file ? tactile::draft_note(file->text) : std::nullopt;
  }

  Time start_of(std::size_t part, std::size_t parts) const
  {
    return duration_ * static_cast<Time::rep>(part) / static_cast<Time::rep>(parts);
  }

  Time done() const
  {
    Time sum{ 0 };
    for (const auto &part : parts_)
      sum += part->done();
    return sum;
  }

  /// On the part's streaming thread. Later parts wait for the first.
  tl::expected<void, tactile::FormatError> analyzed(std::size_t part, FilmMap map)
  {
    if (part == 0)
      return recorder_->add(std::move(map));
    later_[part - 1].push_back(std::move(map));
    return {};
  }

  void part_finished(std::string failure)
  {
    if (failure.empty() && --running_ > 0)
      return;
    stop(); // the others
    if (failure.empty()) {
      try {
        for (std::vector<FilmMap> &maps : later_)
          for (FilmMap &map : std::exchange(maps, {}))
            or_throw(recorder_->add(std::move(map)));
        write_track_file(or_throw(recorder_->finish()), output_, made_with(settings_));
      } catch (const std::exception &error) {
        failure = error.what();
      }
    }
    later_.clear();
    finished_(*this, failure);
  }

  std::string film_;
  std::string output_;
  AnalysisSettings settings_;
  std::function<void(Job &, const std::string &)> finished_;
  Time duration_{ 0 };
  gint64 began_ = 0; ///< µs
  std::optional<TrackRecorder> recorder_;
  std::vector<std::vector<FilmMap>> later_; ///< of each part but the first
  std::size_t running_ = 0;                 ///< parts
  std::vector<std::unique_ptr<FilmPart>> parts_;
};

/// Several films, some of them at the same time.
class Batch
{
public:
  Batch(std::vector<std::unique_ptr<Job>> jobs, std::size_t at_a_time, bool quiet)
      : jobs_(std::move(jobs)), at_a_time_(at_a_time), quiet_(quiet),
        loop_(g_main_loop_new(nullptr, FALSE))
  {
  }
  ~Batch()
  {
    g_main_loop_unref(loop_);
  }
  Batch(const Batch &) = delete;
  Batch &operator=(const Batch &) = delete;

  /// The exit status.
  int run()
  {
    std::vector<guint> sources;
    for (const int number : { SIGINT, SIGTERM })
      sources.push_back(g_unix_signal_add(
          number,
          +[](gpointer self) -> gboolean {
            static_cast<Batch *>(self)->stopped_ = true;
            g_main_loop_quit(static_cast<Batch *>(self)->loop_);
            return G_SOURCE_CONTINUE;
          },
          this));
    if (!quiet_ && progress_.is_on_terminal())
      sources.push_back(g_timeout_add(
          500, +[](gpointer self) { return static_cast<Batch *>(self)->show_progress(); }, this));
    start_more();
    if (running_ > 0)
      g_main_loop_run(loop_);
    for (const auto &job : jobs_)
      job->stop();
    for (const guint source : sources)
      g_source_remove(source);
    progress_.clear();
    if (stopped_) {
      std::fprintf(stderr, _("tactile-track: stopped; run the same command again to continue\n"));
      return 130;
    }
    return failed_ > 0 ? 1 : 0;
  }

private:
  void start_more()
  {
    while (running_ < at_a_time_ && next_ < jobs_.size()) {
      Job &job = *jobs_[next_++];
      try {
        job.start([this](Job &ended, const std::string &failure) { finished(ended, failure); });
        running_++;
      } catch (const std::exception &error) {
        job.stop();
        fail(job, error.what());
      }
    }
  }

  void fail(const Job &job, const std::string &reason)
  {
    failed_++;
    progress_.clear();
    print_error("tactile-track", job.film() + ": " + reason);
  }

  void finished(Job &job, const std::string &failure)
  {
    running_--;
    if (!failure.empty()) {
      fail(job, failure);
    } else if (!quiet_) {
      const auto [film, taken] = job.times();
      progress_.clear();
      std::printf(_("%s: %.1f s of film in %.1f s, %.1f times real time\n"), job.output().c_str(),
                  film, taken, film / std::max(taken, 1e-3));
      std::fflush(stdout);
    }
    start_more();
    if (running_ == 0)
      g_main_loop_quit(loop_);
  }

  gboolean show_progress()
  {
    double done = 0;
    for (std::size_t i = 0; i < next_; i++)
      done += jobs_[i]->progress();
    progress_.show(
        in_text("{} % of {} films",
                std::to_string(std::lround(100 * done / static_cast<double>(jobs_.size()))),
                std::to_string(jobs_.size())));
    return G_SOURCE_CONTINUE;
  }

  std::vector<std::unique_ptr<Job>> jobs_;
  std::size_t at_a_time_;
  bool quiet_;
  GMainLoop *loop_;
  Progress progress_;
  std::size_t next_ = 0;
  std::size_t running_ = 0;
  int failed_ = 0;
  bool stopped_ = false;
};

/// The track's name for each film: `output` for a single film, or else in the folder `output` the
/// film's name with another ending.
std::vector<std::string>
output_names(const std::vector<std::string> &films, const std::string &output,
             const std::string &ending)
{
  std::error_code error;
  if (films.size() == 1 && !fs::is_directory(output, error)) {
    or_throw(tactile::written_format(output));
    return { output };
  }
  or_throw(tactile::written_format("x" + ending));
  prepare_directory(output);
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string &film : films) {
    names.push_back((fs::path(output) / fs::path(film).stem()).string() + ending);
    if (!taken.insert(names.back()).second)
      throw UsageError(in_text("two films have the track '{}'", names.back()));
  }
  return names;
}

} // namespace

int
author(int argc, char **argv)
{
  TextOption output;
  TextOption ending;
  TextOption profile;
  TextOption sound;
  AnalysisSettings settings;
  gint jobs = 0;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The track, or the folder for the tracks of several films"), "TRACK" },
    { "form", 0, 0, G_OPTION_ARG_STRING, &ending.value,
      N_("Format of the tracks in a folder, by the ending of their names (default: .vtt)"),
      "ENDING" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &settings.rows, N_("Rows of tactors, 1 to 64 (default: 3)"),
      "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &settings.columns,
      N_("Columns of tactors, 1 to 64 (default: 3)"), "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &settings.rate,
      N_("Rate in Hz at which levels may change; 0: with every frame (default: 5)"), "HZ" },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &profile.value,
      N_("Profile of the analysis: tuned (default) or paper"), "NAME" },
    { "sound", 0, 0, G_OPTION_ARG_STRING, &sound.value, kSoundHelp, "PROFILE" },
    { "parts", 0, 0, G_OPTION_ARG_INT, &settings.parts,
      N_("Number of parts of each film to analyze at the same time; levels near the ends of parts "
         "differ a little (default: 1)"),
      "N" },
    { "jobs", 'j', 0, G_OPTION_ARG_INT, &jobs,
      N_("Number of films to analyze at the same time (default: one per processor)"), "N" },
    {},
  };
  const std::vector<std::string> films = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM... -o TRACK",
        .summary = N_("Makes tracks of films, with the levels and times of visuotactile-play. A "
                      "track\nappears when it is complete. Tracks that are newer than their films "
                      "and were made\nwith the same settings are skipped, so that the same command "
                      "continues an\ninterrupted batch. Edited tracks are kept."),
        .least = 1,
        .most = std::numeric_limits<std::size_t>::max(),
        .force_help = N_("Make all tracks again, also those that are up to date or were edited") });
  if (!output.is_set())
    throw UsageError(_("expected -o TRACK"));
  expect_range("--rows", settings.rows, 1, 64);
  expect_range("--columns", settings.columns, 1, 64);
  expect_range("--rate", settings.rate, 0, 1000);
  settings.profile = profile.text("tuned");
  expect_one_of("--profile", settings.profile, kProfiles);
  settings.sound = sound_profile(sound.text("off"));
  expect_range("--parts", settings.parts, 1, 64);
  if (settings.parts > 1 && settings.rows * settings.columns > kMostCells)
    throw UsageError(
        in_text("--parts is for grids of at most {} cells", std::to_string(kMostCells)));
  expect_range("--jobs", jobs, 0, 1024);
  gst_init(nullptr, nullptr);

  const std::vector<std::string> names = output_names(films, output.text(), ending.text(".vtt"));
  std::vector<std::unique_ptr<Job>> work;
  for (std::size_t i = 0; i < films.size(); i++) {
    auto job = std::make_unique<Job>(films[i], names[i], settings);
    const Job::There there = common.force ? Job::There::nothing : job->there();
    if (there == Job::There::precious)
      print_error("tactile-track", names[i] + ": " + job->why_kept());
    else if (there == Job::There::nothing)
      work.push_back(std::move(job));
    else if (!common.quiet)
      std::printf(_("%s: up to date\n"), names[i].c_str());
  }
  return Batch(std::move(work), jobs > 0 ? static_cast<std::size_t>(jobs) : g_get_num_processors(),
               common.quiet != FALSE)
      .run();
}
