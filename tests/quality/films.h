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

/// A frame as decoders deliver it: I420, BT.601, 8 bits, limited range. Width and height are even.
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

/// A film in which the events are known.
class LabeledFilm
{
public:
  LabeledFilm() = default;
  virtual ~LabeledFilm() = default;
  LabeledFilm(const LabeledFilm &) = delete;
  LabeledFilm &operator=(const LabeledFilm &) = delete;

  /// Draws the picture at `time` ≥ 0 and returns the balls in it. Times never go back.
  virtual std::vector<tactile::Ball> draw(Time time, Frame &frame) = 0;

  /// Whether somebody who looks on could tell that a ball appears at `time`: it is not dark then,
  /// nor does the shot change.
  virtual bool visible(Time) const
  {
    return true;
  }
};

/// The paper's two films: balls on a plain background.
std::unique_ptr<LabeledFilm> ball_film(const tactile::FilmSettings &settings);

/// What happens to a whole picture without anything happening in it.
enum class Disturbance
{
  still,        ///< nothing
  flicker,      ///< every frame is brighter or darker by up to 5 %
  fade,         ///< out to black and in again, 0.5–2 s each
  cut,          ///< another picture every 2–3.5 s
  pan,          ///< 1–4 pixels of 640 in 1/30 s, one speed and direction for 3 s
  pan_and_rest, ///< rests and pans of 1–2.5 s in turn, speeding up and slowing down within 0.2 s
  zoom,         ///< in and out, 0.2–0.6 % in 1/30 s
  shake,        ///< held in a hand: ± 4 pixels of 640 and ± 0.2° (σ), 0.5–5 Hz
};

const char *name(Disturbance disturbance);

/// A picture so disturbed, scaled to fill twice the frame's width and height, of which the frame
/// shows the middle half; with or without a ball that appears, rests, and is elsewhere at once.
/// With cuts the pictures follow each other.
std::unique_ptr<LabeledFilm> disturbed_film(Disturbance disturbance, std::vector<cv::Mat> pictures,
                                            cv::Size size, bool ball, std::uint64_t seed,
                                            double ball_size = 1.0 / 16);

/// A still picture into which another comes from the left, from second 1 to second 2, until it
/// covers `share` of the frame; without balls. Felt throughout that second: half of the film's
/// first two.
std::unique_ptr<LabeledFilm> entering_film(cv::Mat picture, cv::Mat object, double share);

} // namespace quality
