// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/recording.h"

#include <gst/gst.h>

#include <mutex>
#include <string>

/// The end of a launch line that hands sound to an AudioCollector: `… ! appsink name=heard`.
std::string recording_branch();

/// Gathers what an appsink gets. listen() before the pipeline starts; the others from any thread.
class AudioCollector
{
public:
  void listen(GstElement *appsink);
  /// Running time of the end of what came so far.
  tactor::Time until();
  /// What came, from the running time of its first sample. Throws std::runtime_error if nothing
  /// did, or add() took no more.
  tactor::Recording take();

  /// False once it is more than Recording::kMostValues, or what is no finite number.
  bool add(GstSample *sample);

private:
  std::mutex mutex_;
  tactor::Recording recording_;
  std::string fault_; ///< why no more is taken
};

/// Hands a recording to an appsrc, then the end of stream.
void push_recording(GstElement *appsrc, const tactor::Recording &recording);

/// Reads any sound file that GStreamer can decode, or a CSV file. Throws std::runtime_error with
/// the file and the reason, one of which is that nothing comes for as long as `patience`.
tactor::Recording read_recording(const std::string &path, GstClockTime patience = 5 * GST_SECOND);

/// Writes a WAV file of 32-bit floats that begins at running time 0. Throws std::runtime_error with
/// the file and the reason.
void write_recording(const tactor::Recording &recording, const std::string &path);
