// SPDX-License-Identifier: LGPL-2.1-or-later
#include "films.h"

#include "random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace quality {

namespace {

using Seconds = std::chrono::duration<double>;

/// Y', Cb, Cr codes (BT.601, limited range).
std::array<std::uint8_t, 3>
codes(tactile::Color color)
{
  const double r = color.red;
  const double g = color.green;
  const double b = color.blue;
  const auto code = [](double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  };
  const double luma = 0.299 * r + 0.587 * g + 0.114 * b;
  return { code(16 + luma * 219 / 255), code(128 + (b - luma) / 1.772 * 224 / 255),
           code(128 + (r - luma) / 1.402 * 224 / 255) };
}

class BallFilm : public LabeledFilm
{
public:
  explicit BallFilm(const tactile::FilmSettings &settings) : film_(settings)
  {
  }

  std::vector<tactile::Ball> draw(Time time, Frame &frame) override
  {
    frame.fill(tactile::SyntheticFilm::kBackground);
    auto balls = film_.balls_at(time, frame.size().width, frame.size().height);
    for (const auto &ball : balls)
      frame.draw(ball);
    return balls;
  }

private:
  tactile::SyntheticFilm film_;
};

/// The camera's position relative to the picture's center, in pixels of the frame and radians.
struct Camera
{
  double x = 0;
  double y = 0;
  double scale = 1;
  double angle = 0;
};

/// A part of a film from `begin` on.
struct Stretch
{
  double begin = 0;
  double length = 0;
  double from_x = 0;
  double from_y = 0;
  double speed_x = 0; ///< pixels per second
  double speed_y = 0;
  double from_scale = 0; ///< logarithm
  double scale_speed = 0;
  std::size_t picture = 0;
};

class DisturbedFilm : public LabeledFilm
{
public:
  DisturbedFilm(Disturbance disturbance, std::vector<cv::Mat> pictures, cv::Size size, bool ball,
                std::uint64_t seed, double ball_size)
      : disturbance_(disturbance), random_(seed * 977 + static_cast<std::uint64_t>(disturbance)),
        ball_(ball), balls_({ .pattern = tactile::FilmPattern::static_motion,
                              .seed = seed,
                              .balls = 1,
                              .ball_size = ball_size })
  {
    for (auto &picture : pictures) {
      cv::Mat scaled;
      cv::resize(picture, scaled, size * 2, 0, 0,
                 picture.cols > 2 * size.width ? cv::INTER_AREA : cv::INTER_CUBIC);
      pictures_.push_back(scaled);
    }
    unit_ = size.width / 640.0;
    for (auto &wave : waves_)
      wave
          = { random_.normal(), random_.uniform(0.5, 5), random_.uniform(0, 2 * std::numbers::pi) };
    stretches_.push_back(next_stretch({}));
  }

  std::vector<tactile::Ball> draw(Time time, Frame &frame) override
  {
    const double t = Seconds(time).count();
    while (t >= stretches_.back().begin + stretches_.back().length)
      stretches_.push_back(next_stretch(stretches_.back()));
    const Camera camera = camera_at(t);
    const cv::Mat &picture = pictures_[stretches_.back().picture % pictures_.size()];
    const cv::Size size = frame.size();

    const double cosine = std::cos(camera.angle) / camera.scale;
    const double sine = std::sin(camera.angle) / camera.scale;
    const double middle_x = picture.cols / 2.0 + camera.x;
    const double middle_y = picture.rows / 2.0 + camera.y;
    const cv::Matx23d to_picture(
        cosine, -sine, middle_x - cosine * size.width / 2 + sine * size.height / 2, sine, cosine,
        middle_y - sine * size.width / 2 - cosine * size.height / 2);
    cv::warpAffine(picture, shown_, to_picture, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REFLECT_101);
    const double gain = gain_at(t);
    if (gain != 1)
      shown_.convertTo(shown_, -1, gain);
    frame.draw(shown_);
    if (!ball_)
      return {};
    auto balls = balls_.balls_at(time, size.width, size.height);
    for (auto ball : balls) {
      for (auto *code : { &ball.color.red, &ball.color.green, &ball.color.blue })
        *code = cv::saturate_cast<std::uint8_t>(*code * gain);
      frame.draw(ball);
    }
    return balls;
  }

  bool visible(Time time) const override
  {
    constexpr double kBefore = 0.35;
    constexpr double kAfter = 0.1;
    const double t = Seconds(time).count();
    if (disturbance_ == Disturbance::fade)
      return fade_at(t) >= 0.4 && fade_at(t + kBefore) >= 0.4;
    if (disturbance_ == Disturbance::cut) {
      // Known only for times before the drawn frame.
      return std::ranges::none_of(stretches_, [t](const Stretch &stretch) {
        return stretch.begin > 0 && t > stretch.begin - kBefore && t < stretch.begin + kAfter;
      });
    }
    return true;
  }

private:
  struct Wave
  {
    double amplitude;
    double frequency;
    double phase;
  };
  static constexpr int kWaves = 6; ///< per axis: x, y, angle

