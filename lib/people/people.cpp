// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/people.h"

#include "people/skin.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace people {

namespace {

/// The weights that differ between films and single pictures.
struct Weights
{
  float face;  ///< factor on the map
  float noise; ///< the map up to this is not raised
  float talk;  ///< map units per unit of Activity
  float width; ///< σ of a face, in widths of its box
  float clear; ///< a maximum up to which faces raise the map, in its units
};

/// The map of films has 0.13 units per ΔE of a small event: a clear one is 13.
constexpr Weights kFilm{ .face = 30, .noise = 0.13F, .talk = 4, .width = 0.45F, .clear = 1.7F };
constexpr Weights kStill{ .face = 9, .noise = 0, .talk = 0, .width = 0.315F, .clear = 0 };

/// In a single picture, skin says whether it is a face.
constexpr double kLeastSkin = 0.3;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

double
maximum(const cv::Mat &map)
{
  double most = 0;
  cv::minMaxLoc(map, nullptr, &most);
  return most;
}

} // namespace

People::People(MakeDetector make, Effort effort, bool temporal)
    : temporal_(temporal), thread_(std::move(make), effort == Effort::fast ? 320 : 480)
{
}

/// For a new shot.
void
People::forget()
{
  tracker_.reset();
  activity_.reset();
  offered_.reset();
  next_.reset();
}

void
People::reset()
{
  forget();
  last_time_.reset();
  known_until_.reset();
}

std::vector<cv::Rect2d>
People::faces() const
{
  std::vector<cv::Rect2d> boxes;
  for (const FaceTracker::Face &face : tracker_.faces())
    if (face.confirmed())
      boxes.push_back(face.box);
  return boxes;
}

/// Takes the faces of the offered picture, once they count.
void
People::collect(Time time)
{
  if (!offered_ || time < *offered_ + (temporal_ ? kLatency : Time{}))
    return;
  const std::optional<std::vector<Hit>> hits = thread_.take(wait_);
  if (!hits)
    return;
  std::vector<cv::Rect2d> boxes;
  for (const Hit &hit : *hits)
    if (temporal_ || hit.skin > kLeastSkin)
      boxes.push_back(moved(hit.box, since_offered_));
  if (!temporal_)
    tracker_.replace(boxes);
  else
    tracker_.update(boxes, seconds(time - *offered_));
  offered_.reset();
  // For a face that needs its second hit, the next picture is taken soon.
  if (!std::ranges::all_of(tracker_.faces(), &FaceTracker::Face::confirmed))
    next_.reset();
}

void
People::look(const Scene &scene, Time time)
{
  if (!scene.known.empty()) {
    tracker_.replace(scene.known);
    known_until_ = time + std::chrono::seconds(3);
    offered_.reset();
    return;
  }
  if (known_until_ && time < *known_until_)
    return;
  collect(time);
  if (offered_ || (next_ && time < *next_) || (scene.found.unchanged && !follows())
      || !thread_.failure().empty())
    return;
  const int level = thread_.level(frame_);
  thread_.offer(front_end_.lab(scene.frame, level, level), level);
  offered_ = time;
  since_offered_ = {};
  next_ = time + kPeriod;
  collect(time);
}

void
People::paint_faces(const saliency::Saliency &found, cv::Size frame)
{
  const double width = static_cast<double>(temporal_ ? kFilm.width : kStill.width);
  face_.create(found.map.size());
  face_.setTo(0);
  const double x_scale = found.picture.width / frame.width;
  const double y_scale = found.picture.height / frame.height;
  for (const cv::Rect2d &box : faces()) {
    const auto bell = [width](double length, double from, double scale, double origin, int count) {
      std::vector<float> values;
      const double middle = origin + (from + length / 2) * scale;
      for (int i = 0; i < count; ++i) {
        const double off = (i + 0.5 - middle) / std::max(0.5, width * length * scale);
        values.push_back(static_cast<float>(std::exp(-0.5 * off * off)));
      }
      return values;
    };
    const auto across = bell(box.width, box.x, x_scale, found.picture.x, face_.cols);
    const auto down = bell(box.height, box.y, y_scale, found.picture.y, face_.rows);
    for (int y = 0; y < face_.rows; ++y)
      for (int x = 0; x < face_.cols; ++x)
        face_(y, x) = std::max(face_(y, x), down[static_cast<std::size_t>(y)]
                                                * across[static_cast<std::size_t>(x)]);
  }
}

const cv::Mat &
People::raise(const Scene &scene, Time time)
{
  const saliency::Saliency &found = scene.found;
  const cv::Size frame(scene.frame.width, scene.frame.height);
  if (frame != frame_ || (last_time_ && time < *last_time_))
    reset();
  if (found.cut)
    forget();
  frame_ = frame;
  const double elapsed = last_time_ ? seconds(time - *last_time_) : 0;
  last_time_ = time;

  const saliency::Similarity camera = found.motion.in_units_of(found.picture.width / frame.width);
  tracker_.advance(elapsed, camera);
  since_offered_ = camera * since_offered_;
  if (temporal_)
    activity_.add(scene.picture.lightness(), elapsed, found.camera_moves);
  look(scene, time);

  const bool any = std::ranges::any_of(tracker_.faces(), &FaceTracker::Face::confirmed);
  const bool color = !temporal_ && scene.picture.planes[2].size() == found.map.size();
  if (!any && !color)
    return found.map;
  paint_faces(found, frame);
  const Weights &weights = temporal_ ? kFilm : kStill;
  const cv::Mat1f talk = temporal_ ? activity_.beyond_noise(found.map.size()) : cv::Mat1f();
  raised_.create(found.map.size());
  for (int y = 0; y < raised_.rows; ++y)
    for (int x = 0; x < raised_.cols; ++x) {
      const float face = face_(y, x);
      float &raised = raised_(y, x);
      raised = found.map.at<float>(y, x);
      raised += weights.face * face * std::max(0.0F, raised - weights.noise);
      if (temporal_)
        raised += weights.talk * talk(y, x) * face;
      if (color) {
        const auto &lab = scene.picture.planes;
        raised *= 1 + skin(lab[0].at<float>(y, x), lab[1].at<float>(y, x), lab[2].at<float>(y, x));
      }
    }
  const double most = std::max(found.peak, static_cast<double>(weights.clear));
  const double peak = maximum(raised_);
  if (peak > most)
    raised_ *= most / peak;
  return raised_;
}

} // namespace people
