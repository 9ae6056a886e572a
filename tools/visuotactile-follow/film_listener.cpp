// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_listener.h"

#include "tracks/formats/track_file.h"
#include "translation.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

using follow::Doing;
using follow::local_time;
using follow::Report;
using follow::Time;

namespace {

constexpr int kRate = 16000;                          // Hz
constexpr GstClockTime kPatience = 100 * GST_MSECOND; ///< between looks whether it shall stop
constexpr const char *kMonitor = "monitor";
constexpr std::size_t kMostComplaints = 20;
constexpr Time kLooksEvery = std::chrono::seconds(1); ///< whether there are new entries
constexpr std::chrono::seconds kQuiet(2);             ///< no entry is being added any more

/// Threads that listen.
std::mutex count_mutex;
std::condition_variable count_changed;
int count = 0;

void
add_to_count(int by)
{
  const std::lock_guard lock(count_mutex);
  count += by;
  count_changed.notify_all();
}

bool
is_sound_file(const std::string &source)
{
  std::error_code error;
  return source.find("://") != std::string::npos || std::filesystem::is_regular_file(source, error);
}

/// The beginning of a launch line.
std::string
source_line(const std::string &source)
{
  if (source.empty())
    return "autoaudiosrc";
  if (source == kMonitor)
    return "pulsesrc device=@DEFAULT_MONITOR@";
  if (!is_sound_file(source))
    return "pulsesrc device=" + launch_value(source);
  g_autofree gchar *uri = gst_uri_is_valid(source.c_str())
                              ? g_strdup(source.c_str())
                              : gst_filename_to_uri(source.c_str(), nullptr);
  return "uridecodebin caps=audio/x-raw expose-all-streams=false uri="
         + launch_value(uri != nullptr ? uri : source);
}

} // namespace

/// What the listening thread has. It lives until this thread ends.
class FilmListener::Ear : public std::enable_shared_from_this<Ear>
{
public:
  Ear(FilmListener &owner, Settings settings, KnownFilms films)
      : owner_(&owner), settings_(std::move(settings)),
        context_(g_main_context_ref_thread_default()), stop_(g_cancellable_new()),
        films_(std::move(films))
  {
  }
  ~Ear()
  {
    g_object_unref(stop_);
    g_main_context_unref(context_);
  }
  Ear(const Ear &) = delete;
  Ear &operator=(const Ear &) = delete;

  void start()
  {
    add_to_count(1);
    std::thread([self = shared_from_this()]() mutable {
      self->listen();
      self.reset();
      add_to_count(-1);
    }).detach();
  }
  /// The owner is no more. Main context's thread.
  void leave();

private:
  void listen();
  void load();
  bool stops() const
  {
    return g_cancellable_is_cancelled(stop_) != FALSE;
  }
  void hear();
  std::filesystem::file_time_type library_changed() const;
  bool has_new_entries();
  void expect_source(GstBus *bus) const;
  void add(GstSample *sample, listen::Listener &listener);
  void post(News news);
  static gboolean on_news(gpointer self);

  FilmListener *owner_; ///< of the main context's thread
  const Settings settings_;
  GMainContext *context_;
  GCancellable *stop_;
  std::mutex mutex_; ///< guards the next two
  std::vector<News> news_;
  GSource *source_ = nullptr; ///< until it was dispatched
  // Of the listening thread:
  KnownFilms films_;
  int loads_ = 0;
  Time looked_{ 0 };
  Time base_{ 0 };       ///< local time of running time 0
  bool listens_ = false; ///< sound has come
  bool knew_ = false;
  std::size_t film_number_ = 0;
  std::optional<std::size_t> changed_{}; ///< a film whose entry has changed, reported last
  std::shared_ptr<const tactile::Track> known_track_;
};

std::string
FilmListener::source_name(const std::string &source)
{
  return source.empty()       ? "the microphone"
         : source == kMonitor ? "the sound of this computer"
                              : "'" + source + "'";
}

FilmListener::FilmListener(Settings settings, follow::PlayerEvents events, Calls calls,
                           KnownFilms films)
    : name_("listen (" + source_name(settings.source) + ")"), latency_(settings.latency),
      events_(std::move(events)), calls_(std::move(calls)),
      ear_(std::make_shared<Ear>(*this, std::move(settings), std::move(films)))
{
  ear_->start();
}

FilmListener::~FilmListener()
{
  ear_->leave();
}

bool
FilmListener::have_ended(std::chrono::milliseconds within)
{
  std::unique_lock lock(count_mutex);
  return count_changed.wait_for(lock, within, [] { return count == 0; });
}

