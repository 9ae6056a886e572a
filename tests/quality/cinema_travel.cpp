// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_travel.h"

#include "layered_scene.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace quality {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

/// A person or a thing.
struct Actor
{
  double start = 0; ///< appears, or begins to walk
  double stop = 0;
  double x = 0; ///< m, of the middle, at the start
  double y = 0; ///< of the top
  double z = 0;
  double width = 0;
  double height = 0;
  double speed_x = 0; ///< m/s
  double speed_z = 0;
  std::array<cv::Scalar, 3> colors{};

  double walked(double t) const
  {
    return std::clamp(t, start, stop) - start;
  }
};

constexpr double kSpriteTexels = 320; ///< height

void
draw_person(const Actor &actor, double t, cv::Mat &sprite)
{
  const double unit = kSpriteTexels / actor.height; // texels per meter
  const double swing
      = t > actor.start && t < actor.stop ? 0.28 * std::sin(kTau * 0.9 * actor.walked(t)) : 0.06;
  const auto point = [&](double x, double y) {
    return cv::Point(static_cast<int>(std::lround((actor.width / 2 + x) * unit)),
                     static_cast<int>(std::lround(y * unit)));
  };
  const auto thick = [&](double width) {
    return static_cast<int>(std::lround(width * unit));
  };
  for (const double side : { -1.0, 1.0 }) {
    cv::line(sprite, point(0, 0.85), point(side * swing, 1.65), actor.colors[1], thick(0.15),
             cv::LINE_AA);
    cv::line(sprite, point(side * 0.15, 0.4), point(side * 0.2 - side * swing / 2, 0.85),
             actor.colors[0].mul({ 0.85, 0.85, 0.85, 1 }), thick(0.09), cv::LINE_AA);
  }
  cv::ellipse(sprite, point(0, 0.6), { thick(0.19), thick(0.34) }, 0, 0, 360, actor.colors[0],
              cv::FILLED, cv::LINE_AA);
  cv::ellipse(sprite, point(0, 0.14), { thick(0.09), thick(0.12) }, 0, 0, 360, actor.colors[2],
              cv::FILLED, cv::LINE_AA);
}

void
draw_thing(const Actor &actor, cv::Mat &sprite)
{
  const cv::Point middle(sprite.cols / 2, sprite.rows / 2);
  const cv::Size half(sprite.cols / 2 - 4, sprite.rows / 2 - 4);
  cv::ellipse(sprite, middle, half, 0, 0, 360, actor.colors[0], cv::FILLED, cv::LINE_AA);
  cv::ellipse(sprite, middle, half / 2, 0, 0, 360, actor.colors[1], cv::FILLED, cv::LINE_AA);
}

class TravellingFilm : public CinemaFilm
{
public:
  TravellingFilm(const TravelSettings &settings, const std::vector<cv::Mat> &textures)
      : settings_(settings), path_(settings.travel, settings.seed)
  {
    make_layers(textures);
    if (settings.mover != Mover::none)
      make_actors();
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = std::chrono::duration<double>(time).count();
    const Pose pose = path_.at(t);
    bgr.create(settings_.size, CV_8UC3);
    bgr.setTo(cv::Scalar::all(128));
    const Actor *active = nullptr;
    cv::Mat own; // alpha of what is active
    double all = 0;
    cv::Rect own_part;
    std::vector<const Actor *> waiting; // nearest first
    for (const Actor &actor : actors_)
      waiting.push_back(&actor);
    std::ranges::sort(waiting,
                      [&](const Actor *a, const Actor *b) { return z_of(*a, t) < z_of(*b, t); });
    const auto draw_until = [&](double z) {
      for (; !waiting.empty() && z_of(*waiting.back(), t) > z; waiting.pop_back()) {
        const Actor &actor = *waiting.back();
        const cv::Rect part = draw_actor(actor, t, pose, bgr);
        if (t >= actor.start && t < actor.stop + kAfter && !part.empty()
            && (!active || actor.start > active->start)) {
          active = &actor;
          own_part = part;
          cv::extractChannel(warped_, own, 3);
          all = cv::sum(own)[0];
        }
      }
    };
    for (const Card &layer : layers_) {
      draw_until(layer.z);
      const cv::Rect part = seen_part(layer, pose, settings_.size);
      if (part.empty())
        continue;
      warp(layer, pose, settings_.size, part, warped_);
      compose(warped_, bgr(part));
      if (const cv::Rect both = part & own_part; !both.empty()) {
        cv::Mat through;
        cv::extractChannel(warped_(both - part.tl()), through, 3);
        cv::bitwise_not(through, through);
        cv::Mat hidden = own(both - own_part.tl());
        cv::multiply(hidden, through, hidden, 1 / 255.0);
      }
    }
    draw_until(-1e9);
    return expected(t, pose, active, all > 0 ? cv::sum(own)[0] / all : 0);
  }

private:
  static constexpr double kLane = 1.1;  ///< m, to either side of a camera that goes forward
  static constexpr double kAfter = 2.2; ///< s, in which a change may still be felt
  static constexpr double kOnset = 0.5; ///< s, in which something that has appeared should be felt

