// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_listener.h"

#include "tracks/formats/track_file.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <utility>

using follow::Doing;
using follow::local_time;
using follow::Report;
using follow::Time;

namespace {

constexpr int kRate = 16000;                          // Hz
constexpr GstClockTime kPatience = 100 * GST_MSECOND; ///< between looks whether it shall stop
constexpr const char *kMonitor = "monitor";
constexpr std::size_t kMostComplaints = 20;

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

std::string
FilmListener::source_name(const std::string &source)
{
  return source.empty()       ? "the microphone"
         : source == kMonitor ? "the sound of this computer"
                              : "'" + source + "'";
}

FilmListener::FilmListener(Settings settings, follow::PlayerEvents events, Calls calls,
                           std::shared_ptr<const listen::Catalogue> catalogue)
    : name_("listen (" + source_name(settings.source) + ")"), settings_(std::move(settings)),
      events_(std::move(events)), calls_(std::move(calls)),
      context_(g_main_context_ref_thread_default()), stop_(g_cancellable_new()),
      catalogue_(std::move(catalogue))
{
  thread_ = std::thread([this] { listen(); });
}

FilmListener::~FilmListener()
{
  g_cancellable_cancel(stop_);
  thread_.join();
  if (source_ != nullptr) {
    g_source_destroy(source_);
    g_source_unref(source_);
  }
  g_object_unref(stop_);
  g_main_context_unref(context_);
}

void
FilmListener::listen()
{
  try {
    if (!catalogue_)
      load();
    if (!stops())
      hear();
  } catch (const std::exception &error) {
    // A file that cannot be decoded never can; entries may come later.
    post({ .ended = catalogue_ && is_sound_file(settings_.source), .gone = error.what() });
  }
}

void
FilmListener::load()
{
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
  catalogue_ = std::move(catalogue);
  post({ .loaded = catalogue_ });
}

void
FilmListener::hear()
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
    throw std::runtime_error("cannot listen to " + source_name(settings_.source) + ": "
                             + start_error(bus.get()));
  listen::Listener listener(*catalogue_, kRate);
  auto *sound = GST_APP_SINK(sink.get());
  while (!stops() && gst_app_sink_is_eos(sound) == FALSE) {
    g_autoptr(GstSample) sample = gst_app_sink_try_pull_sample(sound, kPatience);
    expect_source(bus.get());
    if (sample != nullptr && !std::exchange(listens_, true))
      post({ .said = "listens to " + source_name(settings_.source) + " for "
                     + std::to_string(catalogue_->index().films())
                     + " films; sound is neither stored nor sent" });
    if (sample != nullptr)
      add(sample, listener);
  }
  if (gst_app_sink_is_eos(sound) != FALSE)
    post({ .ended = is_sound_file(settings_.source), .gone = "the sound has ended" });
}

/// Throws std::runtime_error with an error of the pipeline. Where no microphone can be opened,
/// autoaudiosrc posts a warning and is a source of silence.
void
FilmListener::expect_source(GstBus *bus) const
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
      throw std::runtime_error("cannot listen to " + source_name(settings_.source) + ": "
                               + error->message);
  }
}

void
FilmListener::add(GstSample *sample, listen::Listener &listener)
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
  const listen::Entry &film = catalogue_->films()[heard->film];
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
         .film = "heard://" + std::to_string(heard->film) + "/" + name,
         .track = known_track_ });
}

void
FilmListener::post(News news)
{
  const std::lock_guard lock(mutex_);
  news_.push_back(std::move(news));
  if (source_ != nullptr)
    return;
  source_ = g_idle_source_new();
  g_source_set_priority(source_, G_PRIORITY_DEFAULT);
  g_source_set_callback(source_, on_news, this, nullptr);
  g_source_attach(source_, context_);
}

gboolean
FilmListener::on_news(gpointer data)
{
  auto *self = static_cast<FilmListener *>(data);
  std::vector<News> news;
  {
    const std::lock_guard lock(self->mutex_);
    news.swap(self->news_);
    g_clear_pointer(&self->source_, g_source_unref);
  }
  for (const News &one : news)
    self->take(one);
  return G_SOURCE_REMOVE;
}

void
FilmListener::take(const News &news)
{
  const Time now = local_time();
  if (!news.said.empty())
    calls_.said(news.said);
  if (news.loaded)
    calls_.loaded(news.loaded);
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
  events_.reported(report(*news.heard, film_, settings_.latency, now));
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
