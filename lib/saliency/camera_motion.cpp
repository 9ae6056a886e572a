// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/camera_motion.h"

#include "saliency/quantile.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

// A new key frame is due at this age, in frames at 30 fps, or after this much motion, in samples.
constexpr double kOldestKey = 8;
constexpr double kFarthestKey = 2;

/// Smallest motion that counts, in samples at the corner of the picture that moves most.
constexpr double kSmallestMotion = 0.2;
/// Largest motion since the key frame, as a share of the picture's larger side; beyond it, too
/// little overlaps.
constexpr double kLargestMotion = 0.35;

/// Points: the strongest gradient of each cell of this side in samples, finest level first, if it
/// reaches kTexture (L* per sample).
constexpr std::array<int, 3> kCell{ 4, 2, 1 };
constexpr float kTexture = 1.0F;

// The vote on whether the picture moved, by kParts × kParts parts. A part votes if it has at least
// kFewestPoints points, in at least kTexturedShare of its cells, and these would move by
// kSmallestPartMotion samples on average. It agrees if the motion, if need be with a shift of its
// own, leaves less than kExplained of the difference. The camera moves if at least kEnoughParts
// parts vote, kPlainly of them agree without a shift of their own, and kAgreeing with one, in about
// the camera's direction. In a picture of a few dozen samples, a single object could fill most
// parts; no motion is reported there.
constexpr int kParts = 4;
constexpr double kTexturedShare = 0.15;
constexpr int kFewestPoints = 3;
constexpr double kSmallestPartMotion = 0.15;
constexpr int kEnoughParts = 5;
constexpr int kEnoughSides
    = 3; ///< of the picture, with agreeing parts; a large moving object reaches fewer
constexpr double kAgreeing = 0.8;
constexpr double kExplained = 0.7;
constexpr double kPlainly = 0.6;   ///< of them without a shift of their own
constexpr double kMostSlant = 0.5; ///< of a part's motion, to the camera's; tan of the angle
/// Scale of the residuals in each step of a part's shift, L*: larger residuals lose weight.
constexpr std::array<float, 4> kPartScales{ 20, 10, 5, 5 };

constexpr int kMostSteps = 6;
constexpr double kConverged = 0.02; ///< samples

/// Lightness relative to mid-gray, on which the gain acts.
float
exposed(float lightness)
{
  return (lightness - 50) / 50;
}

/// The largest displacement of a corner of the picture.
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
CameraMotion::follow(const cv::Mat &lightness, double elapsed)
{
  now_[0] = lightness;
  for (std::size_t i = 1; i < kLevels; ++i)
    reductions_[i](now_[i - 1], now_[i]);

  if (lightness.size() != size_) {
    pose_ = {};
    moved_ = false;
    set_key();
    return pose_;
  }

  age_ += elapsed;
  change_.exposure = {};
  for (std::size_t level = kLevels; level-- > 0;) {
    const double unit = std::ldexp(1.0, static_cast<int>(level)); // in samples of the finest level
    change_ = fit(level, { change_.motion.in_units_of(unit), change_.exposure }, false);
    change_.motion = change_.motion.in_units_of(1 / unit);
  }
  const double distance = farthest(change_.motion, size_);
  moved_ = distance > kSmallestMotion
           && distance < kLargestMotion * std::max(size_.width, size_.height) && explained();
  if (moved_)
    pose_ = key_pose_ * change_.motion.inverse();
  else
    change_.motion = {};
  if (age_ >= kOldestKey || (moved_ && distance > kFarthestKey))
    set_key();
  return pose_;
}

void
CameraMotion::stay(double elapsed)
{
  age_ += elapsed;
  if (age_ >= kOldestKey)
    set_key();
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
  change_ = {};
  age_ = 0;
  for (std::size_t level = 0; level < kLevels; ++level) {
    const cv::Mat &image = now_[level];
    auto &points = points_[level];
    points.clear();
    const int cell = kCell[level];
    const float unit
        = 2.0F
          / static_cast<float>(image.cols); // normalizes coordinates to [-1, 1], for conditioning
    for (int top = 1; top < image.rows - 1; top += cell)
      for (int left = 1; left < image.cols - 1; left += cell) {
        float best = kTexture * kTexture;
        float best_x = 0;
        float best_y = 0;
        float lightness = 0;
        std::array<float, TexturedPoints::kParameters> change{};
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
            best_x = static_cast<float>(x);
            best_y = static_cast<float>(y);
            lightness = row[x];
            change = { dx * px + dy * py, dy * px - dx * py, dx, dy, exposed(row[x]), 1 };
          }
        if (change[5] > 0)
          points.add(best_x, best_y, lightness, change);
      }
    points.finish();
  }
  const TexturedPoints &finest = points_[0];
  part_of_.resize(finest.size());
  for (std::size_t i = 0; i < finest.size(); ++i) {
    const auto column
        = static_cast<std::size_t>(finest.x[i] * kParts / static_cast<float>(size_.width));
    const auto row
        = static_cast<std::size_t>(finest.y[i] * kParts / static_cast<float>(size_.height));
    part_of_[i] = row * kParts + column;
  }
}