  bool is_forward() const
  {
    return settings_.travel == Travel::dolly || settings_.travel == Travel::walk;
  }

  double z_of(const Actor &actor, double t) const
  {
    return actor.z + actor.speed_z * actor.walked(t);
  }

  std::vector<double> depths(Random &random) const
  {
    if (!settings_.depths.empty())
      return settings_.depths;
    std::vector<double> all = is_forward() ? std::vector<double>{ 60, 34, 24, 17, 12, 6 }
                                           : std::vector<double>{ 25, 14, 9, 6 };
    for (double &depth : all)
      depth *= random.uniform(0.9, 1.1);
    if (!is_forward() && settings_.seed % 2 == 1)
      all.push_back(random.uniform(2.6, 3.2));
    return all;
  }

  void make_layers(const std::vector<cv::Mat> &textures)
  {
    Random random(settings_.seed * 104729 + 1);
    auto all = depths(random);
    std::ranges::sort(all, std::greater());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool nearest = i + 1 == all.size() && all.size() > 4;
      const Cover cover = i == 0 || !settings_.depths.empty() ? Cover::all
                          : nearest                           ? Cover::trunks
                          : i % 2 == 1                        ? Cover::blocks
                                                              : Cover::bushes;
      const auto texture
          = static_cast<std::size_t>(random.uniform(0, static_cast<double>(textures.size())));
      layers_.push_back(make_layer(all[i], cover, is_forward() ? kLane : 0, path_,
                                   std::chrono::duration<double>(kCinemaLength).count(),
                                   settings_.size, textures[texture], random));
    }
  }

  /// Within ± `most`; not in the way of a camera that goes forward.
  double aside(Random &random, double most) const
  {
    const double right = random.uniform(is_forward() ? 0.16 : 0, most);
    return random.uniform(-1, 1) < 0 ? -right : right;
  }

  void make_actors()
  {
    Random random(settings_.seed * 15485863 + 2);
    const bool appears = settings_.mover == Mover::appears;
    for (const double begin : { 2.0, 5.2, 8.4 }) {
      Actor actor;
      actor.start = begin + random.uniform(0, 0.4);
      actor.stop = actor.start + (appears ? kOnset : 2.2);
      const double middle = (actor.start + actor.stop) / 2;
      const Pose pose = path_.at(middle);
      const double distance = is_forward() ? random.uniform(5.5, 8) : random.uniform(4.2, 5.8);
      actor.z = pose.z + distance;
      const std::array<cv::Scalar, 5> bright{
        cv::Scalar(40, 40, 200, 255), cv::Scalar(225, 225, 225, 255), cv::Scalar(150, 60, 20, 255),
        cv::Scalar(30, 180, 220, 255), cv::Scalar(30, 30, 30, 255)
      };
      const auto color = [&] {
        return bright[static_cast<std::size_t>(random.uniform(0, 5))];
      };
      actor.colors = { color(), color(), cv::Scalar(120, 150, 205, 255) };
      if (appears) {
        actor.width = actor.height = distance * random.uniform(0.09, 0.13);
        actor.x = pose.x + (aside(random, 0.35) + pose.yaw) * distance;
        actor.y = pose.y + random.uniform(-0.2, 0.1) * distance;
      } else {
        actor.height = 1.75;
        actor.width = 1;
        actor.y = -0.15;
        // In view from start to stop, then out of the camera's way.
        for (int i = 0; i < 100; ++i) {
          const double speed = random.uniform(0.8, 1.5) * (random.uniform(-1, 1) < 0 ? -1 : 1);
          (settings_.mover == Mover::heading ? actor.speed_z : actor.speed_x) = speed;
          const double right = (settings_.mover == Mover::heading ? aside(random, 0.25)
                                                                  : random.uniform(-0.25, 0.25))
                               + pose.yaw;
          actor.z = pose.z + distance - actor.speed_z * (middle - actor.start);
          actor.x = pose.x + right * distance - actor.speed_x * (middle - actor.start);
          const auto in_view = [&](double t) {
            const double x = middle_of(actor, t).x / settings_.size.width;
            return x > 0.08 && x < 0.92;
          };
          const double end = actor.x + actor.speed_x * actor.walked(actor.stop);
          if (in_view(actor.start) && in_view(actor.stop)
              && (!is_forward() || std::abs(end) > kLane - 0.2))
            break;
        }
      }
      actors_.push_back(actor);
    }
  }

  cv::Point2d middle_of(const Actor &actor, double t) const
  {
    return project(path_.at(t), actor.x + actor.speed_x * actor.walked(t),
                   actor.y + actor.height / 2, z_of(actor, t), settings_.size);
  }

  /// In pixels of the frame, inside or not.
  cv::Rect2d box_of(const Actor &actor, double t, const Pose &pose) const
  {
    const double x = actor.x + actor.speed_x * actor.walked(t) - actor.width / 2;
    const double z = z_of(actor, t);
    cv::Point2d low(1e9, 1e9);
    cv::Point2d high(-1e9, -1e9);
    for (const double right : { 0.0, actor.width })
      for (const double down : { 0.0, actor.height }) {
        const cv::Point2d corner = project(pose, x + right, actor.y + down, z, settings_.size);
        low = { std::min(low.x, corner.x), std::min(low.y, corner.y) };
        high = { std::max(high.x, corner.x), std::max(high.y, corner.y) };
      }
    return { low, high };
  }

  /// Returns the part of the frame that it is in; warped_ is what was drawn there.
  cv::Rect draw_actor(const Actor &actor, double t, const Pose &pose, cv::Mat &bgr)
  {
    constexpr double kFadeIn = 0.1;
    const bool appears = settings_.mover == Mover::appears;
    const double z = z_of(actor, t);
    if (appears && t < actor.start)
      return {};
    Card card;
    card.density = kSpriteTexels / actor.height;
    card.x = actor.x + actor.speed_x * actor.walked(t) - actor.width / 2;
    card.y = actor.y;
    card.z = z;
    cv::Mat &sprite = card.texture;
    sprite = cv::Mat(static_cast<int>(kSpriteTexels),
                     static_cast<int>(std::ceil(actor.width * card.density)), CV_8UC4,
                     cv::Scalar::all(0));
    const cv::Rect part = seen_part(card, pose, settings_.size);
    if (part.empty())
      return {};
    if (appears)
      draw_thing(actor, sprite);
    else
      draw_person(actor, t, sprite);
    const double texels = card.density * (z - pose.z) / settings_.size.width;
    cv::GaussianBlur(sprite, sprite, {}, std::max(0.3, kAperture * texels));
    if (appears)
      sprite *= std::clamp((t - actor.start) / kFadeIn + 0.34, 0.0, 1.0);
    warp(card, pose, settings_.size, part, warped_);
    compose(warped_, bgr(part));
    return part;
  }

  Expected expected(double t, const Pose &pose, const Actor *active, double visible)
  {
    constexpr double kMostly = 0.5;
    Expected expected;
    expected.events = events_;
    if (!active)
      return expected;
    const cv::Rect2d box = box_of(*active, t, pose);
    const cv::Rect2d seen = clipped(box, settings_.size);
    const bool plain = visible >= kMostly && seen.area() >= kMostly * box.area();
    const int index = static_cast<int>(active - actors_.data());
    if (last_ != index && plain && t - active->start < 0.1) {
      last_ = index;
      ++events_;
    }
    expected.events = events_;
    expected.cells = cells_of(box, settings_.size);
    expected.verdict = plain && t < active->stop ? Verdict::felt : Verdict::allowed;
    return expected;
  }

  TravelSettings settings_;
  CameraPath path_;
  std::vector<Card> layers_; ///< farthest first
  std::vector<Actor> actors_;
  cv::Mat warped_;
  int events_ = 0;
  int last_ = -1; ///< actor whose event has been counted
};

} // namespace

std::unique_ptr<CinemaFilm>
travelling_film(const TravelSettings &settings, const std::vector<cv::Mat> &textures)
{
  return std::make_unique<TravellingFilm>(settings, textures);
}

} // namespace quality
