// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "camera_path.h"

#include <opencv2/core/mat.hpp>

namespace quality {

/// A flat thing parallel to the picture at z, whose top left corner is at (x, y), in meters.
struct Card
{
  double x = 0;
  double y = 0;
  double z = 0;
  double density = 0; ///< texels per meter
  cv::Mat texture;    ///< CV_8UC4, premultiplied by alpha
};

/// Texels per pixel: with so many, linear interpolation blurs little.
inline constexpr double kTexels = 2;
/// σ in pixels of what samples have the area of a pixel behind a lens.
inline constexpr double kAperture = 0.45;

/// m; what is nearer is not drawn.
inline constexpr double kNearest = 0.4;

/// What is seen of a card in a part of the frame, CV_8UC4, premultiplied. Requires card.z > pose.z.
void warp(const Card &card, const Pose &pose, cv::Size size, const cv::Rect &part, cv::Mat &out);

/// The part of the frame in which a card is seen; empty if it is nearer than kNearest.
cv::Rect seen_part(const Card &card, const Pose &pose, cv::Size size);

/// `front` (CV_8UC4, premultiplied) over `picture` (CV_8UC3).
void compose(const cv::Mat &front, cv::Mat picture);

/// What a layer consists of.
enum class Cover
{
  all,
  blocks, ///< from some height down, like houses
  bushes,
  trunks, ///< from top to bottom
};

/// A textured layer at depth z that covers all that the camera sees until `seconds`, but for its
/// gaps. It leaves a lane of ± `lane` meters for the camera.
Card make_layer(double z, Cover cover, double lane, const CameraPath &path, double seconds,
                cv::Size size, const cv::Mat &texture, Random &random);

} // namespace quality
