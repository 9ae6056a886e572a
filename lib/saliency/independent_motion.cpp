// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/independent_motion.h"

#include "saliency/quantile.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

constexpr float kTexture = 1;            ///< smallest gradient of a point, L* per sample
constexpr int kCell = 2;                 ///< a node has one point in each cell of this side
constexpr std::size_t kFewestPoints = 6; ///< of a node
constexpr int kMostSteps = 4;
constexpr double kConverged = 0.02; ///< samples
constexpr float kFarthest = 8;      ///< samples beyond the camera's motion
constexpr double kPrior = 1;        ///< pulls a node's motion to the camera's

constexpr float kNoise = 2;         ///< ΔE: smaller residuals do not count
constexpr float kSmallGradient = 2; ///< ΔE per sample, added to the gradient
constexpr float kMostNovelty = 4;
/// A new key frame is due at this age, in frames at 30 fps.
constexpr double kOldestKey = 4.5;
constexpr double kHold = 7.5; ///< time constant in frames at 30 fps
/// Novelty at which the gate opens, and at which it is open.
constexpr float kOpens = 0.1F;
constexpr float kOpen = 0.4F;

} // namespace

const cv::Mat &
IndependentMotion::operator()(const LabImage &lab, const Similarity &pose, double elapsed,
                              int octaves)
{
  const bool follows = has_key_ && key_.size() == lab.size();
  if (follows) {
    age_ += elapsed;
    const Similarity motion = pose.inverse() * key_pose_;
    fit(lab.lightness(), motion);
    smooth();
    find_novelty(lab, motion);
  } else {
    novelty_.create(lab.size(), CV_32FC1);
    std::fill_n(novelty_.ptr<float>(), novelty_.total(), 0.0F);
    smooth_ = {};
  }
  if (!follows || age_ > kOldestKey)
    set_key(lab, pose);

  // Pooled at one octave below the result, which smooths by interpolation.
  const cv::Mat *pooled = &novelty_;
  for (int i = 0; i <= octaves; ++i) {
    reductions_[static_cast<std::size_t>(i)](*pooled, pooled_[static_cast<std::size_t>(i)]);
    pooled = &pooled_[static_cast<std::size_t>(i)];
  }
  const auto decay = static_cast<float>(std::exp(-elapsed / kHold));
  if (!follows || held_.size() != pooled->size()) {
    held_.create(pooled->size(), CV_32FC1);
    std::fill_n(held_.ptr<float>(), held_.total(), kOpen);
  }
  for (std::size_t i = 0; i < held_.total(); ++i) {
    float &value = held_.ptr<float>()[i];
    value = std::max(value * decay, pooled->ptr<float>()[i]);
  }
  const cv::Size size
      = octaves > 0 ? pooled_[static_cast<std::size_t>(octaves - 1)].size() : lab.size();
  upsample(held_, 1, 1, size, gate_);
  for (std::size_t i = 0; i < gate_.total(); ++i) {
    float &value = gate_.ptr<float>()[i];
    value = std::clamp((value - kOpens) / (kOpen - kOpens), 0.0F, 1.0F);
  }
  return gate_;
}

void
IndependentMotion::reset()
{
  has_key_ = false;
}

/// Makes this frame the key frame. Its points: the strongest gradient of each cell, by node.
void
IndependentMotion::set_key(const LabImage &now, const Similarity &pose)
{
  for (std::size_t c = 0; c < 3; ++c)
    now.planes[c].copyTo(key_.planes[c]);
  const cv::Mat &lightness = key_.lightness();
  has_key_ = true;
  key_pose_ = pose;
  age_ = 0;
  for (auto &points : points_)
    points.clear();
  for (int top = 1; top < lightness.rows - 1; top += kCell)
    for (int left = 1; left < lightness.cols - 1; left += kCell) {
      float best = kTexture * kTexture;
      int best_x = 0;
      int best_y = 0;
      float best_dx = 0;
      float best_dy = 0;
      for (int y = top; y < std::min(top + kCell, lightness.rows - 1); ++y)
        for (int x = left; x < std::min(left + kCell, lightness.cols - 1); ++x) {
          const auto *row = lightness.ptr<float>(y);
          const float dx = (row[x + 1] - row[x - 1]) / 2;
          const float dy = (lightness.ptr<float>(y + 1)[x] - lightness.ptr<float>(y - 1)[x]) / 2;
          if (dx * dx + dy * dy < best)
            continue;
          best = dx * dx + dy * dy;
          best_x = x;
          best_y = y;
          best_dx = dx;
          best_dy = dy;
        }
      if (best_x == 0)
        continue;
      const int column = best_x * kColumns / lightness.cols;
      const int row = best_y * kRows / lightness.rows;
      points_[static_cast<std::size_t>(row * kColumns + column)].add(
          static_cast<float>(best_x), static_cast<float>(best_y),
          lightness.ptr<float>(best_y)[best_x], { 0, 0, best_dx, best_dy, 0, 0 });
    }
  for (auto &points : points_)
    points.finish();
}

