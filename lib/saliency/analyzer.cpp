// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/analyzer.h"

#include "frame/front_end.h"
#include "saliency/camera_motion.h"
#include "saliency/events/event_map.h"
#include "saliency/events/strength.h"
#include "saliency/paper.h"
#include "saliency/pyramid.h"
#include "saliency/shot_cut.h"
#include "saliency/spatial_saliency.h"
#include "saliency/stillness.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace saliency {

namespace {

constexpr double kFramesPerNanosecond = 30e-9;
constexpr Time kDefaultDuration{ 1'000'000'000 / 30 };

/// A film that pauses for longer, in frames at 30 fps, begins anew.
constexpr double kLongestGap = 64;

// These are of a picture that does not change (Analyzer::set_rest).
constexpr double kLongestRest = 4.5; ///< between two analyses, frames at 30 fps
constexpr float kQuiet = 0.02F;      ///< the map's most, so that the noise floor is as if analyzed
constexpr double kSame = 0.3;        ///< of the floor: the difference
constexpr double kMostFloor = 0.8;   ///< a higher one hides events on which later levels depend
constexpr int kMostMisses = 5;       ///< after that, one frame of ten is tested

/// Whether a pose is so far from its frame of reference that precision may soon be lost.
bool
is_far(const Similarity &pose)
{
  constexpr double kFarthest = 1e6; // samples
  constexpr double kMostScale = 16;
  const double scale = std::hypot(pose.a, pose.b);
  return std::hypot(pose.tx, pose.ty) > kFarthest || scale > kMostScale || scale < 1 / kMostScale;
}

/// to - from > 0, in frames at 30 fps. In double, since the difference may exceed the range of
/// Time.
double
frames_between(Time from, Time to)
{
  const auto ticks
      = static_cast<std::uint64_t>(to.count()) - static_cast<std::uint64_t>(from.count());
  return static_cast<double>(ticks) * kFramesPerNanosecond;
}

} // namespace

struct Analyzer::State
{
  explicit State(const Profile &profile_) : profile(profile_), spatial(profile), shot_cut(profile)
  {
  }

  void follow(cv::Size size, Time time, bool temporal);
  void forget();
  bool rests(const FrameView &frame, Time time, Time duration);
  Similarity camera_pose(double elapsed);
  const cv::Mat &spatial_map();
  const cv::Mat &spatiotemporal_map();
  const cv::Mat &event_map(Time time);
  const Saliency &finish(Time time, Time duration, bool temporal);
  void done(Stage stage, const cv::Mat &map = {}) const
  {
    if (observer)
      observer(stage, map);
  }

  Profile profile;
  FrontEnd front_end;
  Team team; ///< threads of the current frame
  Pyramid pyramid;
  Paper paper;
  SpatialSaliency spatial;
  ShotCut shot_cut;
  CameraMotion camera;
  EventMap events;
  Strength strength;

  struct Previous
  {
    Time time;
    Time duration;
  };
  std::optional<Previous> previous; ///< last frame since the reset
  Time analyzed{};                  ///< the last of them that was analyzed

  Stillness stillness;
  double rest_floor = 0;
  int misses = 0;   ///< tests in a row that failed
  int untested = 0; ///< analyses until the next test

