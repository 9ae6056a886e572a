// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_events.h"

#include "camera_path.h"
#include "random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace quality {

namespace {

constexpr double kPeriod = 3;
constexpr double kBegin = 1.5; ///< of the first event, s
constexpr double kStands = 1.5;
constexpr double kGrows = 0.27;
constexpr double kFelt = 1.2;
constexpr double kAfter = 0.5;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// `picture` as seen by a camera that is (x, y) pixels off its middle; scaled so that `margin`
/// widths are left on each side.
void
show(const cv::Mat &picture, double x, double y, double margin, cv::Mat &bgr, cv::Size size)
{
  const double scale = std::min(picture.cols / (size.width * (1 + 2 * margin)),
                                picture.rows / (size.height * (1 + 2 * margin)));
  const double left = (picture.cols - scale * size.width) / 2 + scale * x;
  const double top = (picture.rows - scale * size.height) / 2 + scale * y;
  cv::warpAffine(picture, bgr, cv::Matx23d(scale, 0, left, 0, scale, top), size,
                 cv::INTER_AREA | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
}

class ShakenFilm : public CinemaFilm
{
public:
  ShakenFilm(ShakenEvent event, double pixels, const cv::Mat &picture, cv::Size size,
             std::uint64_t seed)
      : event_(event), amplitude_(pixels * size.width / 640), picture_(picture), size_(size),
        random_(seed * 7919 + static_cast<std::uint64_t>(event)), tremors_{
          Tremor(random_, 0.5, 5), Tremor(random_, 0.5, 5)
        }
  {
    for (auto &place : places_)
      place = { random_.uniform(0.2, 0.8) * size.width, random_.uniform(0.25, 0.75) * size.height };
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = seconds(time);
    const cv::Point2d shake(amplitude_ * tremors_[0].at(t), amplitude_ * tremors_[1].at(t));
    show(picture_, shake.x, shake.y, 0.06, bgr, size_);
    const auto index = static_cast<std::size_t>(
        std::clamp((t - kBegin) / kPeriod, 0.0, static_cast<double>(places_.size() - 1)));
    const double since = t - kBegin - kPeriod * static_cast<double>(index);
    Expected expected{ .events
                       = since >= 0 ? static_cast<int>(index) + 1 : static_cast<int>(index) };
    const cv::Rect2d box = event_ == ShakenEvent::walker
                               ? draw_walker(bgr, index, t, places_[index] - shake)
                               : draw_ball(bgr, since, places_[index] - shake);
    if (since >= 0 && since < kFelt) {
      expected.verdict = Verdict::felt;
      expected.cells = cells_of(box, size_);
    } else if (since >= 0 && since < kStands + 2 * kGrows + kAfter)
      expected.verdict = Verdict::allowed, expected.cells.set();
    return expected;
  }

private:
  cv::Rect2d draw_ball(cv::Mat &bgr, double since, cv::Point2d at) const
  {
    double share = 0;
    if (since >= 0 && since < kStands)
      share = event_ == ShakenEvent::disc ? 1 : std::min(1.0, since / kGrows);
    else if (since >= kStands)
      share = event_ == ShakenEvent::disc ? 0 : std::max(0.0, 1 - (since - kStands) / kGrows);
    const double radius
        = share * size_.width * (event_ == ShakenEvent::large_fireball ? 0.15 : 0.08);
    constexpr int kShift = 4;
    const cv::Scalar color
        = event_ == ShakenEvent::disc ? cv::Scalar(60, 60, 220) : cv::Scalar(90, 200, 255);
    if (radius > 0.5)
      cv::circle(bgr, cv::Point(cvRound(at.x * (1 << kShift)), cvRound(at.y * (1 << kShift))),
                 cvRound(radius * (1 << kShift)), color, cv::FILLED, cv::LINE_AA, kShift);
    return { at.x - radius, at.y - radius, 2 * radius, 2 * radius };
  }

  /// A figure a third of the picture high that stands, and walks a fifth of the width in 1.5 s.
  cv::Rect2d draw_walker(cv::Mat &bgr, std::size_t index, double t, cv::Point2d at) const
  {
    const double since = t - kBegin - kPeriod * static_cast<double>(index);
    const double walked = std::clamp(since, 0.0, kStands) / kStands;
    const double direction = at.x < size_.width / 2.0 ? 1 : -1;
    const double height = size_.height / 3.0;
    const cv::Point2d foot(at.x + direction * 0.2 * size_.width * walked, at.y + height / 2);
    const double swing = since > 0 && since < kStands ? 0.18 * height * std::sin(10 * since) : 0;
    constexpr int kShift = 4;
    const auto fixed = [](double x, double y) {
      return cv::Point(cvRound(x * (1 << kShift)), cvRound(y * (1 << kShift)));
    };
    const int limb = std::max(1, cvRound(0.12 * height));
    const cv::Scalar coat(40, 40, 50);
    const double hip = foot.y - 0.45 * height;
    for (const double side : { -1.0, 1.0 })
      cv::line(bgr, fixed(foot.x, hip), fixed(foot.x + side * swing, foot.y), coat, limb,
               cv::LINE_AA, kShift);
    cv::ellipse(
        bgr, fixed(foot.x, foot.y - 0.62 * height),
        cv::Size(cvRound(0.14 * height * (1 << kShift)), cvRound(0.24 * height * (1 << kShift))), 0,
        0, 360, coat, cv::FILLED, cv::LINE_AA, kShift);
    cv::circle(bgr, fixed(foot.x, foot.y - 0.92 * height), cvRound(0.09 * height * (1 << kShift)),
               cv::Scalar(150, 170, 215), cv::FILLED, cv::LINE_AA, kShift);
    return { foot.x - 0.18 * height, foot.y - height, 0.36 * height, height };
  }

  ShakenEvent event_;
  double amplitude_; ///< pixels
  cv::Mat picture_;
  cv::Size size_;
  Random random_;
  std::array<Tremor, 2> tremors_;
  std::array<cv::Point2d, 3> places_;
};

class OverlayFilm : public CinemaFilm
{
public:
  OverlayFilm(Overlay overlay, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
      : overlay_(overlay), picture_(picture), size_(size),
        random_(seed * 104729 + static_cast<std::uint64_t>(overlay)),
        speed_(random_.uniform(0.02, 0.05) * size.width), phase_(random_.uniform(0, 6))
  {
    cv::resize(picture, still_, size, 0, 0, cv::INTER_AREA);
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = seconds(time);
    const bool there = t >= kThere;
    const double pan = speed_ * 2 * std::sin(0.5 * t + phase_);
    if (overlay_ == Overlay::growing_title) {
      bgr.create(size_, CV_8UC3);
      bgr = cv::Scalar::all(0);
      if (there)
        write(bgr, "THE LONG WAY", { size_.width / 2.0, size_.height / 2.0 },
              0.1 * size_.height * (1 + (t - kThere) / 16));
    } else if (overlay_ == Overlay::logo) {
      show(picture_, pan, 0, 0.12, bgr, size_);
      if (there)
        write(bgr, "CH4", { 0.88 * size_.width, 0.1 * size_.height }, 0.08 * size_.height);
    } else {
      still_.copyTo(bgr);
      if (there) {
        const cv::Rect inset(cvRound(0.62 * size_.width), cvRound(0.08 * size_.height),
                             cvRound(0.3 * size_.width), cvRound(0.3 * size_.height));
        cv::Mat small;
        show(picture_, pan / 2, 0, 0.3, small, inset.size());
        small.copyTo(bgr(inset));
      }
    }
    return there && t < kThere + 1 ? anything() : Expected{};
  }

private:
  static constexpr double kThere = 1;

  static void write(cv::Mat &bgr, const char *text, cv::Point2d middle, double height)
  {
    // Drawn large and shrunk, so that it grows without steps.
    constexpr double kDrawn = 120;
    int below = 0;
    const double scale = cv::getFontScaleFromHeight(cv::FONT_HERSHEY_DUPLEX, 120, 12);
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, scale, 12, &below);
    cv::Mat mask(size.height + 2 * below, size.width + 2 * below, CV_8UC1, cv::Scalar(0));
    cv::putText(mask, text, { below, below + size.height }, cv::FONT_HERSHEY_DUPLEX, scale, 255, 12,
                cv::LINE_AA);
    const double by = height / kDrawn;
    cv::GaussianBlur(mask, mask, {}, 0.4 / by);
    cv::Mat alpha;
    cv::warpAffine(
        mask, alpha,
        cv::Matx23d(by, 0, middle.x - by * mask.cols / 2, 0, by, middle.y - by * mask.rows / 2),
        bgr.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    cv::Mat rest;
    cv::subtract(cv::Scalar::all(235), bgr, rest);
    cv::merge(std::array{ alpha, alpha, alpha }, alpha);
    cv::multiply(rest, alpha, rest, 1.0 / 255);
    cv::add(bgr, rest, bgr);
  }

  Overlay overlay_;
  cv::Mat picture_;
  cv::Mat still_;
  cv::Size size_;
  Random random_;
  double speed_;
  double phase_;
};

} // namespace

std::unique_ptr<CinemaFilm>
shaken_film(ShakenEvent event, double pixels, const cv::Mat &picture, cv::Size size,
            std::uint64_t seed)
{
  return std::make_unique<ShakenFilm>(event, pixels, picture, size, seed);
}

std::unique_ptr<CinemaFilm>
overlay_film(Overlay overlay, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
{
  return std::make_unique<OverlayFilm>(overlay, picture, size, seed);
}

} // namespace quality
