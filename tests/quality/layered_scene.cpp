// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layered_scene.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace quality {

namespace {

/// A layer's alpha, CV_8UC1. The world's x = 0, y = 0 is at `origin`, in texels; `unit` is the
/// width of the first picture at that distance. Nothing is nearer to x = 0 than `lane`.
cv::Mat
draw_cover(Cover cover, Random &random, cv::Size size, cv::Point2d origin, double unit, double lane)
{
  struct Piece
  {
    double least_width; ///< all in units
    double most_width;
    double least_gap;
    double most_gap;
  };
  const Piece piece = cover == Cover::blocks   ? Piece{ 0.08, 0.25, 0.05, 0.25 }
                      : cover == Cover::bushes ? Piece{ 0.08, 0.2, -0.03, 0.15 }
                                               : Piece{ 0.015, 0.045, 0.2, 0.5 };
  cv::Mat mask(size, CV_8UC1, cv::Scalar(cover == Cover::all ? 255 : 0));
  for (double x = -unit * random.uniform(0, 0.3); cover != Cover::all && x < size.width;) {
    const double width = unit * random.uniform(piece.least_width, piece.most_width);
    const double gap = unit * random.uniform(piece.least_gap, piece.most_gap);
    const double y = origin.y + unit * random.uniform(-0.2, 0.05);
    const cv::Point left(static_cast<int>(x), cover == Cover::blocks ? static_cast<int>(y) : 0);
    const cv::Point right(static_cast<int>(x + width), size.height);
    const cv::Point middle((left.x + right.x) / 2, static_cast<int>(y + 0.25 * unit));
    const bool clear = x + width < origin.x - lane || x > origin.x + lane;
    if (clear && cover == Cover::bushes)
      cv::circle(mask, middle, static_cast<int>(width / 2), 255, cv::FILLED, cv::LINE_AA);
    else if (clear)
      cv::rectangle(mask, left, right, 255, cv::FILLED);
    x += width + gap;
  }
  return mask;
}

} // namespace

void
warp(const Card &card, const Pose &pose, cv::Size size, const cv::Rect &part, cv::Mat &out)
{
  const double scale = card.density * (card.z - pose.z) / size.width; // texels per pixel
  const double cosine = scale * std::cos(pose.roll);
  const double sine = scale * std::sin(pose.roll);
  const cv::Point2d corner
      = seen_at(pose, cv::Point2d(part.tl()) + cv::Point2d(0.5, 0.5), card.z, size)
        - cv::Point2d(card.x, card.y);
  const cv::Matx23d to_texel(cosine, -sine, corner.x * card.density - 0.5, sine, cosine,
                             corner.y * card.density - 0.5);
  cv::warpAffine(card.texture, out, to_texel, part.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT);
}

cv::Rect
seen_part(const Card &card, const Pose &pose, cv::Size size)
{
  if (card.z - pose.z < kNearest)
    return {};
  cv::Point2d low(1e6, 1e6);
  cv::Point2d high(-1e6, -1e6);
  for (const double x : { 0, card.texture.cols })
    for (const double y : { 0, card.texture.rows }) {
      const cv::Point2d corner
          = project(pose, card.x + x / card.density, card.y + y / card.density, card.z, size);
      low = { std::min(low.x, corner.x), std::min(low.y, corner.y) };
      high = { std::max(high.x, corner.x), std::max(high.y, corner.y) };
    }
  const cv::Point from(static_cast<int>(std::max(0.0, low.x - 1)),
                       static_cast<int>(std::max(0.0, low.y - 1)));
  const cv::Point to(static_cast<int>(std::min<double>(size.width, high.x + 2)),
                     static_cast<int>(std::min<double>(size.height, high.y + 2)));
  return to.x > from.x && to.y > from.y ? cv::Rect(from, to) : cv::Rect();
}

void
compose(const cv::Mat &front, cv::Mat picture)
{
  for (int y = 0; y < picture.rows; ++y) {
    const auto *from = front.ptr<cv::Vec4b>(y);
    auto *to = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const int through = 255 - from[x][3];
      if (through == 255)
        continue;
      if (through == 0) {
        to[x] = { from[x][0], from[x][1], from[x][2] };
        continue;
      }
      for (int c = 0; c < 3; ++c)
        to[x][c] = static_cast<uchar>(from[x][c] + (to[x][c] * through + 127) / 255);
    }
  }
}

Card
make_layer(double z, Cover cover, double lane, const CameraPath &path, double seconds,
           cv::Size size, const cv::Mat &texture, Random &random)
{
  // What the camera sees at that depth on its way.
  double left = 1e9;
  double right = -1e9;
  double top = 1e9;
  double bottom = -1e9;
  double nearest = 1e9;
  for (double t = 0; t <= seconds; t += 0.05) {
    const Pose pose = path.at(t);
    const double distance = z - pose.z;
    if (distance < kNearest)
      continue;
    nearest = std::min(nearest, distance);
    for (const cv::Point2d corner :
         { cv::Point2d(0, 0), cv::Point2d(size.width, 0), cv::Point2d(0, size.height),
           cv::Point2d(size.width, size.height) }) {
      const cv::Point2d seen = seen_at(pose, corner, z, size);
      left = std::min(left, seen.x);
      right = std::max(right, seen.x);
      top = std::min(top, seen.y);
      bottom = std::max(bottom, seen.y);
    }
  }
  constexpr double kMargin = 0.05; // of the distance: between the sampled times
  const double farthest = z;
  Card card;
  card.x = left - kMargin * farthest;
  card.y = top - kMargin * farthest;
  card.z = z;
  card.density = kTexels * size.width / std::max(nearest, farthest / 2);
  const cv::Size texels(static_cast<int>((right - card.x + kMargin * farthest) * card.density),
                        static_cast<int>((bottom - card.y + kMargin * farthest) * card.density));

  cv::Mat picture;
  cv::flip(texture, picture, static_cast<int>(std::floor(random.uniform(-1, 2))));
  const int x = static_cast<int>(random.uniform(0, picture.cols));
  const int y = static_cast<int>(random.uniform(0, picture.rows));
  cv::copyMakeBorder(picture, picture, y, std::max(0, texels.height - y), x,
                     std::max(0, texels.width - x), cv::BORDER_REFLECT_101);
  picture(cv::Rect({}, texels)).convertTo(picture, -1, random.uniform(0.65, 1.1));
  cv::Mat mask = draw_cover(cover, random, texels, cv::Point2d(-card.x, -card.y) * card.density,
                            farthest * card.density, lane * card.density);
  cv::Mat mask3;
  cv::merge(std::array{ mask, mask, mask }, mask3);
  cv::multiply(picture, mask3, picture, 1 / 255.0);
  cv::merge(std::array{ picture, mask }, card.texture);
  // Right for the middle of the way.
  const double most = card.density * z / size.width; // texels per pixel
  cv::GaussianBlur(card.texture, card.texture, {}, kAperture * std::sqrt(kTexels * most));
  // Nothing is drawn above what there is.
  cv::Rect used = cv::boundingRect(mask);
  used = (used + cv::Size(8, 8) - cv::Point(4, 4)) & cv::Rect({}, texels);
  card.texture = card.texture(used).clone();
  card.x += used.x / card.density;
  card.y += used.y / card.density;
  return card;
}

} // namespace quality
