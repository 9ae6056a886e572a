// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes files about motors. CALIBRATION_FILE: a calibration that parses is usable and survives a
// round trip. Otherwise a recording as CSV: if it parses, its samples are evenly spaced and finite,
// and a step in it is measured or refused. Other input is refused with a reason.
#include "fuzz.h"

#ifdef CALIBRATION_FILE
#include "calibration/calibration.h"
#else
#include "calibration/recording.h"
#include "calibration/step_response.h"
#endif

#include <algorithm>
#include <cmath>

using namespace tactor;

namespace {

#ifdef CALIBRATION_FILE
void
check(const std::string &path)
{
  const auto read = read_calibration(path);
  if (!read)
    return expect(!read.error().empty());
  const Calibration &calibration = *read;
  expect(!calibration.tactors.empty());
  expect(calibration.longest_lead() >= Time(0));
  for (const MotorParameters &motor : calibration.motors(3.0)) {
    expect(motor.hold_volts <= motor.start_volts);
    expect(motor.rise_time(0, 3.0) >= Time(0));
    expect(std::ranges::is_sorted(motor.level_volts));
    expect(motor.level_volts.empty()
           || (motor.level_volts.front() >= 0 && motor.level_volts.back() <= 3.0));
  }
  // In memory, because writing to disk is slow.
  const std::string name = "/dev/shm/calibration-fuzz-" + std::to_string(getpid());
  write_calibration(calibration, name);
  const Calibration again = *read_calibration(name);
  unlink(name.c_str());
  expect(again.motor == calibration.motor && again.tactors.size() == calibration.tactors.size());
  for (const auto &[index, tactor] : calibration.tactors) // written with six digits
    expect(std::abs(again.tactors.at(index).gain_db - tactor.gain_db) < 1e-3
           && again.tactors.at(index).equalizer.size() == tactor.equalizer.size());
}
#else
void
check(const std::string &path)
{
  const auto read = read_csv_recording(path);
  if (!read)
    return expect(!read.error().empty());
  const Recording &recording = *read;
  expect(recording.size() >= 2 && recording.rate > 0);
  for (const std::vector<double> &channel : recording.channels)
    expect(channel.size() == recording.size()
           && std::ranges::all_of(channel, [](double value) { return std::isfinite(value); }));
  if (recording.size() > 2000)
    return;
  const Time length(std::llround(1e9 * static_cast<double>(recording.size()) / recording.rate));
  const Time at = recording.start + length / 3;
  const Step step{ .target_volts = 1,
                   .rest_begin = recording.start,
                   .rest_end = at,
                   .at = at,
                   .effect = at,
                   .end = at + length / 3,
                   .off = at + length / 3,
                   .next = recording.start + length };
  const StepResponse response = measure_step(recording, 0, step, { 20, 0.4 * recording.rate });
  expect(response.fault != StepFault::none || std::isfinite(response.risen_ms));
}
#endif

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  check(memory_file(data, size));
  return 0;
}
