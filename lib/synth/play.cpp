// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/play.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace synth {

Play::Play(int rate, std::vector<Voice> voices, const tactor::PlannerSettings &settings,
           const std::vector<tactor::MotorParameters> &motors)
    : voices_(std::move(voices)), planner_(static_cast<int>(voices_.size()), settings, motors),
      queue_(static_cast<int>(voices_.size())), synthesizer_(rate, {}, 1), grid_{ .rate = rate },
      pooled_(voices_.size()), played_(voices_.size())
{
  synthesizer_ = make_synthesizer();
  for (const tactor::MotorParameters &motor : motors)
    slowest_ = std::max(slowest_, motor.latency.value_or(Time(0)));
}

Synthesizer
Play::make_synthesizer() const
{
  const auto ramp = SampleGrid{ .rate = grid_.rate }.index_of(kRamp);
  return { grid_.rate, voices_, static_cast<int>(std::max<std::int64_t>(ramp, 1)) };
}

Time
Play::lead() const
{
  return planner_.settings().max_lead + slowest_ + kRamp / 2;
}

void
Play::set_cells(ChannelCells cells)
{
  cells_ = std::move(cells);
}

void
Play::set_listener(std::function<void(const tactor::Command &command, Time at)> listener)
{
  listener_ = std::move(listener);
}

void
Play::set_intensity(double intensity)
{
  if (tactor::PlannerSettings settings = planner_.settings(); settings.intensity != intensity) {
    settings.intensity = intensity;
    planner_.set_settings(settings);
  }
}

void
Play::set_limits(const tactor::MotorLimits &limits, double rate)
{
  tactor::PlannerSettings settings = planner_.settings();
  if (settings.limits == limits && settings.rate == rate)
    return;
  settings.limits = limits;
  settings.rate = rate;
  planner_.set_settings(settings);
}

void
Play::set_mute(bool mute)
{
  if (std::exchange(mute_, mute) == mute)
    return;
  if (!mute)
    synthesizer_.arm(grid_.rate * soft_start_ / Time(std::chrono::seconds(1)));
  for (std::size_t i = 0; i < voices_.size(); i++)
    // A channel that has begun early keeps the pitch of its map.
    change({ .effect = played_[i], .tactor = static_cast<int>(i), .volts = queue_.levels()[i] });
}

void
Play::set_soft_start(Time length)
{
  soft_start_ = length;
}

void
Play::begin(Time time)
{
  grid_.origin = time;
  position_ = 0;
  has_begun_ = true;
  synthesizer_ = make_synthesizer();
  pitch_ = 0;
  std::ranges::fill(played_, Time::min());
  synthesizer_.arm(grid_.rate * soft_start_ / Time(std::chrono::seconds(1)));
}

bool
Play::has_begun() const
{
  return has_begun_;
}

void
Play::plan(Time time, Time duration, std::span<const float> levels, double frequency)
{
  const double before = pitches_.empty() ? pitch_ : pitches_.back().frequency;
  const bool is_felt = std::ranges::any_of(levels, [](float level) { return level > 0; });
  if (frequency != before && is_felt)
    pitches_.push_back({ .time = time, .frequency = frequency });
  pool(cells_, levels, pooled_);
  queue_.push(planner_.plan(time, duration, pooled_));
}

void
Play::silence(Time time)
{
  queue_.push(planner_.silence(time));
}

void
Play::flush(bool resets_time)
{
  queue_.clear();
  pitches_.clear();
  if (resets_time)
    planner_.reset(now());
  else
    planner_.silenced(now());
  has_begun_ = false;
}

Time
Play::now() const
{
  return grid_.time_of(position_);
}

std::int64_t
Play::count_until(Time time) const
{
  return std::max<std::int64_t>(grid_.index_of(time) - position_, 0);
}

Time
Play::time_after(std::int64_t count) const
{
  return grid_.time_of(position_ + count);
}

/// The sample with which the ramp of the next change begins.
std::optional<std::int64_t>
Play::next_change() const
{
  const std::optional<Time> due = queue_.next_due();
  if (!due)
    return std::nullopt;
  return grid_.index_of(*due) - synthesizer_.ramp() / 2;
}

void
Play::change(const tactor::Command &command)
{
  const double amplitude = mute_ ? 0 : command.volts / planner_.settings().volts_max;
  const auto channel = static_cast<std::size_t>(command.tactor);
  played_[channel] = command.effect;
  if (amplitude > 0)
    synthesizer_.tune(channel, pitch_at(command.effect));
  synthesizer_.change(channel, static_cast<float>(amplitude));
}

/// The frequency of the map at `time`: a channel has it from its command for the map on.
double
Play::pitch_at(Time time) const
{
  double pitch = pitch_;
  for (const Pitch &next : pitches_)
    if (next.time <= time)
      pitch = next.frequency;
  return pitch;
}

/// The first of the pitches comes due. A channel that has begun early for a later map keeps that of
/// the later one.
void
Play::take_pitch()
{
  const Pitch due = pitches_.front();
  pitches_.pop_front();
  pitch_ = due.frequency;
  for (std::size_t i = 0; i < played_.size(); i++)
    if (played_[i] <= due.time)
      synthesizer_.tune(i, pitch_);
}

bool
Play::render(std::span<float> samples)
{
  const std::size_t channels = voices_.size();
  bool sounds = false;
  while (!samples.empty()) {
    auto count = static_cast<std::int64_t>(samples.size() / channels);
    if (!pitches_.empty()) {
      const std::int64_t next = grid_.index_of(pitches_.front().time);
      if (next <= position_) {
        take_pitch();
        continue;
      }
      count = std::min(count, next - position_);
    }
    if (const std::optional<std::int64_t> next = next_change()) {
      if (*next <= position_) {
        for (const tactor::Command &command : queue_.take_due(*queue_.next_due())) {
          change(command);
          if (listener_)
            listener_(command, time_after(synthesizer_.ramp() / 2));
        }
        continue;
      }
      count = std::min(count, *next - position_);
    }
    sounds = sounds || !synthesizer_.is_silent();
    synthesizer_.render(samples.first(static_cast<std::size_t>(count) * channels));
    samples = samples.subspan(static_cast<std::size_t>(count) * channels);
    position_ += count;
  }
  return sounds;
}

bool
Play::is_idle() const
{
  return synthesizer_.is_silent() && !queue_.next_due();
}

void
Play::skip(std::int64_t count)
{
  synthesizer_.skip(count);
  position_ += count;
  while (!pitches_.empty() && grid_.index_of(pitches_.front().time) <= position_)
    take_pitch();
}

} // namespace synth