void
FilmListener::Ear::leave()
{
  g_cancellable_cancel(stop_); // post() attaches no more
  const std::lock_guard lock(mutex_);
  if (source_ != nullptr) {
    g_source_destroy(source_);
    g_clear_pointer(&source_, g_source_unref);
  }
}

void
FilmListener::Ear::listen()
{
  try {
    if (!films_.catalogue)
      load();
    if (!stops())
      hear();
  } catch (const std::exception &error) {
    // A file that cannot be decoded never can; entries may come later.
    post({ .ended = films_.catalogue && is_sound_file(settings_.source), .gone = error.what() });
  }
}

void
FilmListener::Ear::load()
{
  const auto changed = library_changed(); // later ones are seen by has_new_entries()
  std::vector<std::string> complaints;
  auto entries = library::heard_entries(settings_.library, complaints, stop_);
  if (stops())
    return;
  auto catalogue = std::make_shared<const listen::Catalogue>(
      std::move(entries), listen::Catalogue::kMostBytes, [this] { return stops(); });
  if (stops())
    return;
  if (catalogue->films().empty()) // it is the same error, reported once, each time
    throw std::runtime_error(
        !complaints.empty()
            ? "no film can be listened for: " + complaints.front()
            : "expected entries of films (*.heard) in the library of --tracks, got none in '"
                  + settings_.library + "'; make them with tactile-track learn");
  std::ranges::copy(catalogue->complaints(), std::back_inserter(complaints));
  for (std::size_t i = 0; i < std::min(complaints.size(), kMostComplaints); i++)
    post({ .said = complaints[i] });
  if (complaints.size() > kMostComplaints)
    post({ .said
           = std::to_string(complaints.size() - kMostComplaints) + " more entries are faulty" });
  films_ = { .catalogue = std::move(catalogue), .changed = changed };
  loads_++;
  known_track_.reset();
  changed_.reset();
  post({ .loaded = films_ });
}

std::filesystem::file_time_type
FilmListener::Ear::library_changed() const
{
  std::error_code error; // an address has no time
  return std::filesystem::last_write_time(settings_.library, error);
}

bool
FilmListener::Ear::has_new_entries()
{
  const Time now = local_time();
  if (now - looked_ < kLooksEvery)
    return false;
  looked_ = now;
  const auto changed = library_changed();
  return changed != films_.changed
         && std::filesystem::file_time_type::clock::now() - changed > kQuiet;
}