  FrameLevels levels;
  Similarity last_pose;
  Saliency result;
  std::function<void(Stage, const cv::Mat &)> observer;
};

/// Prepares for a frame of this size and time: drops the history unless the frame continues it.
void
Analyzer::State::follow(cv::Size size, Time time, bool temporal)
{
  if (!temporal)
    previous.reset();
  if (size != levels.frame) {
    levels = frame_levels(profile, size);
    previous.reset();
  }
  if (previous && time <= previous->time)
    previous.reset();
  // After a gap it is unknown what was visible, unlike after a frame that was displayed for long.
  if (previous && profile.method != Method::paper
      && frames_between(previous->time, time)
             > kLongestGap + frames_between(Time{}, previous->duration))
    previous.reset();
  if (!previous) {
    forget();
    shot_cut.reset();
    strength.reset();
  }
}

void
Analyzer::State::forget()
{
  stillness.reset();
  paper.reset();
  camera.reset();
  events.reset();
}

/// Whether the frame can do without an analysis; the history goes on then.
bool
Analyzer::State::rests(const FrameView &frame, Time time, Time duration)
{
  if (rest_floor > 0 && profile.method == Method::events && !previous)
    stillness.prepare(frame, levels.camera);
  if (!(rest_floor > 0) || profile.method != Method::events || !previous
      || std::max(events.change(), events.held()) > kQuiet || result.camera_moves || result.cut) {
    stillness.reset();
    return false;
  }
  if (untested > 0) {
    --untested;
    stillness.reset();
    return false;
  }
  if (frames_between(analyzed, time) >= kLongestRest) {
    stillness.keep(frame, levels.camera);
    return false;
  }
  const bool had_reference = stillness.known();
  if (!stillness(frame, levels.camera, kSame * rest_floor)) {
    // A film that moves without an event costs a test now and then.
    misses = had_reference ? std::min(misses + 1, kMostMisses) : misses;
    untested = had_reference ? (1 << misses) / 4 : 0;
    return false;
  }
  misses = 0;
  const double elapsed = frames_between(previous->time, time);
  camera.stay(elapsed);
  result.map = events.stay(elapsed);
  result.strength = strength.follow(events.energy(), elapsed);
  cv::minMaxLoc(result.map, nullptr, &result.peak);
  previous = Previous{ time, duration > Time::zero() ? duration : kDefaultDuration };
  result.unchanged = true;
  result.motion = {};
  return true;
}

/// The camera's pose in samples of levels.camera.
Similarity
Analyzer::State::camera_pose(double elapsed)
{
  const Similarity pose = camera.follow(pyramid.level(levels.camera).lightness(), elapsed);
  if (!is_far(pose))
    return pose;
  camera.rebase();
  events.rebase(pose.inverse());
  last_pose = pose.inverse() * last_pose;
  return {};
}

/// The spatial saliency of the frame in `pyramid`.
const cv::Mat &
Analyzer::State::spatial_map()
{
  const cv::Mat &map = profile.method == Method::paper ? paper.spatial(pyramid, levels.frame, team)
                                                       : spatial.compute(pyramid, levels, team);
  done(Stage::spatial, map);
  return map;
}

/// The paper's map of the frame in `pyramid`, which is added to the history.
const cv::Mat &
Analyzer::State::spatiotemporal_map()
{
  done(Stage::camera);
  done(Stage::shot_cut);
  const cv::Mat &map = spatial_map();
  done(Stage::history);
  return paper.spatiotemporal(map, team);
}

/// The events of the frame in `pyramid`.
const cv::Mat &
Analyzer::State::event_map(Time time)
{
  double elapsed = previous ? frames_between(previous->time, time) : 0;
  Similarity pose = camera_pose(elapsed);
  done(Stage::camera);
  // A fast pan at a low frame rate changes as many pixels, but the camera can be followed.
  if (profile.cut_share < 1 && shot_cut(pyramid.level(levels.saliency)) && !camera.moved()) {
    forget();
    elapsed = 0;
    pose = camera_pose(elapsed);
    result.cut = true;
  }
  done(Stage::shot_cut);
  const cv::Mat &contrast = spatial_map();
  const int octaves = levels.saliency - levels.camera;
  if (elapsed > 0)
    result.motion = (pose.inverse() * last_pose).in_units_of(std::ldexp(1.0, octaves));
  last_pose = pose;
  result.camera_moves = camera.moved();
  done(Stage::history);
  const cv::Mat &map = events({ .picture = pyramid.level(levels.camera),
                                .contrast = contrast,
                                .octaves = octaves,
                                .pose = pose,
                                .elapsed = elapsed });
  result.strength = strength.follow(events.energy(), elapsed);
  return map;
}

/// The result of the frame in `pyramid`.
const Saliency &
Analyzer::State::finish(Time time, Time duration, bool temporal)
{
  if (duration <= Time::zero())
    duration = kDefaultDuration;
  result.cut = false;
  result.unchanged = false;
  result.camera_moves = false;
  result.motion = {};
  result.strength = 0;
  if (!temporal)
    result.map = spatial_map();
  else {
    result.map = profile.method == Method::paper ? spatiotemporal_map() : event_map(time);
    previous = Previous{ time, duration };
    analyzed = time;
    done(Stage::spatiotemporal, result.map);
  }
  cv::minMaxLoc(result.map, nullptr, &result.peak);
  const double step = std::ldexp(1.0, levels.saliency); // pixels per sample
  result.picture = { 0.5 - 0.5 / step, 0.5 - 0.5 / step, levels.frame.width / step,
                     levels.frame.height / step };
  return result;
}

int
preceding_halvings(const Profile &profile, cv::Size frame)
{
  return profile.exact ? 0 : decimation_level(frame, frame_levels(profile, frame).finest);
}

Analyzer::Analyzer(const Profile &profile) : state_(std::make_unique<State>(profile))
{
  assert(fault_of(profile).empty());
}
Analyzer::~Analyzer() = default;
Analyzer::Analyzer(Analyzer &&) noexcept = default;
Analyzer &Analyzer::operator=(Analyzer &&) noexcept = default;

const Saliency &
Analyzer::analyze(const FrameView &frame, Time time, Time duration, bool temporal)
{
  auto &s = *state_;
  assert(fault_of(frame).empty());
  s.follow({ frame.width, frame.height }, time, temporal);
  if (temporal && s.rests(frame, time, duration))
    return s.result;
  const int converted
      = s.profile.exact ? 0 : decimation_level({ frame.width, frame.height }, s.levels.finest);
  const FixedLabImage &lab = s.front_end.lab(frame, s.levels.finest, converted);
  s.team = s.front_end.team();
  s.done(Stage::lab);
  s.pyramid.build(lab, s.levels.finest, s.levels.coarsest, s.levels.finest_chroma, s.team);
  s.done(Stage::pyramid);
  return s.finish(time, duration, temporal);
}

const Saliency &
Analyzer::analyze(const LabImage &lab, cv::Size frame, Time time, Time duration, bool temporal)
{
  auto &s = *state_;
  s.follow(frame, time, temporal);
  s.team = {};
  s.pyramid.build(lab, s.levels.finest, s.levels.coarsest);
  s.done(Stage::pyramid);
  return s.finish(time, duration, temporal);
}

const LabImage &
Analyzer::picture() const
{
  return state_->pyramid.level(state_->levels.finest);
}

void
Analyzer::set_observer(std::function<void(Stage, const cv::Mat &map)> observer)
{
  state_->observer = std::move(observer);
}

void
Analyzer::set_rest(double floor)
{
  state_->rest_floor = std::min(floor, kMostFloor);
}

void
Analyzer::reset()
{
  state_->previous.reset();
}

void
Analyzer::set_threads(int threads)
{
  state_->front_end.set_threads(threads);
}

const Profile &
Analyzer::profile() const
{
  return state_->profile;
}

} // namespace saliency