/// Residuals at the points of a level after `change`; NaN where a point leaves the picture.
void
CameraMotion::find_residuals(std::size_t level, const Change &change,
                             std::vector<float> &residuals) const
{
  const auto &points = points_[level];
  sample(now_[level], change.motion, points, residuals);
  const auto gain = static_cast<float>(change.exposure[0]);
  const auto offset = static_cast<float>(change.exposure[1]);
  for (std::size_t i = 0; i < residuals.size(); ++i)
    residuals[i] -= points.lightness[i] + gain * points.change[4][i] + offset;
}

/// Refines `change` on one level; with `at_rest`, its exposure alone.
CameraMotion::Change
CameraMotion::fit(std::size_t level, Change change, bool at_rest)
{
  const cv::Mat &image = now_[level];
  double scale = 20; // L*: larger residuals lose weight
  for (int step = 0; step < kMostSteps; ++step) {
    find_residuals(level, change, residuals_);
    sizes_.clear();
    for (const float residual : residuals_)
      if (!std::isnan(residual))
        sizes_.push_back(std::abs(residual));
    if (sizes_.size() < 12)
      break;

    const Equations sums = equations(points_[level], residuals_, scale);
    cv::Matx<double, 6, 6> normal = cv::Matx<double, 6, 6>::eye();
    cv::Vec<double, 6> right = cv::Vec<double, 6>::all(0);
    const int first = at_rest ? 4 : 0; // exposure comes last
    for (int m = first; m < 6; ++m) {
      const auto &row = sums.normal[static_cast<std::size_t>(m)];
      for (int n = m; n < 6; ++n) {
        normal(m, n) += row[static_cast<std::size_t>(n)];
        normal(n, m) = normal(m, n);
      }
      right[m] = sums.right[static_cast<std::size_t>(m)];
    }
    // The prior (the identity in `normal`) pulls the total exposure to 0, not just this step's
    // change.
    right[4] -= change.exposure[0];
    right[5] -= change.exposure[1];
    const cv::Vec<double, 6> by = normal.solve(right, cv::DECOMP_CHOLESKY);

    // From normalized coordinates around the picture's center to samples from the origin.
    const double middle_x = image.cols / 2.0;
    const double middle_y = image.rows / 2.0;
    const double scaled = by[0] * 2 / image.cols;
    const double turned = by[1] * 2 / image.cols;
    const Similarity small{ 1 + scaled, turned, by[2] - scaled * middle_x + turned * middle_y,
                            by[3] - turned * middle_x - scaled * middle_y };
    change.motion = change.motion * small.inverse();
    change.exposure[0] += by[4];
    change.exposure[1] += by[5];
    if (!at_rest
        && std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]) + std::abs(by[3]) < kConverged)
      break;
    scale = std::max(0.5, 4.5 * static_cast<double>(quantile(sizes_, 0.5))); // 3 σ
  }
  return change;
}

