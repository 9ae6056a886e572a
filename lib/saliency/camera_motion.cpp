// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/camera_motion.h"

#include "saliency/pyramid.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

// Of a key frame: in frames at 30 fps, and how far the picture may have moved since, in samples.
constexpr double kOldestKey = 8;
constexpr double kFarthestKey = 2;

/// Smallest motion that counts, in samples at the corner of the picture where it is largest.
constexpr double kSmallestMotion = 0.2;
/// Largest motion since the key frame, as a share of the picture: beyond, there is too little to go by.
constexpr double kLargestMotion = 0.35;

/// Points: one in each cell of so many samples' side, finest level first, if its gradient (L* per
/// sample) reaches this.
constexpr std::array<int, 3> kCell{ 4, 2, 1 };
constexpr float kTexture = 1.0F;

// The parts of the picture that are asked whether they have moved: so many along each side; they have
// an opinion if this share of their cells, and so many of them, have points and would have moved by so
// many samples. Enough are this many, and this share of them has to agree: that the motion leaves this
// share of the difference. So a picture of a few dozen samples has no camera: a thing in it is soon
// most of it.
constexpr int kParts = 4;
constexpr double kTexturedShare = 0.15;
constexpr int kFewestPoints = 3;
constexpr double kSmallestPartMotion = 0.15;
constexpr int kEnoughParts = 5;
constexpr int kEnoughSides = 3; ///< of the picture: a large object that moves does not reach these
constexpr double kAgreeing = 0.8;
constexpr double kExplained = 0.7;

constexpr int kMostSteps = 6;
constexpr double kConverged = 0.02; ///< samples

/// Gains are of lightness about the middle of its scale.
float
exposed(float lightness)
{
  return (lightness - 50) / 50;
}

/// Whether a position lies between samples of the image.
bool
inside(const cv::Mat &image, double x, double y)
{
  return x >= 0 && y >= 0 && x < image.cols - 1 && y < image.rows - 1;
}

/// Linear interpolation at a position inside.
float
sample(const cv::Mat &image, double x, double y)
{
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const auto right_share = static_cast<float>(x - left);
  const auto bottom_share = static_cast<float>(y - top);
  const auto *upper = image.ptr<float>(top) + left;
  const auto *lower = image.ptr<float>(top + 1) + left;
  const float above = upper[0] + right_share * (upper[1] - upper[0]);
  const float below = lower[0] + right_share * (lower[1] - lower[0]);
  return above + bottom_share * (below - above);
}

/// The largest distance by which the motion carries a corner of the picture.
double
farthest(const Similarity &motion, cv::Size size)
{
  double distance = 0;
  for (const double x : { 0.0, size.width - 1.0 })
    for (const double y : { 0.0, size.height - 1.0 })
      distance = std::max(distance, std::hypot(motion.x(x, y) - x, motion.y(x, y) - y));
  return distance;
}

} // namespace

const Similarity &
CameraMotion::follow(const cv::Mat &lab, double elapsed)
{
  cv::extractChannel(lab, now_[0], 0);
  for (std::size_t i = 1; i < kLevels; ++i)
    reduce(now_[i - 1], now_[i]);

  if (lab.size() != size_) {
    pose_ = {};
    moved_ = false;
    set_key();
    return pose_;
  }

  age_ += elapsed;
  exposure_ = {};
  for (std::size_t level = kLevels; level-- > 0;)
    register_level(level);
  const double distance = farthest(motion_, size_);
  moved_ = distance > kSmallestMotion
           && distance < kLargestMotion * std::max(size_.width, size_.height) && explained();
  if (moved_)
    pose_ = key_pose_ * motion_.inverse();
  else
    motion_ = {};
  if (age_ >= kOldestKey || (moved_ && distance > kFarthestKey))
    set_key();
  return pose_;
}

void
CameraMotion::reset()
{
  size_ = {};
}

void
CameraMotion::rebase()
{
  key_pose_ = pose_.inverse() * key_pose_;
  pose_ = {};
}

