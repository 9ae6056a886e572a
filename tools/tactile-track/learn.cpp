// SPDX-License-Identifier: LGPL-2.1-or-later
//
// learn: a film's sound and its track → an entry of the catalogue by which visuotactile-follow
// --listen knows the film.
#include "commands.h"

#include "files/regular_file.h"
#include "film/film.h"
#include "film/pipeline.h"
#include "film/progress.h"
#include "library/library.h"
#include "listen/entry.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <gst/app/gstappsink.h>
#include <gst/gst.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace fs = std::filesystem;
using tactile::Time;

namespace {

constexpr int kRate = 16000;                                // Hz, of the decoded sound
constexpr GstClockTime kStalled = 15 * GST_SECOND;          ///< without sound
constexpr std::size_t kMostTrack = std::size_t{ 16 } << 20; ///< bytes
constexpr Time kGap = std::chrono::milliseconds(20);        ///< smaller ones are of rounded times
constexpr std::int64_t kMostSamples = std::int64_t{ 10 } * 3600 * kRate;

/// The film's decoded sound, from its 0:00 on.
class Decoder
{
public:
  explicit Decoder(const Film &film)
      : film_(film),
        pipeline_(make_pipeline(
            "uridecodebin caps=audio/x-raw expose-all-streams=false uri=" + launch_value(film.uri)
            + " ! audioconvert ! audioresample ! appsink name=sound sync=false max-buffers=20 "
              "caps=audio/x-raw,format=F32LE,layout=interleaved,channels=1,rate="
            + std::to_string(kRate))),
        sink_(element(pipeline_, "sound"))
  {
  }

  listen::FilmSound learn(Progress &progress, bool quiet)
  {
    gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING);
    auto *sink = GST_APP_SINK(sink_.get());
    while (!gst_app_sink_is_eos(sink)) {
      g_autoptr(GstSample) sample = gst_app_sink_try_pull_sample(sink, kStalled);
      if (sample != nullptr)
        add(sample);
      else if (!gst_app_sink_is_eos(sink))
        throw std::runtime_error(
            in_text("'{}': its sound cannot be decoded: {}", film_.title, error()));
      if (const std::int64_t minute = count_ / kRate / 60; !quiet && minute != shown_) {
        shown_ = minute;
        progress.show(film_.title + ": " + std::to_string(minute) + " min");
      }
    }
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    if (g_autoptr(GstMessage) failed = gst_bus_pop_filtered(bus.get(), GST_MESSAGE_ERROR))
      throw std::runtime_error(
          in_text("'{}': its sound cannot be decoded: {}", film_.title, text(failed)));
    if (count_ == 0)
      throw std::runtime_error(
          in_text("'{}' has no sound; expected a film with sound", film_.title));
    return maker_.finish();
  }

private:
  static std::string text(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    return error->message;
  }

  std::string error() const
  {
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus.get(), GST_MESSAGE_ERROR);
    return message != nullptr ? text(message) : "nothing came for 15 s";
  }

  /// Sound lies where its time says: before it, and in gaps, is silence.
  void add(GstSample *sample)
  {
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    const std::uint64_t at = gst_segment_to_stream_time(gst_sample_get_segment(sample),
                                                        GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    GstMapInfo map;
    if (!GST_CLOCK_TIME_IS_VALID(at) || !gst_buffer_map(buffer, &map, GST_MAP_READ))
      return;
    std::span<const float> samples(reinterpret_cast<const float *>(map.data),
                                   map.size / sizeof(float));
    const Time begin = Time(static_cast<Time::rep>(at)) - film_.start.stream;
    const Time off = begin - Time(std::llround(static_cast<double>(count_) * 1e9 / kRate));
    const auto gap
        = static_cast<std::int64_t>(std::llround(static_cast<double>(off.count()) * kRate / 1e9));
    if (std::chrono::abs(off) > kGap && gap < 0)
      samples = samples.subspan(std::min(static_cast<std::size_t>(-gap), samples.size()));
    else if (off > kGap)
      add_silence(gap);
    add(samples);
    gst_buffer_unmap(buffer, &map);
  }

  void count(std::int64_t samples)
  {
    if (samples > kMostSamples - count_)
      throw std::runtime_error(in_text("'{}': expected a film of at most 10 hours", film_.title));
    count_ += samples;
  }

  void add(std::span<const float> samples)
  {
    count(static_cast<std::int64_t>(samples.size()));
    maker_.add(samples);
  }

  void add_silence(std::int64_t samples)
  {
    count(samples);
    const std::vector<float> silence(kRate);
    for (; samples > 0; samples -= kRate)
      maker_.add(std::span(silence).first(
          static_cast<std::size_t>(std::min<std::int64_t>(samples, kRate))));
  }

  const Film &film_;
  const Pipeline pipeline_;
  const Owned<GstElement> sink_;
  listen::FilmSoundMaker maker_{ kRate };
  std::int64_t count_ = 0;
  std::int64_t shown_ = -1;
};

} // namespace

int
learn(int argc, char **argv)
{
  TextOption output;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The entry to write or replace (default: beside TRACK, with the ending .heard)"),
      "ENTRY" },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM TRACK",
        .summary = N_("Writes an entry with fingerprints of a film's sound and with its track, by "
                      "which\nvisuotactile-follow --listen recognizes the film on any screen. The "
                      "sound cannot be\nrestored from an entry."),
        .least = 2,
        .most = 2 });
  gst_init(nullptr, nullptr);
  const std::string &track_path = names[1];
  const auto track = or_throw(tactile::read_track_file(track_path));
  auto bytes = files::read(track_path, kMostTrack);
  if (!bytes)
    throw std::runtime_error(in_text("cannot read '{}': {}", track_path, bytes.error().reason));
  const fs::path folder = fs::path(track_path).parent_path();
  const std::string name = fs::path(track_path).filename().string();
  const std::string stem = library::track_stem(name); // by which tactile-track index finds it
  const std::string path = output.text(
      (folder / ((stem.empty() ? fs::path(name).stem().string() : stem) + listen::kEntryEnding))
          .c_str());
  if (!path.ends_with(listen::kEntryEnding))
    throw UsageError(in_text("'{}': expected the ending {}", path, listen::kEntryEnding));
  refuse_same_file(names[0], path);
  const Film film = discover_film(names[0]);
  Progress progress;
  listen::NewEntry entry{ .film = fs::path(names[0]).filename().string(),
                          .track_name = name,
                          .track = *std::move(bytes),
                          .sound = Decoder(film).learn(progress, common.quiet != FALSE) };
  entry.duration = GST_CLOCK_TIME_IS_VALID(film.duration)
                       ? Time(static_cast<Time::rep>(film.duration))
                       : track.end();
  const auto written = listen::write_entry(entry);
  if (!written)
    throw std::runtime_error("'" + path + "': " + written.error());
  write_bytes(*written, path);
  progress.clear();
  if (!common.quiet)
    std::printf(_("%s: %zu hashes, %zu bytes\n"), path.c_str(), entry.sound.hashes.size(),
                written->size());
  return 0;
}