/// Registers each node with the key frame, by translation on top of the camera's motion.
void
IndependentMotion::fit(const cv::Mat &now, const Similarity &motion)
{
  for (std::size_t node = 0; node < mesh_.size(); ++node) {
    const TexturedPoints &points = points_[node];
    mesh_[node] = { smooth_[node].motion * static_cast<float>(age_), false };
    if (points.size() < kFewestPoints)
      continue;
    cv::Point2f &by = mesh_[node].motion;
    double scale = 20;
    for (int step = 0; step < kMostSteps; ++step) {
      Similarity position = motion;
      position.tx += static_cast<double>(by.x);
      position.ty += static_cast<double>(by.y);
      sample(now, position, points, values_);
      sorted_.clear();
      for (std::size_t i = 0; i < values_.size(); ++i) {
        values_[i] -= points.lightness[i];
        if (!std::isnan(values_[i]))
          sorted_.push_back(std::abs(values_[i]));
      }
      if (sorted_.size() < kFewestPoints)
        break;
      const Equations sums = equations(points, values_, scale);
      const double xx = sums.normal[2][2] + kPrior;
      const double xy = sums.normal[2][3];
      const double yy = sums.normal[3][3] + kPrior;
      const double determinant = xx * yy - xy * xy;
      const auto dx = (yy * sums.right[2] - xy * sums.right[3]) / determinant;
      const auto dy = (xx * sums.right[3] - xy * sums.right[2]) / determinant;
      by -= cv::Point2f(static_cast<float>(dx), static_cast<float>(dy));
      mesh_[node].known = true;
      if (std::abs(dx) + std::abs(dy) < kConverged)
        break;
      scale = std::max(1.0, 4.5 * static_cast<double>(quantile(sorted_, 0.5)));
    }
    if (std::abs(by.x) > kFarthest || std::abs(by.y) > kFarthest)
      mesh_[node].known = false;
  }
}

/// The median of the known nodes among each 3 × 3, per frame.
void
IndependentMotion::smooth()
{
  std::array<float, 9> xs;
  std::array<float, 9> ys;
  const auto median = [](std::array<float, 9> &values, std::size_t count) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      std::size_t count = 0;
      for (int r = std::max(0, row - 1); r <= std::min(kRows - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(kColumns - 1, column + 1); ++c)
          if (const Node &node = mesh_[static_cast<std::size_t>(r * kColumns + c)]; node.known) {
            xs[count] = node.motion.x;
            ys[count] = node.motion.y;
            ++count;
          }
      Node &node = smooth_[static_cast<std::size_t>(row * kColumns + column)];
      node = {};
      if (count > 0)
        node = { cv::Point2f(median(xs, count), median(ys, count)) / age_, true };
    }
}

namespace {

/// Place of a sample on an axis of the mesh, in nodes.
float
node_at(int sample, int size, int nodes)
{
  const float place
      = (static_cast<float>(sample) + 0.5F) * static_cast<float>(nodes) / static_cast<float>(size);
  return std::clamp(place - 0.5F, 0.0F, static_cast<float>(nodes - 1));
}

/// Where a sample was, inside the picture.
struct Place
{
  int x;
  int y;
  float right; ///< share of the sample to the right
  float below;

  float in(const cv::Mat &plane) const
  {
    const auto *upper = plane.ptr<float>(y) + x;
    const auto *lower = plane.ptr<float>(y + 1) + x;
    const float top = upper[0] + right * (upper[1] - upper[0]);
    const float bottom = lower[0] + right * (lower[1] - lower[0]);
    return top + below * (bottom - top);
  }
};

} // namespace

/// The difference to the key frame, moved by the mesh, relative to the gradient: a small error of
/// the motion leaves as much.
void
IndependentMotion::find_novelty(const LabImage &now, const Similarity &motion)
{
  const cv::Size size = now.size();
  novelty_.create(size, CV_32FC1);
  const Similarity back = motion.inverse();
  for (int y = 0; y < size.height; ++y) {
    const float at_y = node_at(y, size.height, kRows);
    const int upper = std::min(static_cast<int>(at_y), kRows - 2);
    const float down = at_y - static_cast<float>(upper);
    std::array<cv::Point2f, kColumns> nodes;
    for (int c = 0; c < kColumns; ++c) {
      const auto &above = smooth_[static_cast<std::size_t>(upper * kColumns + c)].motion;
      const auto &below = smooth_[static_cast<std::size_t>((upper + 1) * kColumns + c)].motion;
      nodes[static_cast<std::size_t>(c)]
          = (above + down * (below - above)) * static_cast<float>(age_);
    }
    auto *out = novelty_.ptr<float>(y);
    const int before_y = std::max(0, y - 1);
    const int after_y = std::min(size.height - 1, y + 1);
    for (int x = 0; x < size.width; ++x) {
      const float at_x = node_at(x, size.width, kColumns);
      const auto left = std::min(static_cast<std::size_t>(at_x), std::size_t{ kColumns - 2 });
      const cv::Point2f by
          = nodes[left] + (at_x - static_cast<float>(left)) * (nodes[left + 1] - nodes[left]);
      const double from_x = x - static_cast<double>(by.x);
      const double from_y = y - static_cast<double>(by.y);
      const auto px = static_cast<float>(back.x(from_x, from_y));
      const auto py = static_cast<float>(back.y(from_x, from_y));
      out[x] = 0;
      if (!(px >= 0 && py >= 0 && px < static_cast<float>(size.width - 1)
            && py < static_cast<float>(size.height - 1)))
        continue;
      Place place{ static_cast<int>(px), static_cast<int>(py), 0, 0 };
      place.right = px - static_cast<float>(place.x);
      place.below = py - static_cast<float>(place.y);
      const int before_x = std::max(0, x - 1);
      const int after_x = std::min(size.width - 1, x + 1);
      float residual = 0;
      float gradient = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const cv::Mat &plane = now.planes[c];
        const auto *row = plane.ptr<float>(y);
        const float rest = row[x] - place.in(key_.planes[c]);
        const float dx = (row[after_x] - row[before_x]) / 2;
        const float dy = (plane.ptr<float>(after_y)[x] - plane.ptr<float>(before_y)[x]) / 2;
        residual += rest * rest;
        gradient += dx * dx + dy * dy;
      }
      out[x] = std::min(kMostNovelty, std::max(0.0F, std::sqrt(residual) - kNoise)
                                          / (std::sqrt(gradient) + kSmallGradient));
    }
  }
}

} // namespace saliency
