// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clips.h"

#include "gst/saliency/framemapping.h"
#include "models.h"

#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace quality {

namespace {

constexpr int kSide = 3; ///< rows and columns of the chair
constexpr GstClockTime kPatience = 20 * GST_SECOND;

struct Unref
{
  void operator()(GstElement *element) const
  {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(element);
  }
  void operator()(GstSample *sample) const
  {
    gst_sample_unref(sample);
  }
};

/// A film's decoded frames, one after the other.
class Clip
{
public:
  explicit Clip(const std::filesystem::path &file) : name_(file.string())
  {
    g_autoptr(GError) error = nullptr;
    pipeline_.reset(
        gst_parse_launch("filesrc name=source ! decodebin ! videoconvert ! "
                         "video/x-raw,format=I420 ! appsink name=sink sync=false max-buffers=4",
                         &error));
    if (!pipeline_ || error)
      throw std::runtime_error(std::string("cannot decode films: ")
                               + (error ? error->message : "no pipeline")
                               + " (tools/setup.sh play)");
    g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline_.get()), "source");
    sink_ = gst_bin_get_by_name(GST_BIN(pipeline_.get()), "sink");
    gst_object_unref(sink_); // the pipeline holds it
    g_object_set(source, "location", name_.c_str(), nullptr);
    gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING);
  }

  /// False at the end.
  bool next()
  {
    sample_.reset(gst_app_sink_try_pull_sample(GST_APP_SINK(sink_), kPatience));
    if (sample_)
      return true;
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_.get());
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    g_autoptr(GError) error = nullptr;
    if (message)
      gst_message_parse_error(message, &error, nullptr);
    if (error || !gst_app_sink_is_eos(GST_APP_SINK(sink_)))
      throw std::runtime_error(name_ + ": " + (error ? error->message : "no frame for too long"));
    return false;
  }

  GstBuffer *buffer() const
  {
    return gst_sample_get_buffer(sample_.get());
  }

  GstVideoInfo info() const
  {
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample_.get()))
        || !GST_BUFFER_PTS_IS_VALID(buffer()))
      throw std::runtime_error(name_ + ": a frame without format or time");
    return info;
  }

private:
  std::string name_;
  std::unique_ptr<GstElement, Unref> pipeline_;
  GstElement *sink_ = nullptr;
  std::unique_ptr<GstSample, Unref> sample_;
};

/// How long something has lasted without a break, and how often it has begun.
class Stretches
{
public:
  void frame(bool on, Time time, Time duration)
  {
    if (!on) {
      begin_.reset();
      return;
    }
    if (!begin_) {
      begin_ = time;
      ++count_;
    }
    longest_ = std::max(longest_, time + duration - *begin_);
  }

  double longest() const
  {
    return std::chrono::duration<double>(longest_).count();
  }
  int count() const
  {
    return count_;
  }

private:
  std::optional<Time> begin_;
  Time longest_{ 0 };
  int count_ = 0;
};

/// One profile's way through one film.
class ProfileScore
{
public:
  ProfileScore(std::string name, const saliency::Profile &profile,
               const tactile::MappingSettings &mapping)
      : model_(std::move(name), profile, mapping)
  {
  }

  void frame(const saliency::FrameView &view, Time time, Time duration)
  {
    const saliency::Saliency &found = model_.frame(view, time, duration, map_);
    int felt = 0;
    for (std::size_t i = 0; i < tactors_.size(); ++i) {
      const bool on = map_.levels[i] > 0;
      tactors_[i].frame(on, time, duration);
      felt += on ? 1 : 0;
    }
    chair_.frame(felt > 0, time, duration);
    frames_ += 1;
    active_ += felt > 0 ? 1 : 0;
    felt_ += felt;
    camera_moves_ += found.camera_moves ? 1 : 0;
    cuts_ += found.cut ? 1 : 0;
    length_ += duration;
  }

  ClipRow row(std::string clip) const
  {
    ClipScores scores;
    scores.frames = frames_;
    scores.active = active_ / frames_;
    scores.tactors = felt_ / frames_ / (kSide * kSide);
    scores.tactors_active = active_ > 0 ? felt_ / active_ : 0;
    scores.longest = chair_.longest();
    int cues = 0;
    for (const auto &tactor : tactors_) {
      scores.longest_tactor = std::max(scores.longest_tactor, tactor.longest());
      cues += tactor.count();
    }
    scores.cues_per_minute = cues / std::chrono::duration<double, std::ratio<60>>(length_).count();
    scores.camera_moves = camera_moves_ / frames_;
    scores.cuts = cuts_;
    return { std::move(clip), model_.name(), scores };
  }

private:
  AnalyzerModel model_;
  tactile::TactileMap map_{ kSide, kSide };
  Stretches chair_;
  std::array<Stretches, static_cast<std::size_t>(kSide *kSide)> tactors_;
  int frames_ = 0;
  double active_ = 0;
  double felt_ = 0;
  double camera_moves_ = 0;
  int cuts_ = 0;
  Time length_{ 0 };
};

std::set<std::filesystem::path>
list_clips(const std::filesystem::path &directory)
{
  static const std::set<std::filesystem::path> kFilms{ ".avi", ".m4v", ".mkv", ".mov", ".mp4",
                                                       ".mpg", ".ogv", ".ts",  ".webm" };
  std::set<std::filesystem::path> clips;
  std::error_code error;
  for (const auto &entry : std::filesystem::directory_iterator(directory, error))
    if (kFilms.contains(entry.path().extension()))
      clips.insert(entry.path());
  if (clips.empty())
    throw std::runtime_error(directory.string() + ": no films there");
  return clips;
}

} // namespace

std::vector<ClipRow>
score_clips(const std::filesystem::path &directory)
{
  std::vector<ClipRow> rows;
  for (const auto &file : list_clips(directory)) {
    std::array profiles{
      ProfileScore("paper", saliency::Profile::paper(), tactile::MappingSettings::paper()),
      ProfileScore("tuned", saliency::Profile::tuned(), tactile::MappingSettings::tuned())
    };
    Clip clip(file);
    bool any = false;
    while (clip.next()) {
      any = true;
      const GstVideoInfo info = clip.info();
      GstBuffer *buffer = clip.buffer();
      const FrameMapping mapping(info, buffer);
      if (!mapping)
        throw std::runtime_error(file.string() + ": a frame cannot be read");
      const Time time(static_cast<Time::rep>(GST_BUFFER_PTS(buffer)));
      const Time duration(static_cast<Time::rep>(
          GST_BUFFER_DURATION_IS_VALID(buffer) ? GST_BUFFER_DURATION(buffer)
          : info.fps_n > 0 ? gst_util_uint64_scale_int(GST_SECOND, info.fps_d, info.fps_n)
                           : GST_SECOND / 30));
      for (auto &profile : profiles)
        profile.frame(mapping.view(), time, duration);
    }
    if (!any)
      throw std::runtime_error(file.string() + ": no frames in it");
    for (const auto &profile : profiles)
      rows.push_back(profile.row(file.filename().string()));
  }
  return rows;
}

} // namespace quality
