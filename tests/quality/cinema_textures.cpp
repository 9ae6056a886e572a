// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_textures.h"

#include "camera_path.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace quality {

namespace {

constexpr double kTau = 2 * std::numbers::pi;
constexpr int kShift = 4; ///< fractional bits of OpenCV's drawing functions

cv::Point
fixed_point(double x, double y)
{
  return { static_cast<int>(std::lround(std::ldexp(x, kShift))),
           static_cast<int>(std::lround(std::ldexp(y, kShift))) };
}

int
fixed_point(double length)
{
  return fixed_point(length, 0).x;
}

/// Gaussian noise of σ 1 with that blur, CV_32FC1.
cv::Mat
smooth_noise(Random &random, cv::Size size, double blur)
{
  cv::Mat noise(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      noise.at<float>(y, x) = static_cast<float>(random.normal());
  cv::GaussianBlur(noise, noise, {}, blur);
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(noise, mean, sigma);
  return (noise - mean[0]) / sigma[0];
}

class StirringFilm : public CinemaFilm
{
public:
  StirringFilm(const cv::Mat &picture, cv::Size size) : size_(size), unit_(size.width / 640.0)
  {
    cv::resize(picture, picture_, size, 0, 0, cv::INTER_AREA);
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    constexpr Time kSettled = std::chrono::seconds(4);
    draw(std::chrono::duration<double>(time).count(), bgr);
    return time < kSettled ? anything() : Expected{};
  }

protected:
  virtual void draw(double t, cv::Mat &bgr) = 0;

  cv::Size size() const
  {
    return size_;
  }
  /// Pixels per pixel of 640.
  double unit() const
  {
    return unit_;
  }
  cv::Mat &picture()
  {
    return picture_;
  }

private:
  cv::Size size_;
  double unit_;
  cv::Mat picture_;
};

class Rain : public StirringFilm
{
public:
  Rain(const cv::Mat &picture, cv::Size size, std::uint64_t seed) : StirringFilm(picture, size)
  {
    Random random(seed * 31 + 1);
    slant_ = random.uniform(-0.15, 0.15);
    for (int i = 0; i < kDrops; ++i)
      drops_.push_back({ random.uniform(0, 1), random.uniform(0, 1), 1 + i % 3 });
    this->picture() *= 0.8;
  }

protected:
  void draw(double t, cv::Mat &bgr) override
  {
    picture().copyTo(bgr);
    layer_.create(size(), CV_8UC1);
    layer_.setTo(0);
    for (const Drop &drop : drops_) {
      const double heights = drop.y + t * 0.9 * drop.nearness; // per second
      const double y = (heights - std::floor(heights)) * 1.3 - 0.15;
      // Elsewhere in each round.
      const double place = drop.x + 0.618 * std::floor(heights);
      const double x = (place - std::floor(place)) * size().width;
      const double length = 0.03 * drop.nearness * size().height;
      cv::line(layer_, fixed_point(x, y * size().height),
               fixed_point(x + slant_ * length, y * size().height + length),
               35 + 20 * drop.nearness, drop.nearness > 2 && unit() > 0.7 ? 2 : 1, cv::LINE_AA,
               kShift);
    }
    cv::Mat light;
    cv::merge(std::array{ layer_, layer_, layer_ }, light);
    cv::add(bgr, light, bgr);
  }

private:
  static constexpr int kDrops = 250;
  struct Drop
  {
    double x;
    double y;
    int nearness; ///< 1 to 3
  };
  double slant_;
  std::vector<Drop> drops_;
  cv::Mat layer_;
};

class Leaves : public StirringFilm
{
public:
  Leaves(const cv::Mat &picture, cv::Size size, std::uint64_t seed)
      : StirringFilm(picture, size), random_(seed * 37 + 2), gusts_(random_, 0.1, 0.4)
  {
    for (Sway &sway : sways_) {
      const double blur = random_.uniform(12, 30) * unit();
      sway = { smooth_noise(random_, size, blur), smooth_noise(random_, size, blur),
               random_.uniform(0.3, 1.5), random_.uniform(0, kTau) };
    }
    amplitude_ = random_.uniform(1, 3) * unit();
    column_.create(size, CV_32FC1);
    row_.create(size, CV_32FC1);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        column_.at<float>(y, x) = static_cast<float>(x);
        row_.at<float>(y, x) = static_cast<float>(y);
      }
  }

protected:
  void draw(double t, cv::Mat &bgr) override
  {
    column_.copyTo(x_);
    row_.copyTo(y_);
    const double gust = std::clamp(0.7 + 0.3 * gusts_.at(t), 0.1, 1.3);
    for (const Sway &sway : sways_) {
      const double by = amplitude_ * gust / 1.6 * std::sin(kTau * sway.frequency * t + sway.phase);
      cv::scaleAdd(sway.x, by, x_, x_);
      cv::scaleAdd(sway.y, by * 0.5, y_, y_);
    }
    cv::remap(picture(), bgr, x_, y_, cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  }

private:
  struct Sway
  {
    cv::Mat x;
    cv::Mat y;
    double frequency = 0;
    double phase = 0;
  };
  Random random_;
  Tremor gusts_;
  std::array<Sway, 4> sways_;
  double amplitude_; ///< pixels
  cv::Mat column_;
  cv::Mat row_;
  cv::Mat x_;
  cv::Mat y_;
};

class Water : public StirringFilm
{
public:
  Water(const cv::Mat &picture, cv::Size size, std::uint64_t seed) : StirringFilm(picture, size)
  {
    Random random(seed * 41 + 3);
    const int top = size.height / 3;
    for (Wave &wave : waves_) {
      wave.cosine.create(size.height - top, size.width, CV_32FC1);
      wave.sine.create(wave.cosine.size(), CV_32FC1);
      const double number = kTau / (random.uniform(25, 90) * unit()); // radians per pixel, nearest
      const double angle = random.uniform(0, kTau);
      wave.frequency = random.uniform(0.5, 1.6);
      for (int y = 0; y < wave.cosine.rows; ++y) {
        // Waves are smaller towards the horizon.
        const double depth = wave.cosine.rows / (y + 0.15 * wave.cosine.rows);
        for (int x = 0; x < size.width; ++x) {
          const double phase
              = number
                * (x * depth * std::cos(angle) * 0.7 + wave.cosine.rows * depth * std::sin(angle));
          wave.cosine.at<float>(y, x) = static_cast<float>(std::cos(phase));
          wave.sine.at<float>(y, x) = static_cast<float>(std::sin(phase));
        }
      }
    }
    // In bgr
    this->picture()(cv::Rect(0, top, size.width, size.height - top)) = cv::Scalar(95, 70, 40);
  }

protected:
  void draw(double t, cv::Mat &bgr) override
  {
    picture().copyTo(bgr);
    cv::Mat height(waves_[0].cosine.size(), CV_32FC1, cv::Scalar(0));
    for (const Wave &wave : waves_) {
      cv::scaleAdd(wave.cosine, std::cos(kTau * wave.frequency * t), height, height);
      cv::scaleAdd(wave.sine, std::sin(kTau * wave.frequency * t), height, height);
    }
    cv::Mat sea = bgr.rowRange(bgr.rows - height.rows, bgr.rows);
    for (int y = 0; y < height.rows; ++y)
      for (int x = 0; x < height.cols; ++x) {
        const float h = height.at<float>(y, x) / std::sqrt(static_cast<float>(waves_.size()) / 2);
        const float glint = std::max(0.0F, h - 1.6F) * 260;
        for (int c = 0; c < 3; ++c) {
          uchar &code = sea.at<cv::Vec3b>(y, x)[c];
          code = cv::saturate_cast<uchar>(static_cast<float>(code) * (1 + 0.15F * h) + glint);
        }
      }
  }

private:
  struct Wave
  {
    cv::Mat cosine;
    cv::Mat sine;
    double frequency = 0;
  };
  std::array<Wave, 7> waves_;
};

class Crowd : public StirringFilm
{
public:
  Crowd(const cv::Mat &picture, cv::Size size, std::uint64_t seed) : StirringFilm(picture, size)
  {
    Random random(seed * 43 + 4);
    for (int i = 0; i < kPeople; ++i) {
      Person person{ random.uniform(-0.02, 1.02), 0.12 + 0.95 * (i + 0.5) / kPeople, {}, {}, {} };
      person.shirt = { random.uniform(30, 200), random.uniform(30, 200), random.uniform(30, 200) };
      person.skin = cv::Scalar(120, 150, 205) * random.uniform(0.5, 1.1);
      person.ways = { Tremor(random, 0.2, 1.2), Tremor(random, 0.5, 2) };
      people_.push_back(person);
    }
  }

protected:
  void draw(double t, cv::Mat &bgr) override
  {
    picture().copyTo(bgr);
    for (const Person &person : people_) { // farthest first
      const double radius = (4 + 7 * person.y) * unit();
      const double x = person.x * size().width + 0.6 * radius * person.ways[0].at(t);
      const double y
          = person.y * size().height - 0.6 * radius * std::max(0.0, person.ways[1].at(t) - 0.5);
      const auto ellipse = [&](double down, double wide, double high, const cv::Scalar &color) {
        cv::ellipse(bgr, fixed_point(x, y + down), cv::Size(fixed_point(wide), fixed_point(high)),
                    0, 0, 360, color, cv::FILLED, cv::LINE_AA, kShift);
      };
      ellipse(2.6 * radius, 1.7 * radius, 1.7 * radius, person.shirt);
      ellipse(0, 0.8 * radius, radius, person.skin);
    }
  }

private:
  static constexpr int kPeople = 220;
  struct Person
  {
    double x;
    double y;
    cv::Scalar shirt;
    cv::Scalar skin;
    std::vector<Tremor> ways; ///< sideways and up
  };
  std::vector<Person> people_;
};

class Grain : public StirringFilm
{
public:
  Grain(const cv::Mat &picture, cv::Size size, std::uint64_t seed, double sigma)
      : StirringFilm(picture, size), seed_(seed)
  {
    constexpr double kBlur = 0.8;
    Random random(seed * 47 + 5);
    noise_ = smooth_noise(random, size * 2, kBlur * std::max(1.0, unit())) * sigma;
    noise_.convertTo(noise_, CV_16SC1);
  }

protected:
  void draw(double t, cv::Mat &bgr) override
  {
    Random random(seed_ * 53 + static_cast<std::uint64_t>(std::llround(t * 1000)));
    const cv::Point corner(static_cast<int>(random.uniform(0, size().width)),
                           static_cast<int>(random.uniform(0, size().height)));
    const cv::Mat noise = noise_(cv::Rect(corner, size()));
    bgr.create(size(), CV_8UC3);
    for (int y = 0; y < bgr.rows; ++y) {
      const auto *from = picture().ptr<cv::Vec3b>(y);
      const auto *by = noise.ptr<short>(y);
      auto *to = bgr.ptr<cv::Vec3b>(y);
      for (int x = 0; x < bgr.cols; ++x)
        for (int c = 0; c < 3; ++c)
          to[x][c] = cv::saturate_cast<uchar>(from[x][c] + by[x]);
    }
  }

private:
  std::uint64_t seed_;
  cv::Mat noise_; ///< CV_16SC1, of which each frame shows another quarter
};

} // namespace

std::unique_ptr<CinemaFilm>
stirring_film(Stir stir, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
{
  switch (stir) {
  case Stir::rain:
    return std::make_unique<Rain>(picture, size, seed);
  case Stir::leaves:
    return std::make_unique<Leaves>(picture, size, seed);
  case Stir::water:
    return std::make_unique<Water>(picture, size, seed);
  case Stir::crowd:
    return std::make_unique<Crowd>(picture, size, seed);
  case Stir::grain:
    return std::make_unique<Grain>(picture, size, seed, 4);
  case Stir::coarse_grain:
    return std::make_unique<Grain>(picture, size, seed, 8);
  }
  return nullptr;
}

} // namespace quality
