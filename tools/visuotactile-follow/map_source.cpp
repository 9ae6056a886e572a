// SPDX-License-Identifier: LGPL-2.1-or-later
#include "map_source.h"

#include "film/background.h"
#include "film/film.h"
#include "gst/cues/cue_stream.h"
#include "tracks/formats/webvtt_timing.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

using follow::Time;

namespace {

/// Frames or cues in the queue; when it is full, the pipeline waits.
constexpr guint kMostWaiting = 16;

/// Duration of a cue without one, as in tactileconverter.
constexpr Time kDefaultDuration = std::chrono::seconds(1);

struct SampleUnref
{
  void operator()(GstSample *sample) const
  {
    gst_sample_unref(sample);
  }
};
using Sample = std::unique_ptr<GstSample, SampleUnref>;

Sample
pull(GstElement *sink)
{
  return Sample(gst_app_sink_try_pull_sample(GST_APP_SINK(sink), 0));
}

bool
is_at_end(GstElement *sink)
{
  return gst_app_sink_is_eos(GST_APP_SINK(sink)) != FALSE;
}

/// Takes samples as soon as they come.
void
take_freely(GstElement *sink)
{
  g_object_set(sink, "async", FALSE, "sync", FALSE, nullptr);
}

/// A pipeline whose maps are taken.
class PipelineSource : public follow::MapSource
{
public:
  PipelineSource(const PipelineSource &) = delete;
  PipelineSource &operator=(const PipelineSource &) = delete;
  ~PipelineSource() override = default;

  bool is_open() const override
  {
    return is_open_;
  }
  void seek(Time to, bool exactly) override
  {
    // After the last key frame there is no next one.
    to += start_;
    if (!(exactly
              ? go(to, precisely_)
              : go(to, GST_SEEK_FLAG_KEY_UNIT | GST_SEEK_FLAG_SNAP_AFTER) || go(to, precisely_)))
      failure_ = "it cannot be read from there on";
    sought();
  }
  std::string failure() override
  {
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    while (GstMessage *message = gst_bus_pop(bus.get())) {
      g_autoptr(GError) error = nullptr;
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
        gst_message_parse_error(message, &error, nullptr);
      gst_message_unref(message);
      if (error && failure_.empty())
        failure_ = error->message;
    }
    return failure_;
  }
  bool is_faulty() const override
  {
    return is_faulty_;
  }

protected:
  PipelineSource(int precisely, Time start) : start_(start), precisely_(precisely)
  {
  }

  void run(Pipeline pipeline)
  {
    pipeline_ = std::move(pipeline);
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    run_in_background(pipeline_.get());
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
      throw std::runtime_error(start_error(bus.get()));
  }

  /// Once data passes this pad, all streams are known.
  void open_with(GstPad *pad)
  {
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        +[](GstPad *, GstPadProbeInfo *, gpointer self) {
          static_cast<PipelineSource *>(self)->is_open_ = true;
          return GST_PAD_PROBE_REMOVE;
        },
        this, nullptr);
  }

  /// Derived classes call this first in their destructors, because the threads use their members.
  void stop()
  {
    if (pipeline_)
      gst_element_set_state(pipeline_.get(), GST_STATE_NULL); // they use pipeline_
  }

  virtual void sought() = 0;

  /// Called by the thread that takes maps.
  void find_fault(std::string fault)
  {
    is_faulty_ = is_faulty_ || failure_.empty();
    if (failure_.empty())
      failure_ = std::move(fault);
  }

  const Time start_; ///< stream time of the film's 0:00
  Pipeline pipeline_;

private:
  bool go(Time to, int how)
  {
    return gst_element_seek(pipeline_.get(), 1, GST_FORMAT_TIME,
                            static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | how), GST_SEEK_TYPE_SET,
                            to.count(), GST_SEEK_TYPE_NONE, -1)
           != FALSE;
  }

  const int precisely_; ///< flags of a seek
  std::string failure_;
  bool is_faulty_ = false;
  std::atomic<bool> is_open_{ false };
};

class Analysis : public PipelineSource
{
public:
  Analysis(const std::string &uri, Time start, const AnalysisSettings &settings)
      : PipelineSource(GST_SEEK_FLAG_ACCURATE, start), rate_(settings.rate), sampler_(settings.rate)
  {
    Film film;
    film.uri = uri;
    Pipeline pipeline = make_analysis(film_source(film), settings);
    if (settings.sound == nullptr)
      decode_picture_only(pipeline.get());
    g_object_set(element(pipeline, "analysis").get(), "n-threads", 1, nullptr);
    use_one_thread(pipeline.get());
    maps_ = element(pipeline, "maps");
    g_object_set(maps_.get(), "max-buffers", kMostWaiting, nullptr);
    take_freely(maps_.get());
    open_with(Owned<GstPad>(gst_element_get_static_pad(maps_.get(), "sink")).get());
    run(std::move(pipeline));
  }
  ~Analysis() override
  {
    stop();
  }
  Analysis(const Analysis &) = delete;
  Analysis &operator=(const Analysis &) = delete;

  std::optional<tactile::Cue> take() override
  {
    while (next_.empty()) {
      const Sample sample = pull(maps_.get());
      if (!sample)
        return std::nullopt;
      if (std::optional<FilmMap> map = film_map(sample.get(), start_))
        add(*std::move(map));
    }
    tactile::Cue cue = std::move(next_.front());
    next_.pop_front();
    return cue;
  }
  bool is_ended() const override
  {
    return is_at_end(maps_.get());
  }

private:
  /// A map holds until the next one that is felt.
  void add(FilmMap map)
  {
    if (!held_.levels.empty() && map.begin > end_)
      next_.push_back({ .begin = end_, .end = map.begin, .map = held_ });
    if (sampler_.takes(map))
      held_ = std::move(map.map);
    end_ = map.end;
    next_.push_back({ .begin = map.begin, .end = end_, .map = held_ });
  }

