// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthoutput.h"

#include "synthcaps.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

using synth::Play;
using synth::Time;

GST_DEBUG_CATEGORY_EXTERN(tactile_synth_debug);
#define GST_CAT_DEFAULT tactile_synth_debug

namespace {

/// Length of a buffer.
constexpr gint kBuffersPerSecond = 50;

/// Silence beyond this is a GAP rather than samples.
constexpr gint kLongestSilence = 10; ///< s

GstClockTime
to_clock_time(Time time)
{
  return static_cast<GstClockTime>(time.count());
}

/// Stream time of a running time; before the segment, that of its begin.
guint64
stream_time(const GstSegment &segment, Time running)
{
  const guint64 time = std::max<guint64>(to_clock_time(running), segment.base);
  const guint64 position = gst_segment_position_from_running_time(&segment, GST_FORMAT_TIME, time);
  const guint64 found = position == GST_CLOCK_TIME_NONE
                            ? position
                            : gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, position);
  return found == GST_CLOCK_TIME_NONE ? segment.time : found;
}

gint
wanted_channels(const SynthSettings &settings, guint rows, guint columns)
{
  const auto last = std::ranges::max_element(settings.mapping);
  const gint wanted
      = last == settings.mapping.end() ? static_cast<gint>(rows * columns) : *last + 1;
  return std::clamp(wanted, 1, SynthSettings::kMostChannels);
}

} // namespace

SynthOutput::SynthOutput(GstElement *element, GstPad *pad, SynthParts &parts,
                         std::function<bool()> is_silent)
    : element_(element), pad_(pad), parts_(parts), is_silent_(std::move(is_silent))
{
  reset();
}

Play *
SynthOutput::play()
{
  return play_ ? &*play_ : nullptr;
}

void
SynthOutput::set_segment(const GstSegment &segment, guint32 seqnum)
{
  segment_ = segment;
  seqnum_ = seqnum;
  segment_sent_ = false;
}

const GstSegment &
SynthOutput::segment() const
{
  return segment_;
}

void
SynthOutput::begin(Time time)
{
  play_->begin(time);
  resync_ = true;
}

void
SynthOutput::flush(bool resets_time)
{
  if (play_ && play_->has_begun())
    play_->flush(resets_time);
  segment_sent_ = false;
  gst_segment_init(&segment_, GST_FORMAT_TIME);
}

void
SynthOutput::reset()
{
  gst_segment_init(&segment_, GST_FORMAT_TIME);
  info_.reset();
  play_.reset();
  rows_ = columns_ = 0;
  segment_sent_ = false;
  resync_ = true;
}

/* ---- negotiation ---- */

/// The cells of each channel, for a map of this grid. Tells what becomes of the cells.
void
SynthOutput::set_cells(const SynthSettings &settings)
{
  const gint channels = GST_AUDIO_INFO_CHANNELS(&*info_);
  const auto count = static_cast<int>(rows_ * columns_);
  synth::ChannelCells cells = synth_cells(*info_, rows_, columns_);
  const std::string wrong
      = tactor::CommandPlanner::validate_mapping(settings.mapping, count, channels);
  if (!settings.mapping.empty() && wrong.empty())
    cells = synth::mapped_cells(settings.mapping, channels);
  const std::string text = synth_describe(cells);
  if (!settings.mapping.empty() && !wrong.empty())
    GST_ELEMENT_WARNING(element_, STREAM, FORMAT,
                        ("The mapping does not fit the film and the sound card: it is not used."),
                        ("%s; %s", wrong.c_str(), text.c_str()));
  else if (!std::ranges::all_of(cells, [](const auto &own) { return own.size() == 1; }))
    GST_ELEMENT_INFO(element_, STREAM, FORMAT,
                     ("%u x %u cells are felt on %d channel%s.", rows_, columns_, channels,
                      channels == 1 ? "" : "s"),
                     ("%s", text.c_str()));
  play_->set_cells(std::move(cells));
}

/// Tells which channels reach full scale before the highest level.
void
SynthOutput::tell_limited(const std::vector<synth::Voice> &voices)
{
  std::string text;
  for (std::size_t i = 0; i < voices.size(); i++)
    if (voices[i].gain > 1.001F) // more than rounding leaves
      text.append(text.empty() ? "" : "; ")
          .append("channel " + std::to_string(i) + " at "
                  + std::to_string(std::lround(100 / voices[i].gain)) + " %");
  if (!text.empty())
    GST_ELEMENT_INFO(element_, LIBRARY, SETTINGS,
                     ("Stronger maps are limited: gain and equalizer of the calibration reach full "
                      "scale before."),
                     ("full scale of %s of the strongest level", text.c_str()));
}

