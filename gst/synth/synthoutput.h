// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/play.h"
#include "synthparts.h"
#include "synthsettings.h"

#include <gst/audio/audio.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// tactilesynth's sound: its format, and its samples, whose timestamps are running times.
/// Streaming thread, or while it is stopped.
class SynthOutput
{
public:
  /// Pushes to `pad` and posts messages of `element`; both outlive this. `parts` are read before
  /// the first negotiate(). `is_silent` is called before each buffer.
  SynthOutput(GstElement *element, GstPad *pad, SynthParts &parts, std::function<bool()> is_silent);

  /// Agrees on the sound with downstream, where that is due. Then there is a play().
  GstFlowReturn negotiate(const SynthSettings &settings, guint rows, guint columns);

  /// Null before negotiate().
  synth::Play *play();

  /// The input's segment. The output's is sent before the next samples, with this sequence number.
  void set_segment(const GstSegment &segment, guint32 seqnum);
  const GstSegment &segment() const;

  /// The first sample is at `time`.
  void begin(synth::Time time);
  /// Pushes all samples up to a running time.
  GstFlowReturn push_until(synth::Time until);

  /// Drops the planned commands.
  void flush(bool resets_time);
  /// As constructed.
  void reset();

private:
  void start_play(const GstAudioInfo &info, const SynthSettings &settings);
  void tell_limited(const std::vector<synth::Voice> &voices);
  void set_cells(const SynthSettings &settings);
  void send_segment();
  GstFlowReturn push_samples(std::int64_t count);

  GstElement *element_;
  GstPad *pad_;
  SynthParts &parts_;
  const std::function<bool()> is_silent_;
  GstSegment segment_;
  std::optional<GstAudioInfo> info_;
  std::optional<synth::Play> play_; ///< while there is info_
  guint rows_ = 0;                  ///< of the cells of play_
  guint columns_ = 0;
  guint32 seqnum_ = GST_SEQNUM_INVALID; ///< of segment_
  bool segment_sent_ = false;
  bool resync_ = true; ///< the next buffer does not follow the last one
};
