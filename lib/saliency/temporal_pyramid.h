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
/// 2ⁿ previous frames including the current frame"), for windows of any length.
///
/// Time is counted in frames, of 1/30 s if windows are meant in seconds. A map is displayed from
/// its push to the next one. A window of a given length ends when the current map's display ends,
/// and its mean weights each map by its display time within the window. A film therefore has the
/// same windows at any frame rate.
///
/// At each push the integral of the maps over time is stored in double precision, as in a
/// summed-area table. A window's mean is one subtraction, with linear interpolation where its start
/// falls inside a display. The integral only grows, but means stay exact to float precision for
/// years of film.
///
/// With camera motion, a window has to align its maps with the current picture: each map is warped
/// from its own pose to the current one. Where a map did not see a part of the current picture, it
/// is assumed to equal the current map. Older maps are warped several at a time, as long as
/// together they span at most a quarter of their age.
///
/// Memory: pushes less than 1/8 apart share an entry. So at most 8 × longest + 3 integrals of 8
/// bytes per sample are held; with one push per frame and a longest window of 64 frames it is 66.
/// Other maps take 20 bytes per sample. Buffers are reused: nothing is allocated once the history
/// is full.
class TemporalPyramid
{
public:
  /// Longest display time of the current map when its windows are taken; its share in later windows
  /// is not limited. This matters below ten frames per second only. Otherwise windows would end
  /// late in a long display, the current map would fill center and surround alike, and slides would
  /// never be salient.
  static constexpr double kLongestDisplay = 3;

  /// Once warped, maps are ignored this close to their border, in samples: new content enters
  /// there.
  static constexpr double kBorder = 1;

  /// `longest`: the longest window passed to means(), in frames.
  TemporalPyramid(double longest, HistoryStart start);

  /// Drops the history.
  void reset();

  /// Adds the next map (CV_32FC1, finite, copied), `elapsed` > 0 frames after the previous push
  /// (ignored for the first) and displayed for `duration` > 0 frames. All maps between two resets
  /// have one size. Times beyond the longest window are cut to it.
  ///
  /// `pose`: maps this map's samples to a common frame of reference. It must stay bit-identical
  /// while the camera rests.
  void push(const cv::Mat &map, double elapsed, double duration, const Similarity &pose = {});

  /// Raises the past of each sample toward the current map by `share` (CV_32FC1, in [0, 1]): with 1
  /// the sample has never been below what it is now. What was above stays. Requires at least one
  /// push, and a camera at rest.
  void settle(const cv::Mat &share);

  /// Changes the frame of reference: `view` maps the old one to the new one.
  void rebase(const Similarity &view);

  /// Whether the camera moved within the longest window, or shortly before.
  bool moved() const;

  /// Means over the last `windows` frames, each > 0 and ascending, into as many `maps` (CV_32FC1).
  /// Before the first push there is nothing (HistoryStart::empty: the mean of what exists) or the
  /// first map, held forever. If nothing changed within a window, its mean is exactly the current
  /// map.
  void means(std::span<const int> windows, std::vector<cv::Mat> &maps, const Team &team = {});

  /// Number of integrals held.
  std::size_t size() const;

private:
  /// The integral of the maps up to `time`, and the pose of the map displayed from then on.
  struct Entry
  {
    double time = 0;
    cv::Mat integral{}; ///< CV_64FC1
    Similarity pose{};
  };

  /// A point in time within the display between two entries.
  struct Moment
  {
    const Entry *before;
    const Entry *after;
    double part; ///< of the display that is over
  };

  /// Entry i, oldest first; the last has the time of the latest push.
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

  /// Index of the last display that begins before `time`, or of the first.
  std::size_t display_before(double time) const;
  Moment moment(double time) const;
  void difference(const Moment &from, const Moment &to, double scale, cv::Mat &map) const;
  void moved_means(std::span<const int> windows, std::vector<cv::Mat> &maps);
  void add_moved(double from, double to);

  double longest_;
  HistoryStart start_;
  std::vector<Entry> ring_; ///< entries in use, followed by spare ones
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
  cv::Mat current_; ///< the latest map
  Entry end_{};     ///< the end of its display

  cv::Mat stretch_; ///< integral over a stretch of time (CV_32FC1)
  cv::Mat sum_;     ///< of warped stretches, less the current map (CV_32FC1)
};

} // namespace saliency
