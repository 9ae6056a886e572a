// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "synth/channel_cells.h"
#include "synth/sample_grid.h"
#include "synth/synthesizer.h"
#include "tactor/command_planner.h"
#include "tactor/command_queue.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace synth {

/// Maps in, sound out. All times are running times; maps come in order of time. A channel is a
/// tactor to tactor::CommandPlanner, which moves changes ahead by rise times and keeps the limits.
/// Not thread-safe.
class Play
{
public:
  /// Length of a change of amplitude. Its middle is at the time of the change.
  static constexpr Time kRamp = std::chrono::milliseconds(12);

  /// `motors[i]` is what channel i moves, at PlannerSettings::volts_max for full scale; `settings`
  /// have its max_lead and an empty mapping.
  Play(int rate, std::vector<Voice> voices, const tactor::PlannerSettings &settings,
       const std::vector<tactor::MotorParameters> &motors);

  /// How much earlier than its map a sample may have to change.
  Time lead() const;

  void set_cells(ChannelCells cells);
  /// Called by render() for each command, with the time of the middle of its ramp.
  void set_listener(std::function<void(const tactor::Command &command, Time at)> listener);
  /// From the next map on. max_lead and volts_max stay.
  void set_intensity(double intensity);
  void set_limits(const tactor::MotorLimits &limits, double rate);
  /// Ramps to silence, or back.
  void set_mute(bool mute);
  void set_soft_start(Time length);

  /// The first sample is at `time`.
  void begin(Time time);
  bool has_begun() const;

  /// A map that is shown during [time, time + duration). `frequency` is that of its vibrations in
  /// Hz; 0: those of the carriers.
  void plan(Time time, Time duration, std::span<const float> levels, double frequency = 0);
  /// All channels to zero at `time`.
  void silence(Time time);
  /// Drops the plan; running time restarts or continues. The account of the limits stays. Call
  /// begin() next.
  void flush(bool resets_time);

  /// When the next sample is, and how many of a channel there are until a time.
  Time now() const;
  std::int64_t count_until(Time time) const;
  Time time_after(std::int64_t count) const;

  /// The next samples, interleaved. False if all are zero.
  bool render(std::span<float> samples);
  /// All channels are at zero, and nothing else is planned.
  bool is_idle() const;
  /// As render() of so many samples of each channel, while it is idle.
  void skip(std::int64_t count);

private:
  Synthesizer make_synthesizer() const;
  std::optional<std::int64_t> next_change() const;
  void change(const tactor::Command &command);
  double pitch_at(Time time) const;
  void take_pitch();

  std::vector<Voice> voices_;
  tactor::CommandPlanner planner_;
  tactor::CommandQueue queue_;
  Synthesizer synthesizer_;
  SampleGrid grid_;
  std::int64_t position_ = 0; ///< of the next sample
  bool has_begun_ = false;
  bool mute_ = false;
  Time soft_start_{ 0 };
  Time slowest_{ 0 }; ///< longest measured latency of a motor
  ChannelCells cells_{};
  std::function<void(const tactor::Command &, Time)> listener_{};
  std::vector<float> pooled_; ///< one map's levels

  struct Pitch
  {
    Time time; ///< of the first map that has it
    double frequency;
  };
  std::deque<Pitch> pitches_{}; ///< of maps to come
  double pitch_ = 0;            ///< of the maps before them
  std::vector<Time> played_;    ///< the map of each channel's last command
};

} // namespace synth
