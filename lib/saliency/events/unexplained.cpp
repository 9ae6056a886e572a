// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/unexplained.h"

#include "saliency/dilation.h"
#include "saliency/quantile.h"
#include "saliency/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

namespace {

constexpr float kTexture = 1.6F;    ///< gradient of a textured place, L* per sample
constexpr float kNoise = 0.31F;     ///< ΔE, of the best of pictures
constexpr float kMisfit = 0.1F;     ///< least error of the alignment, samples
constexpr float kMisfitGain = 1.2F; ///< of the error that the pictures show
constexpr float kBeyond = 2.5F;     ///< σ of the noise
constexpr float kChroma = 0.3F; ///< weight of Δa² + Δb²: films store it at half the resolution
constexpr std::size_t kFewest = 24; ///< samples that show noise
// An object alone on an even ground has all of the texture, and would explain its own motion.
constexpr int kParts = 4;        ///< of each side
constexpr int kFewestParts = 5;  ///< that have texture
constexpr int kFewestOfPart = 4; ///< samples
// The exposure is compared by means over blocks: interpolation takes contrast from texture.
constexpr int kBlockColumns = 20;
constexpr int kBlockRows = 11;
constexpr std::array kScales{ 12.0, 5.0, 2.4, 2.4 }; ///< of residuals, L*
constexpr double kVariance = 3;                      ///< pulls the gain to 1, L*²
constexpr double kSteady = 0.02;                     ///< a gain this near to 1 is none
constexpr double kSteadyOffset = 0.27;               ///< L*

} // namespace

void
Unexplained::align(const LabImage &then, const Similarity &before)
{
  for (std::size_t c = 0; c < 3; ++c)
    if (then.planes[c].empty())
      then_[c].release();
    else if (before == Similarity{} || then.size().width < 2 || then.size().height < 2)
      then_[c] = then.planes[c];
    else {
      warp(then.planes[c], before, warped_[c]);
      then_[c] = warped_[c];
    }
}

/// Gain and offset of `now`'s lightness, robustly.
void
Unexplained::find_exposure(const cv::Mat &now)
{
  struct Block
  {
    double now = 0;
    double then = 0;
    double count = 0;
  };
  std::array<Block, static_cast<std::size_t>(kBlockColumns * kBlockRows)> blocks;
  for (int y = 0; y < now.rows; ++y) {
    const auto *present = now.ptr<float>(y);
    const auto *past = then_[0].ptr<float>(y);
    Block *row = &blocks[static_cast<std::size_t>(y * kBlockRows / now.rows * kBlockColumns)];
    for (int x = 0; x < now.cols; ++x)
      if (!std::isnan(past[x])) {
        Block &block = row[x * kBlockColumns / now.cols];
        block.now += static_cast<double>(present[x]);
        block.then += static_cast<double>(past[x]);
        ++block.count;
      }
  }
  double gain = 1;
  double offset = 0;
  double mean_then = 0;
  for (const double scale : kScales) {
    double sum = 0;
    double u = 0;
    double v = 0;
    double uu = 0;
    double vv = 0;
    for (const Block &block : blocks) {
      if (block.count == 0)
        continue;
      const double past = block.then / block.count;
      const double present = block.now / block.count;
      const double residual = (present - gain * past - offset) / scale;
      const double weight = 1 / ((1 + residual * residual) * (1 + residual * residual));
      sum += weight;
      u += weight * past;
      v += weight * present;
      uu += weight * past * past;
      vv += weight * present * present;
    }
    if (sum <= 0)
      break;
    mean_then = u / sum;
    const double mean_now = v / sum;
    gain = std::sqrt((std::max(0.0, vv / sum - mean_now * mean_now) + kVariance)
                     / (std::max(0.0, uu / sum - mean_then * mean_then) + kVariance));
    offset = mean_now - gain * mean_then;
  }
  if (std::abs(gain - 1) < kSteady && std::abs(offset + (gain - 1) * mean_then) < kSteadyOffset) {
    gain = 1;
    offset = 0;
  }
  gain_ = static_cast<float>(gain);
  offset_ = static_cast<float>(offset);
}

