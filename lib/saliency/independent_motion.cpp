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
/// Robust scale of each step's residuals, L*: from all that may be found to what fits well.
constexpr std::array kScales{ 20.0F, 12.0F, 8.0F, 5.0F };
constexpr double kConverged = 0.02; ///< samples
constexpr float kFarthest = 8;      ///< samples beyond the camera's motion
constexpr double kPrior = 1;        ///< pulls a node's motion to the camera's

constexpr NoveltyScale kNovelty{ .noise = 2, .least_gradient = 2, .most = 4 };
/// A new key frame is due at this age, in frames at 30 fps.
constexpr double kOldestKey = 4.5;
constexpr double kHold = 7.5; ///< time constant in frames at 30 fps
/// Novelty at which the gate opens, and at which it is open.
constexpr float kOpens = 0.2F;
constexpr float kOpen = 0.6F;
/// Much depth nearby leaves novelty everywhere: the gate opens later, at kClutter times its upper
/// quartile, but no later than kOpensLast.
constexpr double kUpperQuartile = 0.75;
constexpr float kClutter = 1.5F;
constexpr float kOpensLast = 0.7F;

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
    std::fill_n(held_.ptr<float>(), held_.total(), 0.0F);
    before_ = kOpen;
  }
  before_ *= decay;
  for (std::size_t i = 0; i < held_.total(); ++i) {
    float &value = held_.ptr<float>()[i];
    value = std::max(value * decay, pooled->ptr<float>()[i]);
  }
  const cv::Size size
      = octaves > 0 ? pooled_[static_cast<std::size_t>(octaves - 1)].size() : lab.size();
  upsample(held_, 1, 1, size, gate_);
  sorted_.assign(held_.ptr<float>(), held_.ptr<float>() + held_.total());
  const float opens = std::clamp(kClutter * quantile(sorted_, kUpperQuartile), kOpens, kOpensLast);
  const float least = std::clamp((before_ - kOpens) / (kOpen - kOpens), 0.0F, 1.0F);
  for (std::size_t i = 0; i < gate_.total(); ++i) {
    float &value = gate_.ptr<float>()[i];
    value = std::clamp((value - opens) / (kOpen - kOpens), least, 1.0F);
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
    for (const float scale : kScales) {
      Similarity position = motion;
      position.tx += static_cast<double>(by.x);
      position.ty += static_cast<double>(by.y);
      const ShiftEquations sums = shift_equations(now, position, points, scale);
      if (sums.points < kFewestPoints)
        break;
      const double xx = sums.xx + kPrior;
      const double yy = sums.yy + kPrior;
      const double determinant = xx * yy - sums.xy * sums.xy;
      const auto dx = (yy * sums.x - sums.xy * sums.y) / determinant;
      const auto dy = (xx * sums.y - sums.xy * sums.x) / determinant;
      by -= cv::Point2f(static_cast<float>(dx), static_cast<float>(dy));
      mesh_[node].known = true;
      if (std::abs(dx) + std::abs(dy) < kConverged)
        break;
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

} // namespace

/// The mesh's rows at each column of the picture.
void
IndependentMotion::widen(int width)
{
  wide_.resize(2 * static_cast<std::size_t>(kRows * width));
  float *x = wide_.data();
  float *y = x + kRows * width;
  for (int column = 0; column < width; ++column) {
    const float at = node_at(column, width, kColumns);
    const int left = std::min(static_cast<int>(at), kColumns - 2);
    const float share = at - static_cast<float>(left);
    for (int row = 0; row < kRows; ++row) {
      const Node *node = &smooth_[static_cast<std::size_t>(row * kColumns + left)];
      const cv::Point2f by
          = (node[0].motion + share * (node[1].motion - node[0].motion)) * static_cast<float>(age_);
      x[row * width + column] = by.x;
      y[row * width + column] = by.y;
    }
  }
}

/// The difference to the key frame, moved by the mesh, relative to the gradient: a small error of
/// the motion leaves as much.
void
IndependentMotion::find_novelty(const LabImage &now, const Similarity &motion)
{
  const cv::Size size = now.size();
  novelty_.create(size, CV_32FC1);
  widen(size.width);
  const Similarity back = motion.inverse();
  for (int y = 0; y < size.height; ++y) {
    const float at = node_at(y, size.height, kRows);
    const int above = std::min(static_cast<int>(at), kRows - 2);
    const auto row = [this, width = size.width](int part, int node_row) {
      return wide_.data() + (part * kRows + node_row) * width;
    };
    const RowMotion by{ .x = { row(0, above), row(0, above + 1) },
                        .y = { row(1, above), row(1, above + 1) },
                        .weight = at - static_cast<float>(above) };
    novelty(now, key_, back, by, y, kNovelty, novelty_.ptr<float>(y));
  }
}

} // namespace saliency