  Stretch next_stretch(const Stretch &last)
  {
    Stretch next;
    next.begin = last.begin + last.length;
    next.picture = last.picture;
    next.from_x = last.from_x + last.speed_x * last.length;
    next.from_y = last.from_y + last.speed_y * last.length;
    next.from_scale = last.from_scale + last.scale_speed * last.length;
    switch (disturbance_) {
    case Disturbance::cut:
      next.length = random_.uniform(2, 3.5);
      next.picture = last.length > 0 ? last.picture + 1 : 0;
      break;
    case Disturbance::pan:
      next.length = 3;
      set_speed(next);
      break;
    case Disturbance::pan_and_rest:
      next.length = random_.uniform(1, 2.5);
      if (last.length > 0 && last.speed_x == 0)
        set_speed(next);
      break;
    case Disturbance::zoom:
      next.length = random_.uniform(1.5, 3);
      next.scale_speed = random_.uniform(0.002, 0.006) * 30 * (last.scale_speed > 0 ? -1 : 1);
      // The frame stays in the picture, and pixels are not magnified too much.
      if (const double end = next.from_scale + next.scale_speed * next.length;
          end < -0.4 || end > 0.7)
        next.length = std::max(0.2, ((end < 0 ? -0.4 : 0.7) - next.from_scale) / next.scale_speed);
      break;
    case Disturbance::fade:
      next.length = random_.uniform(0.5, 2);
      break;
    default:
      next.length = 1e9;
    }
    return next;
  }

  void set_speed(Stretch &stretch)
  {
    const double speed = random_.uniform(1, 4) * 30 * unit_;
    const double angle = random_.uniform(0, 2 * std::numbers::pi);
    stretch.speed_x = speed * std::cos(angle);
    stretch.speed_y = speed * std::sin(angle);
  }

  Camera camera_at(double t) const
  {
    const Stretch &now = stretches_.back();
    const double elapsed = t - now.begin;
    Camera camera;
    camera.scale = std::exp(now.from_scale + now.scale_speed * elapsed);
    camera.x = now.from_x + now.speed_x * elapsed;
    camera.y = now.from_y + now.speed_y * elapsed;
    if (disturbance_ == Disturbance::pan_and_rest) {
      // Changes speed within 0.2 s.
      constexpr double kRamp = 0.2;
      const Stretch before = stretches_.size() > 1 ? stretches_[stretches_.size() - 2] : Stretch{};
      if (elapsed < kRamp) {
        const double share = elapsed / kRamp;
        const double delta = (1 - share) * (1 - share) * kRamp / 2;
        camera.x += (now.speed_x - before.speed_x) * delta;
        camera.y += (now.speed_y - before.speed_y) * delta;
      }
    }
    if (disturbance_ == Disturbance::shake) {
      camera.x += 4 * unit_ * wave(0, t);
      camera.y += 4 * unit_ * wave(1, t);
      camera.angle += 0.2 * std::numbers::pi / 180 * wave(2, t);
    }
    return camera;
  }

  /// A signal of variance 1.
  double wave(int axis, double t) const
  {
    double sum = 0;
    double power = 0;
    for (int i = 0; i < kWaves; ++i) {
      const Wave &w = waves_[static_cast<std::size_t>(axis * kWaves + i)];
      sum += w.amplitude * std::sin(2 * std::numbers::pi * w.frequency * t + w.phase);
      power += w.amplitude * w.amplitude / 2;
    }
    return sum / std::sqrt(power);
  }

  double gain_at(double t)
  {
    if (disturbance_ == Disturbance::flicker)
      return random_.uniform(0.95, 1.05);
    return disturbance_ == Disturbance::fade ? fade_at(t) : 1.0;
  }

  /// Parts alternate: full, fading out, black, fading in.
  double fade_at(double t) const
  {
    std::size_t i = stretches_.size() - 1;
    while (i > 0 && t < stretches_[i].begin)
      --i;
    const double share
        = std::min(1.0, (t - stretches_[i].begin) / std::max(stretches_[i].length, 1e-9));
    switch (i % 4) {
    case 0:
      return 1;
    case 1:
      return 1 - share;
    case 2:
      return 0;
    default:
      return share;
    }
  }

  Disturbance disturbance_;
  Random random_;
  bool ball_;
  tactile::SyntheticFilm balls_;
  std::vector<cv::Mat> pictures_;
  double unit_ = 1; ///< pixels of the frame per pixel of 640
  std::array<Wave, static_cast<std::size_t>(3 * kWaves)> waves_{};
  std::vector<Stretch> stretches_;
  cv::Mat shown_;
};

class EnteringFilm : public LabeledFilm
{
public:
  EnteringFilm(cv::Mat picture, cv::Mat object, double share)
      : picture_(std::move(picture)), object_(std::move(object)), share_(share)
  {
  }

