// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/types.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace bench {

/// Something that does its work on a film, frame by frame, and what that costs.
struct Contender
{
  std::string method;
  std::string input; ///< format of the frames
  int threads = 1;
  std::size_t frame_bytes = 0;
  std::size_t history = 0; ///< frames after which it holds all the memory that it will
  bool played = false; ///< 30 frames a second: threads fell asleep and caches cooled since the last
  std::function<void(std::size_t)> work{}; ///< on the i-th frame

  /// A frame, in each round: CPU time of this thread, which other programs disturb least, or, where
  /// it has several threads, time on the wall.
  std::vector<double> ms{};
  std::vector<double> wall_ms{}; ///< time on the wall in any case
  double allocated = 0;          ///< bytes asked for a frame, after warm-up
};

/// Now, in ms of CPU time of this thread or on the wall.
double cpu_ms();
double wall_ms();

double median(std::vector<double> values);

/// How many times as long the first took as the second, both of one race: the median over its
/// rounds, as the machine may be quicker in some than in others.
double ratio(const std::vector<double> &first, const std::vector<double> &second);

/// Lets them work in turn, a few frames each, after as many as a film has buffers, which are not
/// counted, `rounds` times (the slow fewer times, and each frame counts).
void race(std::vector<Contender> &contenders, int rounds);

/// The method of reading a frame from memory.
inline constexpr const char *kReading = "reading the frame";

/// The tuned profile's when it plays.
inline constexpr const char *kPlayed = "tuned, 30 frames a second";

/// The tuned profile's on two frames over and over, which the cache may hold.
inline constexpr const char *kTwoFrames = "tuned, two frames over and over";

/// Everything that is compared, on frames of this size: reading a frame from memory, this project's
/// profiles, formats and threads, the paper taken literally, OpenCV rewrites, and the peers that
/// this build has. The film lives as long as they do.
std::vector<Contender> contenders(cv::Size size);

/// Numbers of threads to compare.
std::vector<int> thread_counts();

} // namespace bench
