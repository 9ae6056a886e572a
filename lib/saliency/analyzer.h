// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "saliency/profile.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <chrono>
#include <memory>

namespace saliency {

using Time = std::chrono::nanoseconds;

/// Saliency of one frame. `map` stays valid until the next call on the same analyzer and must not
/// be written to.
struct Saliency
{
  /// CV_32FC1 at `Profile::saliency_level`'s resolution, finite and ≥ 0, in the profile's units
  /// (ΔE, or what N(·) makes of it).
  cv::Mat map;
  double peak = 0; ///< maximum of `map`
  /// Where the picture lies in the map, in samples of which sample i covers [i, i + 1): sample i of
  /// level n sits on pixel 2ⁿ·i, so the picture's edge is not the map's.
  cv::Rect2d picture;
  bool cut = false;          ///< a new shot begins with this frame
  bool camera_moves = false; ///< or has done so within the longest window
};

/// Frame → L*a*b* pyramid → contrast → spatial → (temporal → spatiotemporal) saliency: paper,
/// Section 3. Not thread-safe: one stream, one analyzer, one thread at a time.
class Analyzer
{
public:
  /// Of a profile without fault_of().
  explicit Analyzer(const Profile &profile);
  ~Analyzer();
  Analyzer(Analyzer &&) noexcept;
  Analyzer &operator=(Analyzer &&) noexcept;

  /// Analyzes the frame shown during [time, time + duration). Frames come in order of time. A frame
  /// resets the history first if its time is not after its predecessor's, if its size differs or,
  /// with windows in seconds, if it comes later after its predecessor's end than the longest
  /// window. duration ≤ 0 is taken as 1/30 s. With `temporal` off the result is the spatial
  /// saliency alone: nothing is compared with other frames, and the next one begins a history. The
  /// frame is one without fault_of().
  const Saliency &analyze(const FrameView &frame, Time time, Time duration, bool temporal = true);

  /// Forgets the history: the next frame fills it with its own spatial map (no burst after start,
  /// seek or cut).
  void reset();

  /// How many threads work on a frame at most, 0 for as many as pay (see FrontEnd); one at first.
  /// The result is the same for any number and the history goes on. Below 0 is 0.
  void set_threads(int threads);

  const Profile &profile() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace saliency
