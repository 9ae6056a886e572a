// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/recording.h"

#include <gst/gst.h>

#include <mutex>
#include <string>

/// The end of a launch line, `… ! appsink name=heard`, for an AudioCollector.
std::string recording_branch();

/// Collects the samples of an appsink. listen() before the pipeline starts; all else on any thread.
class AudioCollector
{
public:
  void listen(GstElement *appsink);
  /// Running time of the last sample's end.
  tactor::Time until();
  /// The samples, beginning with the running time of the first. Throws std::runtime_error if there
  /// are none or add() failed.
  tactor::Recording take();

  /// False after more than Recording::kMostValues samples, or one that is not finite.
  bool add(GstSample *sample);

private:
  std::mutex mutex_;
  tactor::Recording recording_;
  std::string fault_; ///< why add() failed
};

/// Pushes a recording into an appsrc, then end of stream.
void push_recording(GstElement *appsrc, const tactor::Recording &recording);

/// Reads any sound file that GStreamer can decode, or a CSV file. Throws std::runtime_error, also
/// if the decoder makes no progress within `patience`.
tactor::Recording read_recording(const std::string &path, GstClockTime patience = 5 * GST_SECOND);

/// Writes a WAV file of 32-bit floats that begins at running time 0. Throws std::runtime_error.
void write_recording(const tactor::Recording &recording, const std::string &path);