void
Unexplained::find_gradients(const cv::Mat &now)
{
  gradients_.create(now.size(), CV_32FC1);
  const cv::Mat &then = then_[0];
  for (int y = 0; y < now.rows; ++y) {
    const int above = std::max(0, y - 1);
    const int below = std::min(now.rows - 1, y + 1);
    auto *out = gradients_.ptr<float>(y);
    const auto squared = [&](const cv::Mat &image, int x, int left, int right) {
      const auto *row = image.ptr<float>(y);
      const float dx = row[right] - row[left];
      const float dy = image.ptr<float>(below)[x] - image.ptr<float>(above)[x];
      return dx * dx + dy * dy;
    };
    for (int x = 0; x < now.cols; ++x) {
      const int left = std::max(0, x - 1);
      const int right = std::min(now.cols - 1, x + 1);
      const float one = squared(now, x, left, right);
      const float other = squared(then, x, left, right);
      out[x] = std::sqrt(other > one ? other : one) / 2; // NaN is not greater
    }
  }
  dilate(gradients_, 1, along_rows_, around_);
}

const cv::Mat &
Unexplained::operator()(const LabImage &now, const LabImage &then, const Similarity &before)
{
  const cv::Mat &lightness = now.lightness();
  align(then, before);
  find_exposure(lightness);
  find_gradients(lightness);
  const cv::Size size = lightness.size();
  difference_.create(size, CV_32FC1);
  beyond_.create(size, CV_32FC1);
  even_.clear();
  even_.reserve(difference_.total()); // a later picture may have more
  textured_.clear();
  textured_.reserve(difference_.total());
  std::array<int, static_cast<std::size_t>(kParts * kParts)> parts{};
  const bool chroma = !then_[1].empty() && !now.planes[1].empty();
  for (int y = 0; y < size.height; ++y) {
    const auto *present = lightness.ptr<float>(y);
    const auto *past = then_[0].ptr<float>(y);
    const auto *gradient = around_.ptr<float>(y);
    auto *out = difference_.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      float difference = std::abs(present[x] - (gain_ * past[x] + offset_));
      if (chroma) {
        const float da = now.planes[1].ptr<float>(y)[x] - then_[1].ptr<float>(y)[x];
        const float db = now.planes[2].ptr<float>(y)[x] - then_[2].ptr<float>(y)[x];
        difference = std::sqrt(difference * difference + kChroma * (da * da + db * db));
      }
      out[x] = difference;
      if (std::isnan(difference))
        continue;
      if (gradient[x] > kTexture) {
        textured_.push_back(difference / gradient[x]);
        ++parts[static_cast<std::size_t>(y * kParts / size.height * kParts
                                         + x * kParts / size.width)];
      } else
        even_.push_back(difference);
    }
  }
  const bool told = textured_.size() >= kFewest && std::ranges::count_if(parts, [](int count) {
                                                     return count >= kFewestOfPart;
                                                   }) >= kFewestParts;
  misfit_ = told ? quantile(textured_, 0.5) : 0;
  const float noise = kNoise + (even_.size() < kFewest ? 0 : 1.48F * quantile(even_, 0.5));
  const float slope = kMisfit + kMisfitGain * misfit_;
  for (std::size_t i = 0; i < beyond_.total(); ++i) {
    const float texture = slope * around_.ptr<float>()[i];
    const float most = kBeyond * std::sqrt(noise * noise + texture * texture);
    const float beyond = difference_.ptr<float>()[i] - most;
    beyond_.ptr<float>()[i] = beyond > 0 ? beyond : 0; // also where it is NaN
  }
  return beyond_;
}

void
Unexplained::split(const LabImage &now, cv::Mat &brighter, cv::Mat &darker) const
{
  for (cv::Mat *map : { &brighter, &darker }) {
    map->create(beyond_.size(), CV_32FC1);
    std::fill_n(map->ptr<float>(), map->total(), 0.0F);
  }
  for (std::size_t i = 0; i < beyond_.total(); ++i)
    if (const float beyond = beyond_.ptr<float>()[i]; beyond > 0) {
      const float then = gain_ * then_[0].ptr<float>()[i] + offset_;
      const float rise = now.lightness().ptr<float>()[i] - then;
      (rise > 0 ? brighter : darker).ptr<float>()[i]
          = beyond * std::abs(rise) / difference_.ptr<float>()[i];
    }
}

} // namespace saliency
