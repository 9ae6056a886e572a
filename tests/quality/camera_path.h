// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "random.h"

#include <opencv2/core/types.hpp>

#include <array>
#include <cstdint>

namespace quality {

/// A signal of mean 0 and variance 1 between two frequencies in Hz.
class Tremor
{
public:
  Tremor(Random &random, double lowest, double highest);

  double at(double seconds) const;

private:
  struct Wave
  {
    double amplitude;
    double frequency; ///< radians per second
    double phase;
  };
  std::array<Wave, 6> waves_{};
};

/// How a camera travels.
enum class Travel
{
  truck, ///< sideways, 0.5–1.2 m/s
  dolly, ///< forward, 0.5–1 m/s
  walk,  ///< forward, 0.9–1.3 m/s, hand-held: steps, sway and tremor
  pan,   ///< to and fro, up to 20° and 1 m
};

/// Where a camera is, in meters (y down, z forward), and where it looks: yaw and pitch as shifts in
/// widths of the picture, roll in radians. Its field of view is 53°: at 1 m it sees 1 m.
struct Pose
{
  double x = 0;
  double y = 0;
  double z = 0;
  double yaw = 0;
  double pitch = 0;
  double roll = 0;
};

/// Where a point is seen, in pixels of a picture of that size. Requires z > pose.z.
cv::Point2d project(const Pose &pose, double x, double y, double z, cv::Size size);

/// The inverse of project().
cv::Point2d seen_at(const Pose &pose, cv::Point2d pixel, double z, cv::Size size);

/// A camera's way from the origin. With an even seed it rests for 1 s, except in a pan.
class CameraPath
{
public:
  CameraPath(Travel travel, std::uint64_t seed);

  Pose at(double seconds) const;

private:
  double traveled(double seconds) const;

  Random random_;
  Travel travel_;
  bool rests_; ///< at first
  double direction_;
  double speed_;  ///< m/s
  double period_; ///< of a pan, s
  double steps_;  ///< per second
  double phase_;
  std::array<Tremor, 3> tremors_;
};

} // namespace quality
