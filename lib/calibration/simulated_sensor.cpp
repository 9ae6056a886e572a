// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/simulated_sensor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace tactor {

namespace {

constexpr double kRisen = 0.9;
constexpr Time kSettled = std::chrono::hours(1);

/// The argument at which a rising function reaches `value` < 1.
double
inverse(const std::function<double(double)> &rising, double value)
{
  double low = 0;
  double high = 1;
  while (rising(high) < value && high < 1e9)
    high *= 2;
  for (int i = 0; i < 60; i++) {
    const double middle = (low + high) / 2;
    (rising(middle) < value ? low : high) = middle;
  }
  return high;
}

/// A motor and its pending commands.
struct Player
{
  MotorModel motor;
  std::vector<std::pair<Time, double>> told{}; ///< arrival time at the motor, and volts
  std::size_t next = 0;
  double gain = 1;
  double turns = 0; ///< revolutions of its mass so far
  double from = 0;
  double steady = 0;
  double stretch
      = 1; ///< time scale of SimulatedSensor::growth relative to MotorModel's time constant

  void tell(const std::function<double(double)> &growth)
  {
    const auto &[at, volts] = told[next++];
    from = motor.amplitude(at);
    motor.set(at, volts);
    steady = motor.amplitude(at + kSettled);
    const double left = (1 - kRisen) * steady / (steady - from);
    if (growth && from < kRisen * steady)
      stretch = inverse(growth, 1 - left) / -std::log(left);
  }

  double amplitude(Time now, const std::function<double(double)> &growth) const
  {
    const double exponential = motor.amplitude(now);
    if (!growth || !(from < kRisen * steady))
      return exponential;
    const double left = std::max((steady - exponential) / (steady - from), 1e-12);
    return std::lerp(from, steady, growth(-std::log(left) * stretch));
  }
};

} // namespace

Recording
hear(std::span<const IssuedCommand> trace, std::span<const MotorParameters> motors,
     const SimulatedSensor &sensor, Time end)
{
  std::mt19937 random(sensor.seed);
  std::uniform_real_distribution<double> late(0, static_cast<double>(sensor.jitter.count()));
  std::map<int, Player> players;
  for (const IssuedCommand &issued : trace) {
    const int tactor = issued.command.tactor;
    const auto index = static_cast<std::size_t>(tactor);
    if (!players.contains(tactor)) {
      Player player{ .motor
                     = MotorModel(index < motors.size() ? motors[index] : MotorParameters{}) };
      player.gain = sensor.gain * (index < sensor.gains.size() ? sensor.gains[index] : 1);
      players.emplace(tactor, std::move(player));
    }
    Player &player = players.at(tactor);
    const Time latency = player.motor.parameters().latency.value_or(Time(0));
    player.told.emplace_back(issued.issued + latency + Time(std::llround(late(random))),
                             issued.command.volts);
  }

  Recording recording{ .rate = sensor.rate, .full_scale = sensor.clip };
  const int channels = sensor.separate && !players.empty() ? players.rbegin()->first + 1 : 1;
  const auto size = static_cast<std::size_t>(
      std::llround(std::chrono::duration<double>(end).count() * sensor.rate));
  recording.channels.assign(static_cast<std::size_t>(channels), std::vector<double>(size));
  std::normal_distribution<double> noise(0, sensor.noise > 0 ? sensor.noise : 1);
  for (std::size_t i = 0; i < size; i++) {
    const double at = static_cast<double>(i) / sensor.rate;
    const Time now(std::llround(at * 1e9));
    for (auto &[tactor, player] : players) {
      while (player.next < player.told.size() && player.told[player.next].first <= now)
        player.tell(sensor.growth);
      const double volts = player.amplitude(now, sensor.growth);
      player.turns += (sensor.slowest_hz + sensor.hz_per_volt * volts) / sensor.rate;
      recording.channels[sensor.separate ? static_cast<std::size_t>(tactor) : 0][i]
          += player.gain * volts * std::sin(2 * std::numbers::pi * player.turns);
    }
    const double phase = 2 * std::numbers::pi * sensor.hum_hz * at;
    const double common
        = sensor.drift * at + sensor.hum * (std::sin(phase + 0.3) + std::sin(3 * phase) / 3);
    for (std::vector<double> &channel : recording.channels) {
      channel[i] += common + (sensor.noise > 0 ? noise(random) : 0);
      if (sensor.clip > 0)
        channel[i] = std::clamp(channel[i], -sensor.clip, sensor.clip);
    }
  }
  return recording;
}

} // namespace tactor