/// Makes the current frame the key frame.
void
CameraMotion::set_key()
{
  size_ = now_[0].size();
  key_pose_ = pose_;
  motion_ = {};
  age_ = 0;
  for (std::size_t level = 0; level < kLevels; ++level) {
    const cv::Mat &image = now_[level];
    auto &points = points_[level];
    points.clear();
    const int cell = kCell[level];
    const float unit = 2.0F / static_cast<float>(image.cols); // conditions the equations
    for (int top = 1; top < image.rows - 1; top += cell)
      for (int left = 1; left < image.cols - 1; left += cell) {
        float best = kTexture * kTexture;
        Point point{};
        for (int y = top; y < std::min(top + cell, image.rows - 1); ++y)
          for (int x = left; x < std::min(left + cell, image.cols - 1); ++x) {
            const auto *row = image.ptr<float>(y);
            const float dx = (row[x + 1] - row[x - 1]) / 2;
            const float dy = (image.ptr<float>(y + 1)[x] - image.ptr<float>(y - 1)[x]) / 2;
            if (dx * dx + dy * dy < best)
              continue;
            best = dx * dx + dy * dy;
            const float px = (static_cast<float>(x) - static_cast<float>(image.cols) / 2) * unit;
            const float py = (static_cast<float>(y) - static_cast<float>(image.rows) / 2) * unit;
            point = { static_cast<float>(x),
                      static_cast<float>(y),
                      row[x],
                      { dx * px + dy * py, dy * px - dx * py, dx, dy, exposed(row[x]), 1 } };
          }
        if (point.change[5] > 0)
          points.push_back(point);
      }
  }
}

/// Improves `motion_` and `exposure_` on one level.
void
CameraMotion::register_level(std::size_t level)
{
  const cv::Mat &image = now_[level];
  const auto &points = points_[level];
  const double unit = std::ldexp(1.0, static_cast<int>(level)); // in samples of the finest level
  Similarity motion = motion_.in_units_of(unit);

  double scale = 20; // L*: beyond it a point counts less and less
  for (int step = 0; step < kMostSteps; ++step) {
    cv::Matx<double, 6, 6> normal = cv::Matx<double, 6, 6>::eye();
    cv::Vec<double, 6> right = cv::Vec<double, 6>::all(0);
    residuals_.clear();
    for (const Point &point : points) {
      const double x = motion.x(point.x, point.y);
      const double y = motion.y(point.x, point.y);
      if (!inside(image, x, y))
        continue;
      const double residual
          = sample(image, x, y) - point.lightness - exposure_[0] * point.change[4] - exposure_[1];
      residuals_.push_back(static_cast<float>(std::abs(residual)));
      const double closeness = 1 / (1 + residual * residual / (scale * scale));
      const double weight = closeness * closeness; // Geman & McClure
      for (int m = 0; m < 6; ++m) {
        const double weighted
            = weight * static_cast<double>(point.change[static_cast<std::size_t>(m)]);
        for (int n = m; n < 6; ++n)
          normal(m, n) += weighted * static_cast<double>(point.change[static_cast<std::size_t>(n)]);
        right[m] += weighted * residual;
      }
    }
    if (residuals_.size() < 12)
      break;
    // What little is presumed about exposure is that there is none, not that this step finds none.
    right[4] -= exposure_[0];
    right[5] -= exposure_[1];
    for (int m = 0; m < 6; ++m)
      for (int n = 0; n < m; ++n)
        normal(m, n) = normal(n, m);
    cv::Vec<double, 6> by;
    if (!cv::solve(normal, right, by, cv::DECOMP_CHOLESKY))
      break;

    // About the middle of the picture, and in its half width, to samples from the origin.
    const double middle_x = image.cols / 2.0;
    const double middle_y = image.rows / 2.0;
    const double scaled = by[0] * 2 / image.cols;
    const double turned = by[1] * 2 / image.cols;
    const Similarity small{ 1 + scaled, turned, by[2] - scaled * middle_x + turned * middle_y,
                            by[3] - turned * middle_x - scaled * middle_y };
    motion = motion * small.inverse();
    exposure_[0] += by[4];
    exposure_[1] += by[5];
    if (std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]) + std::abs(by[3]) < kConverged)
      break;

    const auto median = residuals_.begin() + static_cast<std::ptrdiff_t>(residuals_.size() / 2);
    std::nth_element(residuals_.begin(), median, residuals_.end());
    scale = std::max(0.5, 4.5 * static_cast<double>(*median)); // 3 σ
  }
  motion_ = motion.in_units_of(1 / unit);
}

