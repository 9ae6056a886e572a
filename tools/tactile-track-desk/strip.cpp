// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strip.h"

#include "glance.h"

#include "files/whole_file.h"
#include "film/frame_times.h"
#include "film/sound.h"
#include "frame/front_end.h"
#include "saliency/shot_cut.h"
#include "sound/sound_analyzer.h"
#include "sound/speakers.h"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <span>

namespace {

constexpr const char *kMadeWith = "strip=3 version=" PACKAGE_VERSION;
constexpr const char *kKept
    = "(xaayayaxxax)"; ///< interval, pictures, peaks, cuts, their end, impacts
constexpr std::size_t kMostKept = std::size_t{ 64 } << 20;
constexpr int kWidth = 160;                  ///< of a picture, pixels
constexpr gint64 kLongest = 100 * 3'600'000; ///< ms
constexpr const char *kQueue = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=1000000000";

/// Film time in ms; < 0: none. `start`: the stream time of the film's 0:00.
gint64
time_of(GstSample *sample, visuotactile::Time start)
{
  const GstClockTime time
      = gst_segment_to_stream_time(gst_sample_get_segment(sample), GST_FORMAT_TIME,
                                   GST_BUFFER_PTS(gst_sample_get_buffer(sample)));
  return GST_CLOCK_TIME_IS_VALID(time)
             ? (static_cast<gint64>(time) - start.count()) / static_cast<gint64>(GST_MSECOND)
             : -1;
}

} // namespace

/// Shot cuts as the analysis finds them, in small pictures.
class Strip::Eye
{
public:
  Eye() : is_cut_(saliency::Profile::tuned())
  {
  }

  bool sees_cut(const GstVideoFrame &frame)
  {
    saliency::FrameView view;
    view.width = GST_VIDEO_FRAME_WIDTH(&frame);
    view.height = GST_VIDEO_FRAME_HEIGHT(&frame);
    view.model = saliency::ColorModel::rgb;
    for (guint i = 0; i < view.components.size(); i++)
      view.components[i]
          = { .data = static_cast<const std::uint8_t *>(GST_VIDEO_FRAME_COMP_DATA(&frame, i)),
              .row_stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame, i),
              .pixel_stride = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, i),
              .width = view.width,
              .height = view.height };
    return is_cut_(to_float(front_end_.lab(view, 0, 0)));
  }

private:
  saliency::FrontEnd front_end_;
  saliency::ShotCut is_cut_;
};

/// Impacts as the analysis of sound finds them, in the mean of all channels.
class Strip::Ear
{
public:
  /// Takes interleaved samples from a film time in ms on. Adds the times of impacts.
  void hear(std::span<const gint16> samples, int channels, int rate, gint64 time,
            std::vector<gint64> &impacts)
  {
    using Analyzer = sound::SoundAnalyzer;
    if (rate < Analyzer::kLowestRate || rate > Analyzer::kHighestRate)
      return;
    constexpr gint64 kLeap = 50; // ms
    const gint64 expected = begin_ + static_cast<gint64>(frames_) * 1000 / rate;
    if (rate != rate_ || std::abs(time - expected) > kLeap) {
      constexpr bool kLooksAhead = true;
      analyzer_.emplace(rate, std::span(&sound::kCenter, 1), kLooksAhead);
      begin_ = time;
      frames_ = 0;
      rate_ = rate;
    }
    mean_.clear();
    const auto wide = static_cast<std::size_t>(channels);
    for (std::size_t at = 0; at + wide <= samples.size(); at += wide) {
      const auto frame = samples.subspan(at, wide);
      constexpr float kFullScale = 32768;
      mean_.push_back(std::accumulate(frame.begin(), frame.end(), 0.F)
                      / (static_cast<float>(channels) * kFullScale));
    }
    frames_ += mean_.size();
    for (const sound::Moment &moment : analyzer_->add(mean_, {}))
      if (moment.onset)
        impacts.push_back(begin_
                          + (moment.begin + sound::kHopTime / 2) / std::chrono::milliseconds(1));
  }

private:
  std::optional<sound::SoundAnalyzer> analyzer_;
  int rate_ = 0;
  gint64 begin_ = 0; ///< ms, of the first of `frames_`
  std::size_t frames_ = 0;
  std::vector<float> mean_;
};

Strip::Strip(const Film &film, const std::string &path)
    : path_(path), cache_(FilmCache::usual_folder("strips"), ".strip"),
      version_(library::file_version(path)), width_(kWidth),
      height_(film.width > 0
                  ? std::clamp((film.height * kWidth / film.width + 1) / 2 * 2, 2, 4 * kWidth)
                  : kWidth),
      duration_(GST_CLOCK_TIME_IS_VALID(film.duration)
                    ? std::min(static_cast<gint64>(GST_TIME_AS_MSECONDS(film.duration)), kLongest)
                    : 0),
      start_(film.start.stream), eye_(std::make_unique<Eye>()), ear_(std::make_unique<Ear>())
{
  constexpr gint64 kUnknown = 5000; // ms; 1000 pictures of a film of 80 minutes
  constexpr gint64 kLeast = 1000;
  interval_ = duration_ > 0 ? std::max(kLeast, (duration_ + static_cast<gint64>(kMostPictures) - 1)
                                                   / static_cast<gint64>(kMostPictures))
                            : kUnknown;
  if (load())
    progress_ = 1;
}

