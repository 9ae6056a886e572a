// SPDX-License-Identifier: LGPL-2.1-or-later
//
// author: films in, first drafts of their tracks out, as fast as the machine allows.
#include "commands.h"

#include "film/analysis.h"
#include "film/film.h"
#include "film/output.h"
#include "film/pipeline.h"
#include "film/progress.h"
#include "film/sound.h"
#include "tracks/formats/draft_note.h"
#include "tracks/formats/track_file.h"

#include <glib-unix.h>
#include <gst/app/gstappsink.h>

#include <algorithm>
#include <atomic>
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

/// Without a frame for so long, a film has stalled.
constexpr guint kStalled = 15; // s, or up to twice as long

/// Makes a track of a stream of maps.
class Recorder
{
public:
  explicit Recorder(const AnalysisSettings &settings)
      : track_(settings.rows, settings.columns), sampler_(settings.rate)
  {
    track_.set_rate(settings.rate);
  }

  /// An error where the track is full.
  tl::expected<void, tactile::FormatError> add(FilmMap map)
  {
    if (sampler_.takes(map))
      if (auto appended = track_.append(std::max(map.begin, track_.end()), map.map); !appended)
        return appended;
    end_ = std::max(end_, map.end);
    return {};
  }

  tl::expected<Track, tactile::FormatError> finish()
  {
    if (const auto ended = track_.set_end(std::max(end_, track_.end())); !ended)
      return tl::unexpected(ended.error());
    return track_;
  }

private:
  Track track_;
  BlockSampler sampler_;
  Time end_{ 0 };
};

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
    duration_ = film.duration;
    start_ = film.start.stream;
    recorder_.emplace(settings_);
    began_ = g_get_monotonic_time();
    AnalysisSettings settings = settings_;
    if (!film.has_sound)
      settings.sound = nullptr;
    pipeline_ = make_analysis(film_source(film), settings);
    const Owned<GstElement> sink = element(pipeline_, "maps");
    GstAppSinkCallbacks callbacks{};
    callbacks.new_sample = [](GstAppSink *maps, gpointer self) {
      return static_cast<Job *>(self)->on_map(maps);
    };
    gst_app_sink_set_callbacks(GST_APP_SINK(sink.get()), &callbacks, this, nullptr);
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    watch_ = gst_bus_add_watch(
        bus.get(),
        +[](GstBus *, GstMessage *message, gpointer self) {
          return static_cast<Job *>(self)->on_message(message);
        },
        this);
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
      throw std::runtime_error("'" + film_ + "' cannot be played");
    stall_ = g_timeout_add_seconds(
        kStalled, +[](gpointer self) { return static_cast<Job *>(self)->look_for_stall(); }, this);
  }

  void stop()
  {
    for (guint *source : { &watch_, &stall_ })
      if (*source != 0)
        g_source_remove(std::exchange(*source, 0));
    pipeline_.reset();
  }

  /// The part of the film that is done, 0 to 1.
  double progress() const
  {
    return duration_ > 0 && GST_CLOCK_TIME_IS_VALID(duration_) ? std::min(
               static_cast<double>(position_.load()) / static_cast<double>(duration_), 1.0)
                                                               : 0;
  }

  /// Seconds of film that are done, and seconds since the start.
  std::pair<double, double> times() const
  {
    return { static_cast<double>(position_.load()) / GST_SECOND,
             static_cast<double>(g_get_monotonic_time() - began_) / G_USEC_PER_SEC };
  }

