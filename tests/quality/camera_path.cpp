// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quality {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

} // namespace

Tremor::Tremor(Random &random, double lowest, double highest)
{
  double power = 0;
  for (auto &wave : waves_) {
    wave = { random.normal(), kTau * random.uniform(lowest, highest), random.uniform(0, kTau) };
    power += wave.amplitude * wave.amplitude / 2;
  }
  for (auto &wave : waves_)
    wave.amplitude /= std::sqrt(power);
}

double
Tremor::at(double seconds) const
{
  double sum = 0;
  for (const auto &wave : waves_)
    sum += wave.amplitude * std::sin(wave.frequency * seconds + wave.phase);
  return sum;
}

cv::Point2d
project(const Pose &pose, double x, double y, double z, cv::Size size)
{
  const double distance = z - pose.z;
  const double right = (x - pose.x) / distance - pose.yaw;
  const double down = (y - pose.y) / distance - pose.pitch;
  const double cosine = std::cos(pose.roll) * size.width;
  const double sine = std::sin(pose.roll) * size.width;
  return { size.width / 2.0 + cosine * right + sine * down,
           size.height / 2.0 + cosine * down - sine * right };
}

cv::Point2d
seen_at(const Pose &pose, cv::Point2d pixel, double z, cv::Size size)
{
  const double distance = (z - pose.z) / size.width;
  const double right = pixel.x - size.width / 2.0;
  const double down = pixel.y - size.height / 2.0;
  return { pose.x + distance * (std::cos(pose.roll) * right - std::sin(pose.roll) * down)
               + pose.yaw * (z - pose.z),
           pose.y + distance * (std::sin(pose.roll) * right + std::cos(pose.roll) * down)
               + pose.pitch * (z - pose.z) };
}

CameraPath::CameraPath(Travel travel, std::uint64_t seed)
    : random_(seed * 7919 + static_cast<std::uint64_t>(travel)), travel_(travel),
      rests_(seed % 2 == 0), direction_(random_.uniform(-1, 1) < 0 ? -1 : 1),
      speed_(travel == Travel::truck   ? random_.uniform(0.5, 1.2)
             : travel == Travel::dolly ? random_.uniform(0.5, 1)
                                       : random_.uniform(0.9, 1.3)),
      period_(random_.uniform(7, 10)), steps_(random_.uniform(1.7, 2.1)),
      phase_(random_.uniform(0, kTau)), tremors_{ Tremor(random_, 0.5, 4), Tremor(random_, 0.5, 4),
                                                  Tremor(random_, 0.5, 4) }
{
}

Pose
CameraPath::at(double seconds) const
{
  Pose pose;
  const double step = kTau * steps_ * seconds + phase_;
  const double swing = std::sin(kTau * seconds / period_ + phase_);
  switch (travel_) {
  case Travel::truck:
    pose.x = direction_ * speed_ * traveled(seconds);
    break;
  case Travel::dolly:
    pose.z = speed_ * traveled(seconds);
    break;
  case Travel::walk:
    pose.z = speed_ * traveled(seconds);
    pose.x = 0.03 * std::sin(step / 2); // a step of either foot
    pose.y = 0.03 * std::sin(step);
    pose.yaw = 0.006 * tremors_[0].at(seconds);
    pose.pitch = 0.005 * tremors_[1].at(seconds);
    pose.roll = 0.004 * tremors_[2].at(seconds);
    break;
  case Travel::pan:
    pose.yaw = 0.35 * swing;
    pose.x = direction_ * swing;
    break;
  }
  return pose;
}

/// Seconds at full speed. It is reached within 0.8 s.
double
CameraPath::traveled(double seconds) const
{
  constexpr double kRest = 1;
  constexpr double kRamp = 0.8;
  if (!rests_)
    return seconds;
  const double since = std::max(0.0, seconds - kRest);
  return since < kRamp ? since * since / (2 * kRamp) : since - kRamp / 2;
}

} // namespace quality