void
FilmListener::Ear::hear()
{
  const Pipeline pipeline
      = make_pipeline(source_line(settings_.source)
                      + " ! audioconvert ! audioresample ! appsink name=sound max-buffers=200 "
                        "caps=audio/x-raw,format=F32LE,layout=interleaved,channels=1,rate="
                      + std::to_string(kRate));
  // Running time is the local time of reports.
  const Owned<GstClock> clock(GST_CLOCK(
      g_object_new(GST_TYPE_SYSTEM_CLOCK, "clock-type", GST_CLOCK_TYPE_MONOTONIC, nullptr)));
  gst_object_ref_sink(clock.get());
  gst_pipeline_use_clock(GST_PIPELINE(pipeline.get()), clock.get());
  gst_element_set_start_time(pipeline.get(), GST_CLOCK_TIME_NONE);
  base_ = local_time();
  gst_element_set_base_time(pipeline.get(), static_cast<GstClockTime>(base_.count()));
  const Owned<GstElement> sink = element(pipeline, "sound");
  const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
  if (gst_element_set_state(pipeline.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
    throw std::runtime_error(
        in_text("cannot listen to {}: {}", source_name(settings_.source), start_error(bus.get())));
  std::optional<listen::Listener> listener(std::in_place, *films_.catalogue, kRate);
  auto *sound = GST_APP_SINK(sink.get());
  while (!stops() && gst_app_sink_is_eos(sound) == FALSE) {
    g_autoptr(GstSample) sample = gst_app_sink_try_pull_sample(sound, kPatience);
    expect_source(bus.get());
    if (sample != nullptr && !std::exchange(listens_, true))
      post({ .said = "listens to " + source_name(settings_.source) + " for "
                     + std::to_string(films_.catalogue->index().films())
                     + " films; sound is neither stored nor sent" });
    if (sample != nullptr)
      add(sample, *listener);
    if (!listener->knows() && has_new_entries()) {
      load();
      if (!stops())
        listener.emplace(*films_.catalogue, kRate);
    }
  }
  if (gst_app_sink_is_eos(sound) != FALSE)
    post({ .ended = is_sound_file(settings_.source), .gone = "the sound has ended" });
}

/// Throws std::runtime_error with an error of the pipeline. Where no microphone can be opened,
/// autoaudiosrc posts a warning and is a source of silence.
void
FilmListener::Ear::expect_source(GstBus *bus) const
{
  while (true) {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(
        bus, static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING));
    if (message == nullptr)
      return;
    g_autoptr(GError) error = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
      gst_message_parse_error(message, &error, nullptr);
    else if (settings_.source.empty() && GST_IS_BIN(GST_MESSAGE_SRC(message)))
      gst_message_parse_warning(message, &error, nullptr);
    if (error != nullptr)
      throw std::runtime_error(
          in_text("cannot listen to {}: {}", source_name(settings_.source), error->message));
  }
}

void
FilmListener::Ear::add(GstSample *sample, listen::Listener &listener)
{
  GstBuffer *buffer = gst_sample_get_buffer(sample);
  const GstClockTime running = gst_segment_to_running_time(gst_sample_get_segment(sample),
                                                           GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  GstMapInfo map;
  if (!GST_CLOCK_TIME_IS_VALID(running) || !gst_buffer_map(buffer, &map, GST_MAP_READ))
    return;
  const std::span<const float> samples(reinterpret_cast<const float *>(map.data),
                                       map.size / sizeof(float));
  const auto heard = listener.add(samples, base_ + Time(static_cast<Time::rep>(running)));
  gst_buffer_unmap(buffer, &map);
  if (std::exchange(knew_, listener.knows()) && !knew_) {
    post({ .lost = true });
    return;
  }
  if (!heard)
    return;
  const listen::Entry &film = films_.catalogue->films()[heard->film];
  if (!known_track_ || heard->film != film_number_) {
    const auto text = film.track();
    if (!text) {
      if (std::exchange(changed_, heard->film) != heard->film)
        post(
            { .said = "the entry of '" + film.film() + "' has changed; its film is not followed" });
      return;
    }
    auto track = tactile::track_format(film.track_name()).and_then([&](auto format) {
      return tactile::read_track(*text, format);
    });
    if (!track)
      post({ .said = "the track of '" + film.film() + "' is faulty: " + track.error().text() });
    film_number_ = heard->film;
    known_track_ = track ? std::make_shared<tactile::Track>(*std::move(track))
                         : std::make_shared<tactile::Track>(1, 1);
  }
  g_autofree gchar *name = g_uri_escape_string(film.film().c_str(), nullptr, TRUE);
  post({ .heard = heard,
         .film
         = "heard://" + std::to_string(loads_) + "." + std::to_string(heard->film) + "/" + name,
         .track = known_track_ });
}

void
FilmListener::Ear::post(News news)
{
  const std::lock_guard lock(mutex_);
  if (stops())
    return;
  news_.push_back(std::move(news));
  if (source_ != nullptr)
    return;
  source_ = g_idle_source_new();
  g_source_set_priority(source_, G_PRIORITY_DEFAULT);
  g_source_set_callback(source_, on_news, this, nullptr);
  g_source_attach(source_, context_);
}

gboolean
FilmListener::Ear::on_news(gpointer data)
{
  auto *self = static_cast<Ear *>(data);
  std::vector<News> news;
  {
    const std::lock_guard lock(self->mutex_);
    news.swap(self->news_);
    g_clear_pointer(&self->source_, g_source_unref);
  }
  for (const News &one : news)
    self->owner_->take(one);
  return G_SOURCE_REMOVE;
}

void
FilmListener::take(const News &news)
{
  const Time now = local_time();
  if (!news.said.empty())
    calls_.said(news.said);
  if (news.loaded)
    calls_.loaded(*news.loaded);
  if (news.ended)
    calls_.ended();
  if (!news.gone.empty()) {
    events_.gone(news.gone);
    return;
  }
  if (news.lost) {
    events_.reported({ .received = now, .doing = Doing::stalled, .film = film_ });
    return;
  }
  if (!news.heard)
    return;
  film_ = news.film;
  track_ = news.track;
  events_.reported(report(*news.heard, film_, latency_, now));
}

Report
FilmListener::report(const listen::Heard &heard, std::string film, Time latency, Time now)
{
  const double since = static_cast<double>((now - heard.at + latency).count());
  const Time position = heard.position + Time(std::llround(since * heard.rate));
  return { .received = now,
           .asked = now,
           .position = std::max(position - kError, Time(0)),
           .doing = Doing::playing,
           .rate = heard.rate,
           .sought = heard.begins,
           .film = std::move(film) };
}