/// Moves the points of the key frame in a part of the picture, beyond the camera's motion, to where
/// they are now: that of nearby things in a picture of depth. Writes their residuals if they become
/// smaller.
cv::Point2d
CameraMotion::fit_part(std::size_t part)
{
  const TexturedPoints &points = points_[0];
  const auto gain = static_cast<float>(change_.exposure[0]);
  const auto offset = static_cast<float>(change_.exposure[1]);
  part_points_.clear();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (part_of_[i] == part)
      part_points_.add(points.x[i], points.y[i],
                       points.lightness[i] + gain * points.change[4][i] + offset,
                       { 0, 0, points.change[2][i], points.change[3][i], 0, 0 });
  part_points_.finish();

  cv::Point2d shift;
  Similarity position = change_.motion;
  for (const float scale : kPartScales) {
    const ShiftEquations sums = shift_equations(now_[0], position, part_points_, scale);
    const double xx = sums.xx + 1;
    const double yy = sums.yy + 1;
    const double determinant = xx * yy - sums.xy * sums.xy;
    shift -= cv::Point2d((yy * sums.x - sums.xy * sums.y) / determinant,
                         (xx * sums.y - sums.xy * sums.x) / determinant);
    position.tx = change_.motion.tx + shift.x;
    position.ty = change_.motion.ty + shift.y;
  }
  sample(now_[0], position, part_points_, part_residuals_);
  double before = 0;
  double after = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (part_of_[i] != part)
      continue;
    float &residual = part_residuals_[next];
    residual -= part_points_.lightness[next];
    ++next;
    if (std::isnan(residuals_[i]))
      residual = residuals_[i];
    else if (std::isnan(residual)) // out of the picture
      return {};
    else {
      before += std::abs(static_cast<double>(residuals_[i]));
      after += std::abs(static_cast<double>(residual));
    }
  }
  if (after >= before)
    return {};
  next = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (part_of_[i] == part)
      residuals_[i] = part_residuals_[next++];
  return shift;
}

/// The vote of a part whose points moved by `shift` beyond the camera's motion.
CameraMotion::Vote
CameraMotion::vote(std::size_t part, cv::Point2d shift) const
{
  const TexturedPoints &points = points_[0];
  const Similarity &motion = change_.motion;
  int count = 0;
  double distance = 0;
  double with = 0;     // total difference after the motion
  double without = 0;  // without any motion
  double opposite = 0; // after the opposite motion
  double along = 0;    // the camera's motion
  double across = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (part_of_[i] != part || std::isnan(residuals_[i]))
      continue;
    const double x = points.x[i];
    const double y = points.y[i];
    const double at_rest = std::abs(static_cast<double>(without_[i]));
    count++;
    const cv::Point2d camera(motion.x(x, y) - x, motion.y(x, y) - y);
    distance += std::hypot(camera.x + shift.x, camera.y + shift.y);
    along += camera.dot(camera + shift);
    across += camera.cross(camera + shift);
    with += std::abs(static_cast<double>(residuals_[i]));
    without += at_rest;
    opposite += std::isnan(opposite_[i]) ? at_rest : std::abs(static_cast<double>(opposite_[i]));
  }
  const double cells = static_cast<double>(size_.area()) / (kCell[0] * kCell[0] * kParts * kParts);
  if (count < kFewestPoints || count < kTexturedShare * cells
      || distance < kSmallestPartMotion * count)
    return Vote::none;
  // Interpolation averages noise in either direction, so compare with the opposite motion, too.
  if (along < 0 || std::abs(across) > kMostSlant * along)
    return Vote::rested;
  return with < kExplained * std::min(without, opposite) ? Vote::moved : Vote::rested;
}

/// Whether most voting parts agree with the motion (see kParts).
bool
CameraMotion::explained()
{
  const Similarity &motion = change_.motion;
  const Similarity back{ 2 - motion.a, -motion.b, -motion.tx, -motion.ty }; // p - (motion(p) - p)
  const Change rest = fit(0, {}, true);
  find_residuals(0, { back, rest.exposure }, opposite_);
  find_residuals(0, rest, without_);
  find_residuals(0, change_, residuals_);

  int asked = 0;
  int agreeing = 0;
  int plainly = 0;             // without a shift of their own
  std::array<bool, 4> sides{}; // with agreeing parts
  for (std::size_t part = 0; part < std::size_t{ kParts * kParts }; ++part) {
    Vote moved = vote(part, {});
    plainly += moved == Vote::moved ? 1 : 0;
    if (moved == Vote::rested && vote(part, fit_part(part)) == Vote::moved)
      moved = Vote::moved;
    asked += moved != Vote::none ? 1 : 0;
    if (moved != Vote::moved)
      continue;
    ++agreeing;
    const std::size_t row = part / kParts;
    const std::size_t column = part % kParts;
    sides[0] |= row == 0;
    sides[1] |= row == kParts - 1;
    sides[2] |= column == 0;
    sides[3] |= column == kParts - 1;
  }
  return asked >= kEnoughParts && plainly >= kPlainly * asked && agreeing >= kAgreeing * asked
         && std::ranges::count(sides, true) >= kEnoughSides;
}

} // namespace saliency
