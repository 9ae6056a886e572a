// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/types.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace bench {

/// A method that processes a film frame by frame, and its cost.
struct Contender
{
  std::string method;
  std::string input; ///< format of the frames
  int threads = 1;
  std::size_t frame_bytes = 0;
  std::size_t history = 0; ///< frames until its memory stops growing
  bool played = false;     ///< at 30 frames per second: idle threads and cold caches between frames
  std::function<void(std::size_t)> work{}; ///< on the i-th frame

  /// Time per frame, by round: CPU time of this thread, which is least disturbed by other programs.
  /// With several threads, wall time.
  std::vector<double> ms{};
  std::vector<double> wall_ms{}; ///< wall time, always
  std::vector<double> all_ms{};  ///< CPU time of all threads, always
  double allocated = 0;          ///< bytes allocated per frame after warm-up
};

/// Current CPU time of this thread, or wall time, in ms.
double cpu_ms();
double wall_ms();

double median(std::vector<double> values);

/// Ratio of the times of two contenders of one race: the median over its rounds, because the
/// machine's speed varies between rounds.
double ratio(const std::vector<double> &first, const std::vector<double> &second);

/// Runs the contenders in turn for `rounds` rounds of a few frames each. The first frames of a
/// round, one per buffer of the film, are not measured. Slow contenders run fewer rounds, and all
/// their frames are measured.
void race(std::vector<Contender> &contenders, int rounds);

/// The method of reading a frame from memory.
inline constexpr const char *kReading = "reading the frame";

/// The tuned profile during playback.
inline constexpr const char *kPlayed = "tuned, 30 frames a second";

/// The tuned profile on two frames in a loop, which may stay in the cache.
inline constexpr const char *kTwoFrames = "tuned, two frames over and over";

/// All contenders, on frames of this size: reading a frame from memory, this project's profiles,
/// formats and thread counts, the literal paper, the OpenCV rewrites, and the peers in this build.
/// They own their film.
std::vector<Contender> contenders(cv::Size size);

/// The tuned profile, on one thread: an object moves, and the camera does.
std::vector<Contender> own_contenders(cv::Size size);

/// Thread counts to compare.
std::vector<int> thread_counts();

} // namespace bench