Strip::~Strip() = default;

gint64
Strip::glances() const
{
  constexpr gint64 kSoon = 10 * 60'000; // ms: shorter films are soon decoded
  constexpr std::size_t kGlances = 100;
  return is_whole() || duration_ < kSoon
             ? 0
             : static_cast<gint64>((total() + kGlances - 1) / kGlances) * interval_;
}

void
Strip::glimpse(gint64 ms, std::string jpeg)
{
  const std::lock_guard lock(mutex_);
  if (!jpeg.empty())
    glances_[static_cast<std::size_t>(ms / interval_)] = std::move(jpeg);
}

void
Strip::glanced()
{
  const std::lock_guard lock(mutex_);
  has_glanced_ = true;
}

std::string
Strip::line(const Film &film) const
{
  std::string line = " split.src ! queue max-size-buffers=4 max-size-bytes=0 max-size-time=0"
                     + small_pictures(width_, height_);
  if (film.has_sound)
    line += heard_sound(kQueue, nullptr)
            + "audio/x-raw,format=S16LE,layout=interleaved ! appsink name=ear sync=false "
              "max-buffers=16";
  return line;
}

void
Strip::listen(const Pipeline &pipeline)
{
  const auto listen = [&](const char *name, auto new_sample) {
    const Owned<GstElement> sink = element(pipeline, name);
    if (!sink)
      return;
    g_object_set(sink.get(), "async", FALSE, nullptr); // the maps, which come before, do not wait
    GstAppSinkCallbacks callbacks{};
    callbacks.new_sample = new_sample;
    gst_app_sink_set_callbacks(GST_APP_SINK(sink.get()), &callbacks, this, nullptr);
    let_times_advance(Owned<GstPad>(gst_element_get_static_pad(sink.get(), "sink")).get());
  };
  listen("eye", [](GstAppSink *sink, gpointer self) {
    if (GstSample *sample = gst_app_sink_pull_sample(sink)) {
      static_cast<Strip *>(self)->on_frame(sample);
      gst_sample_unref(sample);
    }
    return GST_FLOW_OK;
  });
  listen("ear", [](GstAppSink *sink, gpointer self) {
    if (GstSample *sample = gst_app_sink_pull_sample(sink)) {
      static_cast<Strip *>(self)->on_sound(sample);
      gst_sample_unref(sample);
    }
    return GST_FLOW_OK;
  });
  if (element(pipeline, "ear"))
    g_signal_connect(element(pipeline, "film").get(), "no-more-pads",
                     G_CALLBACK(+[](GstElement *, gpointer top) {
                       end_missing_sound(static_cast<GstElement *>(top));
                     }),
                     pipeline.get());
}

void
Strip::end(const std::string &failure)
{
  if (is_whole())
    return;
  const std::lock_guard lock(mutex_);
  progress_ = failure.empty() ? 1 : -1;
  if (failure.empty())
    keep();
}

bool
Strip::load()
{
  const std::string file = cache_.find(path_, kMadeWith);
  const auto bytes = files::read_whole(file, kMostKept);
  if (file.empty() || !bytes)
    return false;
  g_autoptr(GBytes) data = g_bytes_new_static(bytes->data(), bytes->size());
  g_autoptr(GVariant) kept
      = g_variant_ref_sink(g_variant_new_from_bytes(G_VARIANT_TYPE(kKept), data, FALSE));
  gint64 interval = 0;
  gint64 until = 0;
  g_autoptr(GVariant) pictures = nullptr;
  g_autoptr(GVariant) peaks = nullptr;
  g_autoptr(GVariant) cuts = nullptr;
  g_autoptr(GVariant) impacts = nullptr;
  g_variant_get(kept, "(x@aay@ay@axx@ax)", &interval, &pictures, &peaks, &cuts, &until, &impacts);
  const auto bytes_of = [](GVariant *array) {
    gsize size = 0;
    const auto *first
        = static_cast<const char *>(g_variant_get_fixed_array(array, &size, sizeof(char)));
    return size > 0 ? std::string(first, size) : std::string();
  };
  const auto times_of = [](GVariant *array) {
    gsize size = 0;
    const auto *first
        = static_cast<const gint64 *>(g_variant_get_fixed_array(array, &size, sizeof(gint64)));
    return std::vector(first, first + size);
  };
  const gsize count = g_variant_n_children(pictures);
  if (interval != interval_ || count == 0 || count > kMostPictures)
    return false;
  for (gsize i = 0; i < count; i++) {
    g_autoptr(GVariant) picture = g_variant_get_child_value(pictures, i);
    pictures_.push_back(bytes_of(picture));
  }
  peaks_ = bytes_of(peaks);
  events_ = { .cuts = times_of(cuts), .until = until, .impacts = times_of(impacts) };
  return true;
}

