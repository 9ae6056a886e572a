// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/front_end.h"
#include "nanoseconds.h"
#include "people/activity.h"
#include "people/detection_thread.h"
#include "people/detector.h"
#include "people/face_tracker.h"
#include "saliency/analyzer.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <optional>
#include <span>
#include <string>

namespace people {

using visuotactile::Time;

/// The size of the pictures for detection: larger ones show smaller faces and need more work.
enum class Effort
{
  fast,     ///< pictures of 320 samples
  thorough, ///< 480: twice the work
};

/// Raises a saliency map where people's faces are: viewers look at them first (Judd et al. 2009).
///
/// Single pictures: map · (1 + 9 f) · (1 + s), f a Gaussian on each face, s the likeness to skin.
/// Films: map + 30 f · max(0, map − noise) + talk · f, where talk is small motion (Activity). A map
/// says where more than how strongly, so its maximum stays, or becomes that of a clear event at
/// most.
///
/// Faces are found on a thread of their own. In films a picture is looked at every kPeriod of film
/// time, after a cut at once, and its faces count from kLatency later on; they are followed
/// meanwhile (FaceTracker). Frames that show nothing new are not looked at while no face is
/// followed. In single pictures faces count at once. Everything follows film time, so a result
/// depends on the speed of the machine only where wait() is off and a detection is late.
///
/// Not thread-safe: one thread at a time.
class People
{
public:
  static constexpr Time kPeriod{ 800'000'000 };
  static constexpr Time kLatency{ 200'000'000 };

  struct Statistics
  {
    int faces = 0; ///< confirmed ones in the last frame
    DetectionThread::Statistics looks;
  };

  /// The data of an analysis about a frame.
  struct Scene
  {
    const saliency::Saliency &found;
    const saliency::LabImage &picture; ///< Analyzer::picture()
    const saliency::FrameView &frame;
    /// Boxes in pixels of the frame in which others have found people: no detection takes place
    /// then, nor for three seconds after.
    std::span<const cv::Rect2d> known{};
  };

  /// `temporal`: as for Analyzer::analyze().
  People(MakeDetector make, Effort effort, bool temporal);

  /// Whether raise() waits for a detection that is due; initially true.
  void wait(bool wait)
  {
    wait_ = wait;
  }

  /// The raised map of the frame shown from `time` on, valid until the next call. It is
  /// `found.map` itself where there is nothing to raise.
  const cv::Mat &raise(const Scene &scene, Time time);

  /// Drops all faces: the next frame does not follow the last one.
  void reset();

  /// Whether it has found a face, even if it is not confirmed.
  bool follows() const
  {
    return !tracker_.faces().empty();
  }

  /// Confirmed faces in the last frame, in its pixels.
  std::vector<cv::Rect2d> faces() const;

  /// The fault that ended detection; empty: none. Known people are raised nevertheless.
  std::string failure()
  {
    return thread_.failure();
  }

  Statistics statistics()
  {
    return { static_cast<int>(faces().size()), thread_.statistics() };
  }

private:
  void forget();
  void look(const Scene &scene, Time time);
  void collect(Time time);
  void paint_faces(const saliency::Saliency &found, cv::Size frame);

  bool temporal_;
  bool wait_ = true;
  DetectionThread thread_;
  saliency::FrontEnd front_end_;
  FaceTracker tracker_;
  Activity activity_;
  cv::Size frame_;
  std::optional<Time> last_time_;
  std::optional<Time> offered_;        ///< of the picture whose faces are not known yet
  saliency::Similarity since_offered_; ///< the camera's motion
  std::optional<Time> next_;           ///< when a picture is due; none: now
  std::optional<Time> known_until_;    ///< others detect people until then
  cv::Mat1f face_;                     ///< f
  cv::Mat1f raised_;
};

} // namespace people
