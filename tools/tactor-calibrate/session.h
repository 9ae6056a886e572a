// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/measurement_plan.h"
#include "calibration/step_response.h"

#include "player.h"

#include <filesystem>
#include <string>
#include <vector>

/// A measurement in a folder: session.ini has its settings, run-NNN.csv the commands of a run and
/// run-NNN.wav the recording (or any other sound file, or a CSV run-NNN.recording.csv).
class Session
{
public:
  /// Begins a session, or continues the one in the folder. Throws std::runtime_error if that has
  /// other settings.
  static Session begin(const std::filesystem::path &folder,
                       const tactor::MeasurementSettings &settings, const std::string &motor,
                       const std::string &sensor);
  /// The session in a folder. Throws std::runtime_error if there is none.
  static Session open(const std::filesystem::path &folder);

  int runs() const;
  /// Whether a run was played and, if `recorded`, also recorded.
  bool is_done(int run, bool recorded) const;
  tactor::Time length(int run) const;
  std::vector<Frame> frames(int run) const;
  /// Writes a run's files. The recording may be empty.
  void keep(int run, const Played &played) const;

  struct Heard
  {
    std::vector<tactor::RecordedRun> runs{};
    tactor::Band band{};
    std::vector<tactor::StepResponse> responses{};
    bool one_clock = true; ///< recordings and traces are on one clock, without alignment
  };
  /// Measures all recordings. `band` with a high edge of 0: detected. With `find` each is aligned
  /// by correlation, as are those of other devices anyway. Throws std::runtime_error if there are
  /// none.
  Heard measure(tactor::Band band, bool find = false) const;

  const std::string &motor() const;
  const std::string &sensor() const;
  const tactor::MeasurementSettings &settings() const;

private:
  std::filesystem::path file(int run, const char *ending) const;
  std::filesystem::path recording_of(int run) const;
  int tactors() const;

  std::filesystem::path folder_;
  tactor::MeasurementSettings settings_;
  std::string motor_;
  std::string sensor_;
  std::vector<tactor::MeasurementRun> plan_;
};

/// Measures one recording with its trace, aligned by correlation if `find` is true.
Session::Heard measure_recording(tactor::Recording recording,
                                 const std::vector<tactor::IssuedCommand> &trace, int tactors,
                                 tactor::Band band, bool find);
