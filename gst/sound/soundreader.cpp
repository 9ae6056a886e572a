// SPDX-License-Identifier: LGPL-2.1-or-later
#include "soundreader.h"

#include <algorithm>

namespace {

constexpr gsize kBlock = 1024;                       ///< frames
constexpr GstClockTimeDiff kJump = 20 * GST_MSECOND; ///< time stamps are rounded
constexpr auto kHop = static_cast<GstClockTime>(sound::kHopTime.count());

sound::Speaker
speaker(GstAudioChannelPosition position)
{
  switch (position) {
  case GST_AUDIO_CHANNEL_POSITION_FRONT_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_FRONT_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_WIDE_LEFT:
    return sound::speaker_at(-1, 0);
  case GST_AUDIO_CHANNEL_POSITION_FRONT_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_FRONT_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_WIDE_RIGHT:
    return sound::speaker_at(1, 0);
  case GST_AUDIO_CHANNEL_POSITION_FRONT_LEFT_OF_CENTER:
    return sound::speaker_at(-0.5, 0);
  case GST_AUDIO_CHANNEL_POSITION_FRONT_RIGHT_OF_CENTER:
    return sound::speaker_at(0.5, 0);
  case GST_AUDIO_CHANNEL_POSITION_REAR_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_SIDE_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_SURROUND_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_REAR_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_SIDE_LEFT:
    return sound::speaker_at(-1, 1);
  case GST_AUDIO_CHANNEL_POSITION_REAR_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_SIDE_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_SURROUND_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_REAR_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_TOP_SIDE_RIGHT:
    return sound::speaker_at(1, 1);
  case GST_AUDIO_CHANNEL_POSITION_REAR_CENTER:
  case GST_AUDIO_CHANNEL_POSITION_TOP_REAR_CENTER:
    return sound::speaker_at(0, 1);
  case GST_AUDIO_CHANNEL_POSITION_LFE1:
  case GST_AUDIO_CHANNEL_POSITION_LFE2:
    return sound::kLow;
  default:
    return sound::kCenter;
  }
}

} // namespace

bool
SoundReader::set_format(const GstAudioInfo &info, int rows, int columns)
{
  reset();
  analyzer_.reset();
  info_ = info;
  map_ = tactile::TactileMap(rows, columns);
  const auto channels = static_cast<gsize>(GST_AUDIO_INFO_CHANNELS(&info));
  if (channels < 1 || channels > sound::kMaxSpeakers
      || GST_AUDIO_INFO_RATE(&info) < sound::SoundAnalyzer::kLowestRate
      || GST_AUDIO_INFO_RATE(&info) > sound::SoundAnalyzer::kHighestRate)
    return false;
  make_analyzer();
  frames_.resize(kBlock * channels);
  unpacked_.resize(kBlock * channels * sizeof(gdouble));
  return true;
}

void
SoundReader::make_analyzer()
{
  std::vector<sound::Speaker> speakers;
  for (guint c = 0; c < static_cast<guint>(GST_AUDIO_INFO_CHANNELS(&info_)); c++)
    speakers.push_back(GST_AUDIO_INFO_IS_UNPOSITIONED(&info_)
                           ? sound::kCenter
                           : speaker(GST_AUDIO_INFO_POSITION(&info_, c)));
  analyzer_.emplace(GST_AUDIO_INFO_RATE(&info_), speakers, looks_ahead_);
}

void
SoundReader::look_ahead(bool looks_ahead)
{
  looks_ahead_ = looks_ahead;
  if (analyzer_)
    make_analyzer();
}

void
SoundReader::set_grid(int rows, int columns)
{
  map_ = tactile::TactileMap(rows, columns);
}

GstClockTime
SoundReader::latency(guint maps_per_second) const
{
  if (!analyzer_)
    return 0;
  // A map ends with a hop.
  const GstClockTime length = GST_SECOND / maps_per_second;
  return (length + kHop - 1) / kHop * kHop + static_cast<GstClockTime>(analyzer_->delay().count());
}

void
SoundReader::reset()
{
  if (analyzer_)
    analyzer_->reset();
  clear();
  base_ = GST_CLOCK_TIME_NONE;
  count_ = 0;
  number_ = 0;
}

void
SoundReader::clear()
{
  std::ranges::fill(map_.levels, 0.0F);
  map_.frequency = 0;
  strongest_ = 0;
}

