// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "tactile/synthetic_film.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace quality {

using tactile::Time;

/// An I420 frame: BT.601, 8 bits, limited range. Width and height are even.
class Frame
{
public:
  explicit Frame(cv::Size size);

  cv::Size size() const;
  saliency::FrameView view() const;
  /// The same in CV_8UC3 BGR.
  const cv::Mat &bgr() const;

  void fill(tactile::Color color);
  void draw(const cv::Mat &bgr);
  void draw(const tactile::Ball &ball);
  void add_noise(const tactile::SensorNoise &noise, Time time);

private:
  tactile::SamplePlane plane(int component);

  cv::Mat i420_; ///< CV_8UC1, 3/2 height
  mutable cv::Mat bgr_;
};

/// A film with ground truth.
class LabeledFilm
{
public:
  LabeledFilm() = default;
  virtual ~LabeledFilm() = default;
  LabeledFilm(const LabeledFilm &) = delete;
  LabeledFilm &operator=(const LabeledFilm &) = delete;

  /// Draws the picture at `time` ≥ 0 and returns the balls in it. Times never go back.
  virtual std::vector<tactile::Ball> draw(Time time, Frame &frame) = 0;

  /// Whether a viewer could see a ball appear at `time`: the picture is not dark, and there is no
  /// cut.
  virtual bool visible(Time) const
  {
    return true;
  }
};

/// The paper's two films: balls on a plain background.
std::unique_ptr<LabeledFilm> ball_film(const tactile::FilmSettings &settings);

/// Changes of the whole picture that are no events.
enum class Disturbance
{
  still,        ///< nothing
  flicker,      ///< every frame is brighter or darker by up to 5 %
  fade,         ///< out to black and in again, 0.5–2 s each
  cut,          ///< another picture every 2–3.5 s
  pan,          ///< 1–4 pixels of 640 in 1/30 s, one speed and direction for 3 s
  pan_and_rest, ///< alternates rests and pans of 1–2.5 s, accelerating within 0.2 s
  zoom,         ///< in and out, 0.2–0.6 % in 1/30 s
  shake,        ///< hand-held: ± 4 pixels of 640 and ± 0.2° (σ), 0.5–5 Hz
};

const char *name(Disturbance disturbance);

/// A picture so disturbed, scaled to fill twice the frame's width and height, of which the frame
/// shows the middle half; with or without a ball that appears, rests, and is elsewhere at once.
/// Cuts go to the next picture.
std::unique_ptr<LabeledFilm> disturbed_film(Disturbance disturbance, std::vector<cv::Mat> pictures,
                                            cv::Size size, bool ball, std::uint64_t seed,
                                            double ball_size = 1.0 / 16);

/// A still picture. From second 1 to 2 another moves in from the left until it covers `share` of
/// the frame. No balls. Maps should be active during that second: half of the first two.
std::unique_ptr<LabeledFilm> entering_film(cv::Mat picture, cv::Mat object, double share);

} // namespace quality