  void sought() override
  {
    next_.clear();
    held_ = {};
    sampler_ = BlockSampler(rate_);
  }

  double rate_;
  BlockSampler sampler_;
  Owned<GstElement> maps_;
  std::deque<tactile::Cue> next_;
  tactile::TactileMap held_; ///< no levels: none yet
  Time end_{ 0 };            ///< of the last map
};

/// Streams come in the demuxer's thread. The first one whose first cue is a map is the track.
class Embedded : public PipelineSource
{
public:
  Embedded(const std::string &path, Time start)
      : PipelineSource(GST_SEEK_FLAG_KEY_UNIT | GST_SEEK_FLAG_SNAP_BEFORE, start)
  {
    Pipeline pipeline
        = make_pipeline("filesrc location=" + launch_value(path) + " ! parsebin name=film");
    g_signal_connect(element(pipeline, "film").get(), "pad-added",
                     G_CALLBACK(+[](GstElement *, GstPad *pad, gpointer self) {
                       static_cast<Embedded *>(self)->add(pad);
                     }),
                     this);
    run(std::move(pipeline));
  }
  ~Embedded() override
  {
    stop();
  }
  Embedded(const Embedded &) = delete;
  Embedded &operator=(const Embedded &) = delete;

  std::optional<tactile::Cue> take() override
  {
    const std::lock_guard lock(mutex_);
    for (Stream &stream : streams_)
      while (const Sample sample = stream.is_other ? Sample() : pull(stream.sink.get())) {
        if (std::optional<tactile::Cue> cue = cue_of(stream, sample.get()))
          return cue;
        if (stream.is_other)
          g_object_set(stream.sink.get(), "drop", TRUE, nullptr);
      }
    return std::nullopt;
  }
  bool is_ended() const override
  {
    const std::lock_guard lock(mutex_);
    return is_open() && std::ranges::all_of(streams_, [](const Stream &stream) {
             return stream.is_other || is_at_end(stream.sink.get());
           });
  }

private:
  struct Stream
  {
    Owned<GstElement> sink;
    CueForm form = CueForm::text;
    bool is_other = false;               ///< no track, or another one
    std::optional<tactile::Grid> grid{}; ///< of the track
  };

  void add(GstPad *pad)
  {
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
    if (!caps)
      caps = gst_pad_query_caps(pad, nullptr);
    const std::optional<CueForm> form = cue_form_of(caps);
    GstElement *sink = gst_element_factory_make(form ? "appsink" : "fakesink", nullptr);
    take_freely(sink);
    if (form) {
      g_object_set(sink, "max-buffers", kMostWaiting, nullptr);
      const std::lock_guard lock(mutex_);
      streams_.push_back(
          { .sink = Owned<GstElement>(GST_ELEMENT(gst_object_ref(sink))), .form = *form });
    }
    open_with(pad);
    gst_bin_add(GST_BIN(pipeline_.get()), sink);
    const Owned<GstPad> to(gst_element_get_static_pad(sink, "sink"));
    gst_pad_link(pad, to.get());
    gst_element_sync_state_with_parent(sink);
  }

  std::optional<tactile::Cue> cue_of(Stream &stream, GstSample *sample)
  {
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    auto cue = cue_from_buffer(buffer, stream.form, stream.grid);
    const GstClockTime time = gst_segment_to_stream_time(gst_sample_get_segment(sample),
                                                         GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    if (!stream.grid) {
      stream.is_other = !cue || std::ranges::any_of(streams_, [](const Stream &one) {
        return one.grid.has_value();
      });
      if (stream.is_other)
        return std::nullopt;
      stream.grid = { cue->map.rows, cue->map.columns };
    }
    if (!GST_CLOCK_TIME_IS_VALID(time) || (!cue && cue_is_remark(buffer, stream.form)))
      return std::nullopt;
    const Time begin = Time(static_cast<Time::rep>(time)) - start_;
    if (cue && tactile::Grid{ cue->map.rows, cue->map.columns } != *stream.grid)
      cue = tl::unexpected(tactile::FormatError{
          .place = {}, .reason = "a map of another grid than the first one's" });
    if (!cue) {
      find_fault("the cue at " + tactile::write_webvtt_timestamp(begin) + ": "
                 + cue.error().text());
      return std::nullopt;
    }
    Time duration = cue->end > Time(0) ? cue->end : kDefaultDuration;
    if (GST_BUFFER_DURATION_IS_VALID(buffer) && GST_BUFFER_DURATION(buffer) > 0)
      duration = Time(static_cast<Time::rep>(GST_BUFFER_DURATION(buffer)));
    cue->begin = begin;
    cue->end = cue->begin + duration;
    cue->begin = std::max(cue->begin, Time(0));
    return *std::move(cue);
  }

  void sought() override
  {
  }

  mutable std::mutex mutex_;
  std::vector<Stream> streams_;
};

} // namespace

std::unique_ptr<follow::MapSource>
open_analysis(const std::string &uri, Time start, const AnalysisSettings &settings)
{
  return std::make_unique<Analysis>(uri, start, settings);
}

std::unique_ptr<follow::MapSource>
open_embedded(const std::string &path, Time start)
{
  return std::make_unique<Embedded>(path, start);
}