private:
  static std::optional<tactile::DraftNote> note_of(const std::string &track)
  {
    const auto file = tactile::read_track_text(track);
    return file ? tactile::draft_note(file->text) : std::nullopt;
  }

  /// On the streaming thread.
  GstFlowReturn on_map(GstAppSink *maps)
  {
    GstSample *sample = gst_app_sink_pull_sample(maps);
    if (!sample)
      return GST_FLOW_EOS;
    frames_++;
    GstFlowReturn flow = GST_FLOW_OK;
    if (const std::optional<FilmMap> map = film_map(sample, start_)) {
      if (const auto added = recorder_->add(*map); !added) {
        GST_ELEMENT_ERROR(GST_ELEMENT(maps), STREAM, FAILED, ("%s", added.error().text().c_str()),
                          (nullptr));
        flow = GST_FLOW_ERROR;
      }
      if (!first_)
        first_ = map->begin;
      advances_ = advances_ || map->begin > *first_;
      position_ = static_cast<GstClockTime>(map->end.count());
    }
    gst_sample_unref(sample);
    return flow;
  }

  /// GStreamer 1.22 comes to no end of some films, such as short animations.
  gboolean look_for_stall()
  {
    const std::size_t frames = frames_;
    if (frames == 0 || std::exchange(seen_, frames) != frames)
      return G_SOURCE_CONTINUE;
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    g_autoptr(GError) error = g_error_new(GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
                                          "nothing comes after %" G_GSIZE_FORMAT
                                          " frames, nor the film's end; ffmpeg may convert it",
                                          frames);
    gst_bus_post(bus.get(), gst_message_new_error(GST_OBJECT(pipeline_.get()), error, nullptr));
    return G_SOURCE_CONTINUE;
  }

  gboolean on_message(GstMessage *message)
  {
    std::string failure;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      failure = error->message;
    } else if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_EOS) {
      return G_SOURCE_CONTINUE;
    }
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    if (failure.empty() && frames_ == 0)
      failure = "no frame can be decoded";
    else if (failure.empty() && (position_.load() == 0 || (frames_ > 1 && !advances_)))
      failure = "the times of its " + std::to_string(frames_)
                + " frames do not advance: expected a film whose container or decoder has them; "
                  "ffmpeg may convert it";
    if (failure.empty()) {
      try {
        write_track_file(or_throw(recorder_->finish()), output_, made_with(settings_));
      } catch (const std::exception &error) {
        failure = error.what();
      }
    }
    watch_ = 0;
    if (stall_ != 0)
      g_source_remove(std::exchange(stall_, 0));
    finished_(*this, failure);
    return G_SOURCE_REMOVE;
  }

  std::string film_;
  std::string output_;
  AnalysisSettings settings_;
  std::function<void(Job &, const std::string &)> finished_;
  GstClockTime duration_ = 0;
  Time start_{ 0 };  ///< stream time of the film's 0:00
  gint64 began_ = 0; ///< µs
  std::optional<Recorder> recorder_;
  std::atomic<GstClockTime> position_{ 0 };
  std::atomic<std::size_t> frames_{ 0 };
  std::size_t seen_ = 0; ///< frames at the last look_for_stall()
  guint stall_ = 0;
  // Used by the streaming thread, and by others after it has ended.
  std::optional<Time> first_;
  bool advances_ = false;
  guint watch_ = 0;
  Pipeline pipeline_;
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
      std::fprintf(stderr, "tactile-track: stopped; run the same command again to continue\n");
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
      std::printf("%s: %.1f s of film in %.1f s, %.1f times real time\n", job.output().c_str(),
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
    progress_.show(std::to_string(std::lround(100 * done / static_cast<double>(jobs_.size())))
                   + " % of " + std::to_string(jobs_.size()) + " films");
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
      throw UsageError("two films have the track '" + names.back() + "'");
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
      "The track, or the folder for the tracks of several films", "TRACK" },
    { "form", 0, 0, G_OPTION_ARG_STRING, &ending.value,
      "Format of tracks in a folder, as a file name ends (default: .vtt)", "ENDING" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &settings.rows, "Rows of tactors, 1 to 64 (default: 3)",
      "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &settings.columns,
      "Columns of tactors, 1 to 64 (default: 3)", "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &settings.rate,
      "Rate in Hz at which levels may change; 0: with every frame (default: 5)", "HZ" },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &profile.value,
      "Profile of the analysis: tuned (default) or paper", "NAME" },
    { "sound", 0, 0, G_OPTION_ARG_STRING, &sound.value, kSoundHelp, "PROFILE" },
    { "jobs", 'j', 0, G_OPTION_ARG_INT, &jobs,
      "Number of films to analyze at the same time (default: one per processor)", "N" },
    {},
  };
  const std::vector<std::string> films = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM... -o TRACK",
        .summary
        = "Makes tracks of films, with the levels and times that visuotactile-play has.\n"
          "A track appears when it is complete. Tracks that are newer than their films and were\n"
          "made with the same settings are skipped, so that the same command continues a batch\n"
          "that was interrupted. Tracks that were edited are kept.",
        .least = 1,
        .most = std::numeric_limits<std::size_t>::max(),
        .force_help = "Make all tracks, also those that are up to date or were edited" });
  if (!output.is_set())
    throw UsageError("expected -o TRACK");
  if (settings.rows < 1 || settings.rows > 64 || settings.columns < 1 || settings.columns > 64)
    throw UsageError("--rows and --columns are whole numbers from 1 to 64");
  if (!(settings.rate >= 0 && settings.rate <= 1000))
    throw UsageError("--rate is a number of Hz from 0 to 1000");
  settings.profile = profile.text("tuned");
  if (settings.profile != "tuned" && settings.profile != "paper")
    throw UsageError("--profile is tuned or paper");
  settings.sound = sound_profile(sound.text("off"));
  if (jobs < 0 || jobs > 1024)
    throw UsageError("--jobs is a number from 1 to 1024");
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
      std::printf("%s: up to date\n", names[i].c_str());
  }
  return Batch(std::move(work), jobs > 0 ? static_cast<std::size_t>(jobs) : g_get_num_processors(),
               common.quiet != FALSE)
      .run();
}