  std::vector<tactile::Ball> draw(Time time, Frame &frame) override
  {
    constexpr double kHeight = 0.8; // of the frame
    const cv::Size size = frame.size();
    cv::resize(picture_, shown_, size, 0, 0, cv::INTER_AREA);
    const cv::Size whole(static_cast<int>(size.width * share_ / kHeight),
                         static_cast<int>(size.height * kHeight));
    const double in = std::clamp(Seconds(time).count() - 1, 0.0, 1.0);
    if (const int width = static_cast<int>(in * whole.width); width > 0) {
      cv::Mat object;
      cv::resize(object_, object, size, 0, 0, cv::INTER_AREA);
      object(cv::Rect(whole.width - width, 0, width, whole.height))
          .copyTo(shown_(cv::Rect(0, (size.height - whole.height) / 2, width, whole.height)));
    }
    frame.draw(shown_);
    return {};
  }

private:
  cv::Mat picture_;
  cv::Mat object_;
  double share_;
  cv::Mat shown_;
};

} // namespace

Frame::Frame(cv::Size size) : i420_(size.height * 3 / 2, size.width, CV_8UC1)
{
}

cv::Size
Frame::size() const
{
  return { i420_.cols, i420_.rows * 2 / 3 };
}

tactile::SamplePlane
Frame::plane(int component)
{
  const cv::Size size = this->size();
  if (component == 0)
    return { i420_.data, size.width, 1, size.width, size.height, 1, 1 };
  const int half_width = size.width / 2;
  const int half_height = size.height / 2;
  std::uint8_t *chroma
      = i420_.data + static_cast<std::ptrdiff_t>(size.width) * size.height
        + (component == 2 ? static_cast<std::ptrdiff_t>(half_width) * half_height : 0);
  return { chroma, half_width, 1, half_width, half_height, 2, 2 };
}

saliency::FrameView
Frame::view() const
{
  saliency::FrameView view;
  view.width = size().width;
  view.height = size().height;
  view.matrix = saliency::kBt601;
  for (int i = 0; i < 3; ++i) {
    const auto plane = const_cast<Frame *>(this)->plane(i);
    view.components[static_cast<std::size_t>(i)]
        = { plane.data, plane.row_stride, plane.pixel_stride, plane.width, plane.height };
  }
  return view;
}

const cv::Mat &
Frame::bgr() const
{
  cv::cvtColor(i420_, bgr_, cv::COLOR_YUV2BGR_I420);
  return bgr_;
}

void
Frame::fill(tactile::Color color)
{
  const auto values = codes(color);
  for (int i = 0; i < 3; ++i) {
    const auto to = plane(i);
    std::fill_n(to.data, to.row_stride * to.height, values[static_cast<std::size_t>(i)]);
  }
}

void
Frame::draw(const cv::Mat &bgr)
{
  cv::cvtColor(bgr, i420_, cv::COLOR_BGR2YUV_I420);
}

void
Frame::draw(const tactile::Ball &ball)
{
  const auto values = codes(ball.color);
  for (int i = 0; i < 3; ++i)
    tactile::draw_ball(plane(i), ball, values[static_cast<std::size_t>(i)]);
}

void
Frame::add_noise(const tactile::SensorNoise &noise, Time time)
{
  for (int i = 0; i < 3; ++i)
    noise.add(plane(i), i, time);
}

std::unique_ptr<LabeledFilm>
ball_film(const tactile::FilmSettings &settings)
{
  return std::make_unique<BallFilm>(settings);
}

const char *
name(Disturbance disturbance)
{
  switch (disturbance) {
  case Disturbance::still:
    return "still";
  case Disturbance::flicker:
    return "flicker";
  case Disturbance::fade:
    return "fade";
  case Disturbance::cut:
    return "cut";
  case Disturbance::pan:
    return "pan";
  case Disturbance::pan_and_rest:
    return "pan and rest";
  case Disturbance::zoom:
    return "zoom";
  case Disturbance::shake:
    return "shake";
  }
  return "";
}

std::unique_ptr<LabeledFilm>
entering_film(cv::Mat picture, cv::Mat object, double share)
{
  return std::make_unique<EnteringFilm>(std::move(picture), std::move(object), share);
}

std::unique_ptr<LabeledFilm>
disturbed_film(Disturbance disturbance, std::vector<cv::Mat> pictures, cv::Size size, bool ball,
               std::uint64_t seed, double ball_size)
{
  return std::make_unique<DisturbedFilm>(disturbance, std::move(pictures), size, ball, seed,
                                         ball_size);
}

} // namespace quality