/// Begins to play in the format of `info`, with the sample after the last one.
void
SynthOutput::start_play(const GstAudioInfo &info, const SynthSettings &settings)
{
  const gint channels = GST_AUDIO_INFO_CHANNELS(&info);
  const std::optional<Time> now
      = play_ && play_->has_begun() ? std::optional(play_->now()) : std::nullopt;
  std::vector<synth::Voice> voices = parts_.carriers.voices(channels);
  tell_limited(voices);
  play_.emplace(GST_AUDIO_INFO_RATE(&info), std::move(voices),
                tactor::PlannerSettings{ .max_lead = parts_.motors.max_lead(),
                                         .volts_max = settings.volts_max,
                                         .volts_min = 0 },
                parts_.motors.of_channels(channels));
  info_ = info;
  play_->set_soft_start(settings.ramp_in);
  if (parts_.trace)
    play_->set_listener([this](const tactor::Command &command, Time at) {
      parts_.trace->write({ .command = command, .issued = at });
    });
  if (now)
    play_->begin(*now);
}

GstFlowReturn
SynthOutput::negotiate(const SynthSettings &settings, guint rows, guint columns)
{
  const bool new_grid = rows != rows_ || columns != columns_;
  if (!gst_pad_check_reconfigure(pad_) && play_ && !new_grid)
    return GST_FLOW_OK;
  const std::optional<GstAudioInfo> info
      = synth_negotiate(pad_, wanted_channels(settings, rows, columns));
  if (!info) {
    gst_pad_mark_reconfigure(pad_);
    if (GST_PAD_IS_FLUSHING(pad_))
      return GST_FLOW_FLUSHING;
    GST_ERROR_OBJECT(element_,
                     "downstream takes no sound of 1 to %d channels in " GST_AUDIO_NE(
                         F32) "; is there an audioconvert?",
                     SynthSettings::kMostChannels);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  const bool new_format = !info_ || !gst_audio_info_is_equal(&*info, &*info_);
  if (new_format) {
    g_autoptr(GstCaps) caps = gst_audio_info_to_caps(&*info);
    GST_DEBUG_OBJECT(element_, "caps %" GST_PTR_FORMAT, caps);
    if (!gst_pad_push_event(pad_, gst_event_new_caps(caps)))
      return GST_PAD_IS_FLUSHING(pad_) ? GST_FLOW_FLUSHING : GST_FLOW_NOT_NEGOTIATED;
    start_play(*info, settings);
  }
  rows_ = rows;
  columns_ = columns;
  if (new_format || new_grid)
    set_cells(settings);
  return GST_FLOW_OK;
}

/* ---- samples ---- */

/// Sends a segment whose timestamps are running times.
void
SynthOutput::send_segment()
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.applied_rate = segment_.rate * segment_.applied_rate;
  segment.start = segment.base = segment.position = to_clock_time(play_->now());
  segment.time = stream_time(segment_, play_->now());
  segment.duration = segment_.duration;
  if (segment.applied_rate < 0) {
    // GStreamer counts back to `time` from `stop`, beyond which the last ramp goes.
    const guint64 end = gst_segment_to_running_time(&segment_, GST_FORMAT_TIME, segment_.start);
    segment.stop = end == GST_CLOCK_TIME_NONE ? end : end + to_clock_time(Play::kRamp);
    segment.time = segment_.time;
  }
  GstEvent *event = gst_event_new_segment(&segment);
  if (seqnum_ != GST_SEQNUM_INVALID)
    gst_event_set_seqnum(event, seqnum_);
  gst_pad_push_event(pad_, event);
  segment_sent_ = true;
}

/// Renders and pushes a buffer of `count` samples of each channel.
GstFlowReturn
SynthOutput::push_samples(std::int64_t count)
{
  const Time begin = play_->now();
  play_->set_mute(is_silent_());
  const gsize size = static_cast<gsize>(count) * static_cast<gsize>(info_->bpf);
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  const bool sounds = play_->render({ reinterpret_cast<float *>(map.data), size / sizeof(float) });
  gst_buffer_unmap(buffer, &map);
  GST_BUFFER_PTS(buffer) = to_clock_time(begin);
  GST_BUFFER_DURATION(buffer) = to_clock_time(play_->now() - begin);
  if (!sounds)
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP);
  if (std::exchange(resync_, false)) {
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_RESYNC);
  }
  return gst_pad_push(pad_, buffer);
}

GstFlowReturn
SynthOutput::push_until(Time until)
{
  GstFlowReturn flow = GST_FLOW_OK;
  while (flow == GST_FLOW_OK) {
    const std::int64_t count = play_->count_until(until);
    if (count == 0)
      break;
    if (!segment_sent_)
      send_segment();
    const gint rate = GST_AUDIO_INFO_RATE(&*info_);
    if (count > std::int64_t{ kLongestSilence } * rate && play_->is_idle()) {
      const Time begin = play_->now();
      play_->skip(count);
      gst_pad_push_event(
          pad_, gst_event_new_gap(to_clock_time(begin), to_clock_time(play_->now() - begin)));
      resync_ = true;
      break;
    }
    flow = push_samples(std::min<std::int64_t>(count, rate / kBuffersPerSecond));
  }
  return flow;
}