/// The exposure that explains most if nothing has moved, weighted as in register_level(): what goes its
/// own way says nothing of the light.
std::array<double, 2>
CameraMotion::exposure_at_rest()
{
  cv::Vec2d exposure(0, 0);
  double scale = 20;
  for (int step = 0; step < kMostSteps; ++step) {
    cv::Matx22d normal = cv::Matx22d::eye();
    cv::Vec2d right(0, 0);
    residuals_.clear();
    for (const Point &point : points_[0]) {
      const cv::Vec2d change(point.change[4], point.change[5]);
      const double difference = sample(now_[0], point.x, point.y) - point.lightness;
      const double residual = difference - exposure.dot(change);
      residuals_.push_back(static_cast<float>(std::abs(residual)));
      const double closeness = 1 / (1 + residual * residual / (scale * scale));
      normal += closeness * closeness * change * change.t();
      right += closeness * closeness * difference * change;
    }
    if (residuals_.empty())
      break;
    exposure = normal.solve(right, cv::DECOMP_CHOLESKY);
    const auto median = residuals_.begin() + static_cast<std::ptrdiff_t>(residuals_.size() / 2);
    std::nth_element(residuals_.begin(), median, residuals_.end());
    scale = std::max(0.5, 4.5 * static_cast<double>(*median));
  }
  return { exposure[0], exposure[1] };
}

/// Whether most parts of the picture that would show the motion do.
bool
CameraMotion::explained()
{
  struct Part
  {
    int points = 0;
    double motion = 0;
    double with = 0;     ///< difference that the motion leaves
    double without = 0;  ///< that there is
    double opposite = 0; ///< that the opposite motion leaves
  };
  const auto [rest_gain, rest_offset] = exposure_at_rest();
  std::array<Part, static_cast<std::size_t>(kParts) * kParts> parts{};
  for (const Point &point : points_[0]) {
    const double x = motion_.x(point.x, point.y);
    const double y = motion_.y(point.x, point.y);
    if (!inside(now_[0], x, y))
      continue;
    const auto column
        = static_cast<std::size_t>(point.x * kParts / static_cast<float>(size_.width));
    const auto row = static_cast<std::size_t>(point.y * kParts / static_cast<float>(size_.height));
    Part &part = parts[row * kParts + column];
    const double expected = point.lightness + exposure_[0] * point.change[4] + exposure_[1];
    part.points++;
    part.motion += std::hypot(x - point.x, y - point.y);
    part.with += std::abs(sample(now_[0], x, y) - expected);
    const double at_rest = point.lightness + rest_gain * point.change[4] + rest_offset;
    const double without = std::abs(sample(now_[0], point.x, point.y) - at_rest);
    part.without += without;
    const double opposite_x = 2 * point.x - x;
    const double opposite_y = 2 * point.y - y;
    part.opposite += inside(now_[0], opposite_x, opposite_y)
                         ? std::abs(sample(now_[0], opposite_x, opposite_y) - at_rest)
                         : without;
  }

  const double cells = static_cast<double>(size_.area()) / (kCell[0] * kCell[0] * kParts * kParts);
  int asked = 0;
  int agreeing = 0;
  std::array<bool, 4> sides{}; // of the picture, where a part agrees
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part &part = parts[i];
    if (part.points < kFewestPoints || part.points < kTexturedShare * cells
        || part.motion < kSmallestPartMotion * part.points)
      continue;
    ++asked;
    // Between samples noise is averaged, whichever way one goes.
    if (part.with >= kExplained * std::min(part.without, part.opposite))
      continue;
    ++agreeing;
    const std::size_t row = i / kParts;
    const std::size_t column = i % kParts;
    sides[0] |= row == 0;
    sides[1] |= row == kParts - 1;
    sides[2] |= column == 0;
    sides[3] |= column == kParts - 1;
  }
  return asked >= kEnoughParts && agreeing >= kAgreeing * asked
         && std::ranges::count(sides, true) >= kEnoughSides;
}

} // namespace saliency