void
Strip::keep() const
{
  const auto variant_of = [](const std::string &bytes) {
    return g_variant_new_fixed_array(G_VARIANT_TYPE_BYTE, bytes.data(), bytes.size(), 1);
  };
  const auto times_of = [](const std::vector<gint64> &times) {
    return g_variant_new_fixed_array(G_VARIANT_TYPE_INT64, times.data(), times.size(),
                                     sizeof(gint64));
  };
  GVariantBuilder pictures;
  g_variant_builder_init(&pictures, G_VARIANT_TYPE("aay"));
  for (const std::string &picture : pictures_)
    g_variant_builder_add_value(&pictures, variant_of(picture));
  g_autoptr(GVariant) all = g_variant_ref_sink(g_variant_new(
      "(x@aay@ay@axx@ax)", interval_, g_variant_builder_end(&pictures), variant_of(peaks_),
      times_of(events_.cuts), events_.until, times_of(events_.impacts)));
  try {
    cache_.keep({ static_cast<const char *>(g_variant_get_data(all)), g_variant_get_size(all) },
                path_, version_, kMadeWith);
  } catch (const std::exception &) { // the film is decoded again
  }
}

void
Strip::on_frame(GstSample *sample)
{
  const gint64 time = time_of(sample, start_);
  GstVideoInfo info;
  GstVideoFrame frame;
  if (time < 0 || time > kLongest || !gst_video_info_from_caps(&info, gst_sample_get_caps(sample))
      || !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return;
  const bool is_cut = eye_->sees_cut(frame);
  gst_video_frame_unmap(&frame);
  // Only this thread adds pictures.
  std::string picture;
  if (pictures_.size() < kMostPictures && time >= static_cast<gint64>(pictures_.size()) * interval_)
    picture = jpeg_of(sample);
  const std::lock_guard lock(mutex_);
  // A jump in the film's time repeats the picture.
  while (!picture.empty() && pictures_.size() < kMostPictures
         && time >= static_cast<gint64>(pictures_.size()) * interval_)
    pictures_.push_back(picture);
  if (is_cut)
    events_.cuts.push_back(time);
  events_.until = time;
  if (duration_ > 0)
    progress_ = std::min(static_cast<double>(time) / static_cast<double>(duration_), 0.999);
}

void
Strip::on_sound(GstSample *sample)
{
  constexpr int kFullScale = 32768;
  const gint64 time = time_of(sample, start_);
  const GstStructure *format = gst_caps_get_structure(gst_sample_get_caps(sample), 0);
  int rate = 0;
  int channels = 0;
  GstMapInfo map;
  if (time < 0 || time > kLongest || !gst_structure_get_int(format, "rate", &rate) || rate <= 0
      || !gst_structure_get_int(format, "channels", &channels) || channels <= 0
      || !gst_buffer_map(gst_sample_get_buffer(sample), &map, GST_MAP_READ))
    return;
  const std::span samples(reinterpret_cast<const gint16 *>(map.data), map.size / sizeof(gint16));
  std::vector<gint64> impacts;
  ear_->hear(samples, channels, rate, time, impacts);
  const std::lock_guard lock(mutex_);
  events_.impacts.insert(events_.impacts.end(), impacts.begin(), impacts.end());
  for (std::size_t i = 0; i < samples.size(); i++) {
    const auto index = static_cast<std::size_t>(
        (time + static_cast<gint64>(i) / channels * 1000 / rate) / kPeak);
    if (index >= peaks_.size())
      peaks_.resize(index + 1);
    const int peak = std::min(std::abs(static_cast<int>(samples[i])) * 256 / kFullScale, 255);
    auto &there = reinterpret_cast<std::uint8_t &>(peaks_[index]);
    there = std::max(there, static_cast<std::uint8_t>(peak));
  }
  gst_buffer_unmap(gst_sample_get_buffer(sample), &map);
}

double
Strip::progress() const
{
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::size_t
Strip::count() const
{
  const std::lock_guard lock(mutex_);
  return pictures_.size();
}

std::size_t
Strip::shown() const
{
  const std::lock_guard lock(mutex_);
  return has_glanced_ && !glances_.empty()
             ? std::max(pictures_.size(), std::min(total(), kMostPictures))
             : pictures_.size();
}

std::size_t
Strip::total() const
{
  return static_cast<std::size_t>((duration_ + interval_ - 1) / interval_);
}

std::string
Strip::picture(std::size_t index) const
{
  const std::lock_guard lock(mutex_);
  if (index < pictures_.size())
    return pictures_[index];
  const auto next = index < total() ? glances_.upper_bound(index) : glances_.begin();
  return next != glances_.begin() ? std::prev(next)->second : std::string();
}

std::string
Strip::peaks(std::size_t from) const
{
  const std::lock_guard lock(mutex_);
  return from < peaks_.size() ? peaks_.substr(from) : std::string();
}

Strip::Events
Strip::events() const
{
  const std::lock_guard lock(mutex_);
  return events_;
}
