// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "labels.h"

#include <opencv2/core/mat.hpp>

#include <bitset>

namespace quality {

/// What a person would expect to feel of one frame, on 3 × 3 tactors.
struct Expected
{
  Verdict verdict = Verdict::quiet;
  std::bitset<9> cells; ///< where it is, row by row; all if anything may be felt
  int events = 0;       ///< how many have begun that are to be found: appearances, starts to move
};

/// A drawn film that tells what should be felt. It is a pure function of its settings and the times
/// of its frames.
class CinemaFilm
{
public:
  CinemaFilm() = default;
  virtual ~CinemaFilm() = default;
  CinemaFilm(const CinemaFilm &) = delete;
  CinemaFilm &operator=(const CinemaFilm &) = delete;

  /// Draws the picture at `time` ≥ 0, CV_8UC3 BGR. Times never go back.
  virtual Expected draw(Time time, cv::Mat &bgr) = 0;
};

/// Length of all drawn films.
inline constexpr Time kCinemaLength = std::chrono::seconds(12);

/// The cells that hold at least a tenth of the part of a rectangle that is in the frame.
std::bitset<9> cells_of(const cv::Rect2d &rect, cv::Size frame);

/// The part of a rectangle that is in the frame.
cv::Rect2d clipped(const cv::Rect2d &rect, cv::Size frame);

/// Anything may be felt.
Expected anything();

} // namespace quality
