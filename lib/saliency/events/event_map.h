// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "saliency/events/noise_floor.h"
#include "saliency/events/unexplained.h"
#include "saliency/pyramid.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace saliency {

/// Events: what moves or appears by itself, where, and how strongly.
class EventMap
{
public:
  struct Look
  {
    const LabImage &picture; ///< at the level of the camera's motion, about 100 samples wide
    const cv::Mat &contrast; ///< the spatial saliency map, `octaves` coarser
    int octaves = 1;
    Similarity pose{};  ///< the camera's, in samples of `picture` (CameraMotion::follow)
    double elapsed = 0; ///< frames at 30 fps since the last look
  };

  /// The map of the next frame, of the size of Look::contrast (CV_32FC1, ≥ 0).
  const cv::Mat &operator()(const Look &look);

  /// The map of a frame that shows the same as the last look's, before a camera at rest, `elapsed`
  /// frames at 30 fps later.
  const cv::Mat &stay(double elapsed);

  /// The strongest onset that may be held (kHeld), and thus felt again.
  float held() const
  {
    return most_held_;
  }

  /// The map's maximum before the divisor of the camera's motion and the noise floor.
  float change() const
  {
    return change_;
  }

  /// The strongest event now, in ΔE, before the divisor of the camera's motion and the noise floor.
  double energy() const
  {
    return energy_;
  }

  /// Drops the past: the next frame is a first one.
  void reset();

  /// Changes the frame of reference of all poses: `view` maps the old one to the new one.
  void rebase(const Similarity &view);

  /// So long after the end of an event its map is below the floor, in frames at 30 fps.
  static constexpr int kHold = 25;

  /// How far the map of an event reaches beyond the moving thing, in samples of a map of that size.
  static int reach(cv::Size map);

private:
  struct Picture
  {
    double age = 0; ///< in frames at 30 fps
    LabImage lab;
    cv::Mat contrast;
    Similarity pose;
  };

  void age(double elapsed);
  void keep(const LabImage &shown, const cv::Mat &contrast, const Similarity &pose);
  const Picture *picture_before(double lag) const;
  Similarity motion_since(const Picture &then, const Look &look) const;
  void compare(const Look &look, const Picture &then, const Similarity &before, cv::Mat &map);
  void hold_onsets(const Look &look);
  const cv::Mat &settle(float scale, bool rests, double elapsed);
  void weigh_onsets(const Look &look, const Picture &then, const Similarity &before, cv::Mat &map);
  void pool(const cv::Mat &change, int octaves, cv::Mat &pooled);
  void weigh_coherence(const Look &look, float weight, cv::Mat &map);
  void blur(double sigma, cv::Mat &map);

  static constexpr std::size_t kMostPictures = 36;
  std::vector<Picture> past_; ///< a ring
  std::size_t count_ = 0;
  std::size_t latest_ = kMostPictures - 1;
  Unexplained unexplained_;
  NoiseFloor noise_;
  std::array<Reduction, 3> reductions_;
  std::array<cv::Mat, 2> finer_;
  cv::Mat rises_; ///< of lightness
  cv::Mat falls_;
  cv::Mat around_; ///< the change around each sample, and the shares of lightness in it
  cv::Mat brighter_;
  cv::Mat darker_;
  cv::Mat gone_;   ///< the contrast then, at its place now
  cv::Mat inside_; ///< the part of the surroundings within the picture
  float change_ = 0;
  double sigma_ = 0; ///< of the weights, in samples
  std::vector<float> weights_;
  cv::Mat along_rows_;
  std::vector<float> padded_; ///< a row with nothing on both sides
  cv::Mat now_;
  cv::Mat held_;     ///< the strongest event of the last half second
  cv::Mat held_age_; ///< its age, in frames at 30 fps
  cv::Mat since_;    ///< what changed in the last half second
  cv::Mat slow_;
  cv::Mat map_;
  double energy_ = 0;
  float most_held_ = 0;
};

} // namespace saliency
