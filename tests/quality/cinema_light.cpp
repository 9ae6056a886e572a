// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_light.h"

#include "layered_scene.h"
#include "random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace quality {

namespace {

constexpr double kLength = std::chrono::duration<double>(kCinemaLength).count();

constexpr int kWide = 3; ///< widths of the frame that a picture has

/// One change: from `begin` on for `length` seconds.
struct Change
{
  double begin = 0;
  double length = 0;
  double from = 0; ///< of what changes: logarithm of the gain or the scale, a place in widths
  double to = 0;
};

double
eased(double share)
{
  const double x = std::clamp(share, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// The picture with its linear light multiplied (gamma 2.2), then clipped.
void
expose(cv::Mat &picture, double gain)
{
  if (gain != 1)
    picture.convertTo(picture, -1, std::pow(gain, 1 / 2.2));
}

class LightFilm : public CinemaFilm
{
public:
  LightFilm(Light light, const std::vector<cv::Mat> &pictures, cv::Size size, std::uint64_t seed)
      : light_(light), size_(size), random_(seed * 6007 + static_cast<std::uint64_t>(light)),
        tremor_(random_, 1, 6)
  {
    for (std::size_t i = 0; i < pictures.size(); ++i)
      pictures_.push_back(fitted(pictures[(i + seed) % pictures.size()]));
    for (double begin = random_.uniform(1.5, 2.5); begin < kLength;)
      begin = add_change(begin);
    fire_ = { size.width * random_.uniform(0.3, 0.7), size.height * random_.uniform(0.45, 0.8) };
    fire_radius_ = size.width * random_.uniform(0.05, 0.09);
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = std::chrono::duration<double>(time).count();
    while (now_ + 1 < changes_.size() && t >= changes_[now_ + 1].begin)
      ++now_;
    const Change &change = changes_[now_];
    const double share = eased((t - change.begin) / change.length);
    const double value = change.from + (change.to - change.from) * share;
    const cv::Mat &picture = pictures_[now_ % pictures_.size()];
    switch (light_) {
    case Light::dissolve: {
      // At the end of a change the next begins from its picture.
      const double linear = std::clamp((t - change.begin) / change.length, 0.0, 1.0);
      show(picture, 0, 1, bgr);
      show(pictures_[(now_ + 1) % pictures_.size()], 0, 1, other_);
      cv::addWeighted(bgr, 1 - linear, other_, linear, 0, bgr);
      break;
    }
    case Light::fade: {
      const double linear = std::clamp((t - change.begin) / change.length, 0.0, 1.0);
      const double shown = std::abs(1 - 2 * linear);
      show(pictures_[(now_ + (linear > 0.5 ? 1 : 0)) % pictures_.size()], 0, 1, bgr);
      bgr.convertTo(bgr, -1, shown, change.to > 0 ? 255 * (1 - shown) : 0);
      break;
    }
    case Light::exposure:
      show(pictures_[0], 0, 1, bgr);
      expose(bgr, std::exp(value));
      break;
    case Light::flash:
      show(pictures_[0], 0, 1, bgr);
      if (t >= change.begin && t < change.begin + change.length)
        expose(bgr, std::exp(change.to));
      break;
    case Light::glow:
      show(pictures_[0], 0, 1, bgr);
      bgr.convertTo(bgr, -1, std::clamp(1 + 0.1 * tremor_.at(t), 0.6, 1.4));
      break;
    case Light::fire:
      return draw_fire(t, bgr);
    case Light::fast_pan: {
      show(pictures_[0], value, 1, bgr);
      const double before
          = change.from
            + (change.to - change.from) * eased((t - 1e-3 - change.begin) / change.length);
      // Half of 1/30 s.
      const int blur = static_cast<int>(std::abs(value - before) * 1e3 / 60 * size_.width);
      if (blur > 0)
        cv::blur(bgr, bgr, { 2 * (blur / 2) + 1, 1 });
      break;
    }
    case Light::zoom:
      show(pictures_[0], 0, std::exp(value), bgr);
      break;
    }
    return {};
  }

private:
  /// As wide as kWide frames, with the area of a pixel.
  cv::Mat fitted(const cv::Mat &picture) const
  {
    const int width = static_cast<int>(size_.width * kTexels);
    const int height = static_cast<int>(size_.height * kTexels * 1.1);
    cv::Mat fit;
    cv::resize(picture, fit, { width, picture.rows * width / picture.cols }, 0, 0,
               picture.cols > width ? cv::INTER_AREA : cv::INTER_CUBIC);
    cv::copyMakeBorder(fit, fit, 0, std::max(0, height - fit.rows), 0,
                       light_ == Light::fast_pan ? (kWide - 1) * width : width / 10,
                       cv::BORDER_REFLECT_101);
    cv::GaussianBlur(fit, fit, {}, kAperture * kTexels);
    return fit;
  }

  /// The frame's middle is half a width and `place` to the right of the picture's left side.
  void show(const cv::Mat &picture, double place, double scale, cv::Mat &bgr) const
  {
    const double texels = kTexels / scale;
    const double x = (0.55 + place) * size_.width * kTexels;
    const double y = 0.55 * size_.height * kTexels;
    const cv::Matx23d to_texel(texels, 0, x + texels * (0.5 - size_.width / 2.0) - 0.5, 0, texels,
                               y + texels * (0.5 - size_.height / 2.0) - 0.5);
    cv::warpAffine(picture, bgr, to_texel, size_, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REFLECT_101);
  }

  /// Returns when the next begins.
  double add_change(double begin)
  {
    Change change;
    change.begin = begin;
    change.length = random_.uniform(0.5, 2);
    const double last = changes_.empty() ? 0 : changes_.back().to;
    switch (light_) {
    case Light::exposure:
      change.from = last;
      do {
        change.to = random_.uniform(-std::log(2), std::log(2));
      } while (std::abs(change.to - last) < 0.3);
      break;
    case Light::flash:
      change.length = std::floor(random_.uniform(1, 4)) / 30;
      change.to = random_.uniform(std::log(2), std::log(4));
      break;
    case Light::fade:
      change.length *= 2;
      change.to = random_.uniform(0, 1) < 0.25 ? 1 : 0;
      break;
    case Light::fast_pan:
      change.length = random_.uniform(0.5, 1);
      change.from = last;
      change.to = std::abs(last - random_.uniform(0.5, 1)); // to and fro
      break;
    case Light::zoom:
      change.length = random_.uniform(0.7, 2);
      change.from = last;
      change.to = last > 0 ? 0 : random_.uniform(std::log(1.3), std::log(1.8));
      break;
    default:
      break;
    }
    changes_.push_back(change);
    return begin + change.length + random_.uniform(2, 3);
  }

  Expected draw_fire(double t, cv::Mat &bgr)
  {
    constexpr double kLit = 2;
    constexpr double kCatches = 0.3; // s
    constexpr double kFound = 0.5;
    constexpr double kSettled = 4;
    show(pictures_[0], 0, 1, bgr);
    bgr.convertTo(bgr, -1, 0.5); // evening
    Expected expected;
    if (t < kLit)
      return expected;
    const double strength = std::min(1.0, (t - kLit) / kCatches + 0.1)
                            * std::clamp(1 + 0.25 * tremor_.at(t), 0.3, 1.7);
    const double radius = fire_radius_ * (1 + 0.1 * tremor_.at(t + 100));
    for (int y = 0; y < bgr.rows; ++y) {
      auto *row = bgr.ptr<cv::Vec3b>(y);
      for (int x = 0; x < bgr.cols; ++x) {
        const double far2
            = (std::pow(x - fire_.x, 2) + std::pow(y - fire_.y, 2)) / (radius * radius);
        const double flame = 230 * strength / (1 + far2 * far2);
        const double glow = 1 + 0.8 * strength / (1 + far2 / 40);
        row[x] = { cv::saturate_cast<uchar>(row[x][0] * (1 + (glow - 1) * 0.3) + 0.2 * flame),
                   cv::saturate_cast<uchar>(row[x][1] * (1 + (glow - 1) * 0.7) + 0.6 * flame),
                   cv::saturate_cast<uchar>(row[x][2] * glow + flame) };
      }
    }
    expected.events = 1;
    if (t < kLit + kSettled) {
      expected.verdict = t < kLit + kFound ? Verdict::felt : Verdict::allowed;
      expected.cells = cells_of(
          { fire_.x - fire_radius_, fire_.y - fire_radius_, 2 * fire_radius_, 2 * fire_radius_ },
          size_);
    }
    return expected;
  }

  Light light_;
  cv::Size size_;
  Random random_;
  Tremor tremor_;
  std::vector<cv::Mat> pictures_;
  std::vector<Change> changes_;
  std::size_t now_ = 0;
  cv::Point2d fire_;
  double fire_radius_ = 0;
  cv::Mat other_;
};

} // namespace

std::unique_ptr<CinemaFilm>
light_film(Light light, const std::vector<cv::Mat> &pictures, cv::Size size, std::uint64_t seed)
{
  return std::make_unique<LightFilm>(light, pictures, size, seed);
}

} // namespace quality
