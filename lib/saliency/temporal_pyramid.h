// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/thread_pool.h"
#include "saliency/profile.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace saliency {

/// The temporal pyramid (paper, Section 3: "a level-n image averages the spatial saliency maps of
/// 2ⁿ previous frames including the current frame"), for windows of any length rather than 2ⁿ
/// alone.
///
/// Time is counted in frames, which are 1/30 s where windows are meant in seconds. A map is on show
/// from its push to the next one; a window is the stretch of that length which ends with the
/// current map's display, and its mean weighs each map by the time it was on show inside. So a film
/// has the same windows at whatever frame rate.
///
/// What is kept is the integral of the maps over time at each push, in double precision: a window
/// is one subtraction, with linear interpolation where its start falls inside a display. The
/// integral only grows, yet a window's mean stays exact to float's precision for years of film:
/// neither drift nor wrap-around.
///
/// With a camera that moves, a window has to show where things were in the picture as it is now:
/// each map is moved from its own pose to the current one before it counts. Where a map did not see
/// what is to be seen now, it is taken to have been like the current one. Maps further back are
/// moved several at a time, as far as they make a quarter of their age.
///
/// Memory: pushes less than 1/8 apart share one entry, so at most 8 × longest + 3 integrals of 8
/// bytes a sample are held (66 at one push a frame and a longest window of 64), and maps of 20
/// bytes a sample beside them. What is no longer needed is used again: nothing is allocated once as
/// many are held as it takes.
class TemporalPyramid
{
public:
  /// A map counts as displayed for no longer than this when its windows are taken (its share in
  /// later windows is not limited). It only matters below ten frames a second: with windows that
  /// end late in a long display the current map would fill center and surround alike, and slides
  /// would never be salient.
  static constexpr double kLongestDisplay = 3;

  /// So close to their border, in samples, maps do not count as having seen anything once they are
  /// moved: what enters the picture changes them.
  static constexpr double kBorder = 1;

  /// `longest`: the longest window that will be asked for.
  TemporalPyramid(double longest, HistoryStart start);

  /// Forgets everything.
  void reset();

  /// The next map (CV_32FC1, finite, copied), `elapsed` > 0 after the previous one was pushed (of
  /// no meaning for the first) and to be displayed for `duration` > 0. All maps between two resets
  /// have one size. Never blocks on long times: beyond the longest window they make no difference.
  /// `pose`: from this map's samples to where they lie in a common frame of reference, the same
  /// exactly as long as the camera rests.
  void push(const cv::Mat &map, double elapsed, double duration, const Similarity &pose = {});

  /// The frame of reference is another one: `view` tells where in it lies what lies in the old one.
  void rebase(const Similarity &view);

  /// Whether the camera has moved within the longest window, or shortly before.
  bool moved() const;

  /// The means over the last `windows`, each > 0, ascending, into as many `maps` (CV_32FC1). Before
  /// the first push lies nothing (HistoryStart::empty: the mean of what there is) or the first map
  /// for ever. If nothing has changed inside a window, exactly the current map.
  void means(std::span<const int> windows, std::vector<cv::Mat> &maps, const Team &team = {});

  /// Integrals held.
  std::size_t size() const;

private:
  /// The integral of the maps over time up to `time`, and the pose of the map that is on show from
  /// then on.
  struct Entry
  {
    double time = 0;
    cv::Mat integral{}; ///< CV_64FC1
    Similarity pose{};
  };

  /// A moment inside the display between two entries.
  struct Moment
  {
    const Entry *before;
    const Entry *after;
    double part; ///< of the display that is over
  };

  /// Entry i, oldest first; the last is the time of the latest push.
  const Entry &entry(std::size_t i) const
  {
    const std::size_t place = oldest_ + i;
    return ring_[place < ring_.size() ? place : place - ring_.size()];
  }
  Entry &entry(std::size_t i)
  {
    return const_cast<Entry &>(std::as_const(*this).entry(i));
  }
  const Entry &latest() const
  {
    return entry(count_ - 1);
  }
  Entry &add_entry(double time, const Similarity &pose);
  void integrate(const Entry &from, double duration, Entry &to);

  /// The last display that begins before `time`, or is the first, by its place in the history.
  std::size_t display_before(double time) const;
  Moment moment(double time) const;
  void difference(const Moment &from, const Moment &to, double scale, cv::Mat &map) const;
  void moved_means(std::span<const int> windows, std::vector<cv::Mat> &maps);
  void add_moved(double from, double to);

  double longest_;
  HistoryStart start_;
  std::vector<Entry> ring_; ///< entries in use and, after them, integrals to use again
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
  cv::Mat current_; ///< the latest map
  Entry end_{};     ///< the end of its display

  cv::Mat stretch_; ///< what was on show for a while (CV_32FC1)
  cv::Mat sum_;     ///< of stretches, each moved, less the current map (CV_32FC1)
};

} // namespace saliency