GstClockTime
SoundReader::slot(gint64 number, guint maps_per_second) const
{
  return gst_util_uint64_scale_int(static_cast<guint64>(number), GST_SECOND,
                                   static_cast<gint>(maps_per_second));
}

/* Each format unpacks to 32-bit integers or doubles. */
void
SoundReader::convert(const GstAudioBuffer &audio, gsize first, gsize count)
{
  const GstAudioFormatInfo *format = audio.info.finfo;
  const auto channels = static_cast<gsize>(GST_AUDIO_INFO_CHANNELS(&audio.info));
  const gsize per_plane = channels / static_cast<gsize>(audio.n_planes);
  const gsize stride
      = static_cast<gsize>(GST_AUDIO_FORMAT_INFO_WIDTH(format)) / 8 * per_plane; // bytes a frame
  const bool is_double = format->unpack_format == GST_AUDIO_FORMAT_F64;
  for (gsize plane = 0; plane < static_cast<gsize>(audio.n_planes); plane++) {
    format->unpack_func(format, GST_AUDIO_PACK_FLAG_NONE, unpacked_.data(),
                        static_cast<guint8 *>(audio.planes[plane]) + first * stride,
                        static_cast<gint>(count * per_plane));
    for (gsize i = 0; i < count * per_plane; i++) {
      float sample = 0;
      if (is_double)
        sample = static_cast<float>(reinterpret_cast<const gdouble *>(unpacked_.data())[i]);
      else
        sample
            = static_cast<float>(reinterpret_cast<const gint32 *>(unpacked_.data())[i]) * 0x1p-31F;
      frames_[i / per_plane * channels + plane * per_plane + i % per_plane] = sample;
    }
  }
}

void
SoundReader::feel(std::span<const sound::Moment> moments, const Settings &settings,
                  const MapSink &sink)
{
  for (const sound::Moment &moment : moments) {
    const auto begin = static_cast<GstClockTime>(moment.begin.count());
    if (moment.level > strongest_) {
      strongest_ = moment.level;
      map_.frequency = moment.frequency;
    }
    if (moment.level > 0)
      sound::raise(map_, moment.place, analyzer_->has_rear(), moment.level);
    const GstClockTime end = slot(number_ + 1, settings.maps_per_second);
    if (begin + kHop < end)
      continue;
    sink(map_, base_ + slot(number_, settings.maps_per_second), base_ + end);
    number_++;
    clear();
  }
}

void
SoundReader::read(GstBuffer *buffer, const Settings &settings, const MapSink &sink)
{
  if (!analyzer_)
    return;
  GstAudioBuffer audio;
  if (!gst_audio_buffer_map(&audio, &info_, buffer, GST_MAP_READ))
    return;
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  const GstClockTime expected
      = base_ + gst_util_uint64_scale_int(count_, GST_SECOND, GST_AUDIO_INFO_RATE(&info_));
  if (base_ == GST_CLOCK_TIME_NONE || ABS(GST_CLOCK_DIFF(expected, pts)) > kJump) {
    if (base_ != GST_CLOCK_TIME_NONE)
      drain(settings, sink);
    base_ = pts;
  }
  const auto channels = static_cast<gsize>(GST_AUDIO_INFO_CHANNELS(&info_));
  for (gsize first = 0; first < audio.n_samples; first += kBlock) {
    const gsize count = std::min(kBlock, audio.n_samples - first);
    convert(audio, first, count);
    count_ += count;
    feel(analyzer_->add(std::span(frames_).first(count * channels), settings.feel), settings, sink);
  }
  gst_audio_buffer_unmap(&audio);
}

void
SoundReader::drain(const Settings &settings, const MapSink &sink)
{
  if (!analyzer_ || base_ == GST_CLOCK_TIME_NONE)
    return;
  const auto channels = static_cast<gsize>(GST_AUDIO_INFO_CHANNELS(&info_));
  const GstClockTime end
      = gst_util_uint64_scale_int(count_, GST_SECOND, GST_AUDIO_INFO_RATE(&info_));
  std::ranges::fill(frames_, 0.0F);
  while (slot(number_, settings.maps_per_second) < end)
    feel(analyzer_->add(std::span(frames_).first(kBlock / 8 * channels), settings.feel), settings,
         [&](const tactile::TactileMap &map, GstClockTime from, GstClockTime to) {
           if (from < base_ + end)
             sink(map, from, std::min(to, base_ + end));
         });
  reset();
}
