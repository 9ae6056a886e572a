// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"
#include "saliency/profile.h"

#include <opencv2/core/mat.hpp>

#include <chrono>
#include <memory>

namespace saliency {

using Time = std::chrono::nanoseconds;

/// Saliency of one frame. `map` stays valid until the next call on the same analyzer and must not be written to.
struct Saliency
{
  cv::Mat map;      ///< CV_32FC1, at `Profile::saliency_level`'s resolution, ≥ 0, in the profile's units (ΔE or N(·)-scaled)
  double peak = 0;  ///< maximum of `map`
};

/// Frame → L*a*b* pyramid → contrast → spatial → (temporal → spatiotemporal) saliency: paper, Section 3.
/// Not thread-safe: one stream, one analyzer, one thread at a time.
class Analyzer
{
public:
  explicit Analyzer(const Profile &profile);
  ~Analyzer();
  Analyzer(Analyzer &&) noexcept;
  Analyzer &operator=(Analyzer &&) noexcept;

  /// Analyses the frame shown during [time, time + duration). Frames come in order of time; a frame whose time is
  /// not after its predecessor's, or whose size differs, resets the history first. duration ≤ 0 is taken as 1/30 s.
  /// With `temporal` off the result is the spatial saliency alone (the history is kept up to date all the same).
  const Saliency &analyze(const FrameView &frame, Time time, Time duration, bool temporal = true);

  /// Forgets the history: the next frame fills it with its own spatial map (no burst after start, seek or cut).
  void reset();

  const Profile &profile() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace saliency
