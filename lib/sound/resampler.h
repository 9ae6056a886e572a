// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sound {

/// Rate of the analysis, in Hz.
inline constexpr int kRate = 16000;

/// Resamples sound to kRate by windowed sines. Each output frame is a sum over the same input
/// frames, whatever their blocks. Frame n is the sound at n / kRate seconds.
class Resampler
{
public:
  /// `rate` in Hz, > 0.
  Resampler(int rate, int channels);

  /// Seconds of input before the first output frame.
  double delay() const;

  /// Takes interleaved frames, at most kBlock. Samples that are not finite count as 0, and so do
  /// those within ±kFaintest, whose powers would be denormal numbers, which are slow. Samples
  /// beyond ±kLoudest count as ±kLoudest.
  void add(std::span<const float> frames);

  /// Writes the next frame, a value a channel. False if it needs more input.
  bool take(std::span<float> frame);

  /// As after construction.
  void reset();

  static constexpr int kBlock = 1024;     ///< frames
  static constexpr double kPassed = 0.45; ///< of the lower rate: lower frequencies pass
  static constexpr float kLoudest = 16;
  static constexpr float kFaintest = 1e-10F; ///< −200 dB

private:
  void make_taps(int count);

  int rate_;
  int channels_;
  int taps_ = 0; ///< a multiple of kLanes
  std::int64_t phases_ = 1;
  std::vector<float> table_; ///< taps_ for each of phases_
  std::vector<float> held_;  ///< room_ a channel
  std::size_t room_ = 0;
  std::size_t held_frames_ = 0;
  std::int64_t first_ = 0; ///< input frame of the first held one
  std::int64_t next_ = 0;  ///< next output frame
};

} // namespace sound
