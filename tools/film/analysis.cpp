// SPDX-License-Identifier: LGPL-2.1-or-later
#include "analysis.h"

#include "frame_times.h"
#include "gst/fusion/sound_meta.h"
#include "sound.h"
#include "tracks/text_cue.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <chrono>
#include <utility>

using visuotactile::Time;

namespace {

/// What picture and sound may be apart in a file.
constexpr const char *kQueue = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=1000000000";

/// Raised where the same film gets another track within one version. 2: times from 0:00 on. 3:
/// blocks that begin with what becomes stronger. 4: events; sound learned from real sounds. 5:
/// faces; the loudness of weak and loud films.
constexpr const char *kAnalysis = "5";

} // namespace

std::string
made_with(const AnalysisSettings &settings)
{
  return tactile::write_grid({ settings.rows, settings.columns }, settings.rate) + " profile="
         + settings.profile + " sound=" + (settings.sound != nullptr ? settings.sound->name : "off")
         + (settings.parts > 1 ? " parts=" + std::to_string(settings.parts) : "")
         + " version=" PACKAGE_VERSION "-" + kAnalysis;
}

Pipeline
make_analysis(const std::string &source, const AnalysisSettings &settings, const std::string &more)
{
  Pipeline pipeline = make_pipeline(
      source + " film. ! queue ! videoconvert ! saliencytactile name=analysis rows="
      + std::to_string(settings.rows) + " columns=" + std::to_string(settings.columns)
      + " profile=" + settings.profile + joined_sound(kQueue, settings.sound)
      + " ! tactileextractor name=split split.tactile ! appsink name=maps sync=false"
      + (settings.sound ? heard_sound(kQueue, settings.sound) + "fakesink sync=false" : "") + more);
  const Owned<GstElement> analysis = element(pipeline, "analysis");
  let_times_advance(Owned<GstPad>(gst_element_get_static_pad(analysis.get(), "sink")).get());
  if (settings.sound)
    g_signal_connect(
        element(pipeline, "film").get(), "no-more-pads",
        G_CALLBACK(+[](GstElement *, gpointer whole) { end_missing_sound(GST_ELEMENT(whole)); }),
        pipeline.get());
  return pipeline;
}

std::optional<FilmMap>
film_map(GstSample *sample, Time start)
{
  GstBuffer *buffer = gst_sample_get_buffer(sample);
  guint rows = 0;
  guint columns = 0;
  g_autofree gfloat *levels = nullptr;
  gsize count = 0;
  const GstClockTime time = gst_segment_to_stream_time(gst_sample_get_segment(sample),
                                                       GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  if (!GST_CLOCK_TIME_IS_VALID(time)
      || !gst_tactile_map_caps_parse(gst_sample_get_caps(sample), &rows, &columns, nullptr, nullptr)
      || !gst_tactile_map_buffer_get_levels(buffer, rows, columns, &levels, &count))
    return std::nullopt;
  FilmMap map{ .begin = Time(static_cast<Time::rep>(time)) - start,
               .map = tactile::TactileMap(static_cast<int>(rows), static_cast<int>(columns)),
               .at_once = GST_BUFFER_FLAG_IS_SET(buffer, kSoundMap) };
  map.map.levels.assign(levels, levels + count);
  map.end = map.begin;
  if (GST_BUFFER_DURATION_IS_VALID(buffer))
    map.end += Time(static_cast<Time::rep>(GST_BUFFER_DURATION(buffer)));
  map.begin = std::max(map.begin, Time(0));
  return map.end >= map.begin ? std::optional(std::move(map)) : std::nullopt;
}

bool
BlockSampler::takes(FilmMap &map)
{
  if (!blocks_.take({ map.begin, map.end - map.begin, map.map.levels, map.at_once }, rate_))
    return false;
  for (std::size_t i = 0; i < map.map.levels.size(); i++)
    map.map.levels[i] = blocks_.level(i);
  return true;
}

TrackRecorder::TrackRecorder(const AnalysisSettings &settings)
    : track_(settings.rows, settings.columns), sampler_(settings.rate)
{
  track_.set_rate(settings.rate);
}

tl::expected<void, tactile::FormatError>
TrackRecorder::add(FilmMap map)
{
  if (sampler_.takes(map))
    if (auto appended = track_.append(std::max(map.begin, track_.end()), map.map); !appended)
      return appended;
  end_ = std::max(end_, map.end);
  return {};
}

tl::expected<tactile::Track, tactile::FormatError>
TrackRecorder::finish()
{
  if (const auto ended = track_.set_end(std::max(end_, track_.end())); !ended)
    return tl::unexpected(ended.error());
  return track_;
}
