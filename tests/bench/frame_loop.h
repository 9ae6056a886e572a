// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace bench {

enum class Format
{
  i420,
  nv12,
  yuy2,
  uyvy,
  rgb,
  rgbx,
  i420_10le,
  p010_10le,
};
inline constexpr std::array kFormats{ Format::i420,      Format::nv12,     Format::yuy2,
                                      Format::uyvy,      Format::rgb,      Format::rgbx,
                                      Format::i420_10le, Format::p010_10le };

/// GStreamer's name of the format.
const char *name(Format format);

/// What the camera shows, in a loop.
enum class Scene
{
  disc,  ///< two frames: noise, and the same with a disc
  still, ///< noise, again and again
  head,  ///< a disc that moves by a pixel in every other frame, before noise
  pan,   ///< the camera pans right and left over random squares, 4 pixels per frame
};

/// A film in memory. BT.709, limited range; width and height are even.
class FrameLoop
{
public:
  /// An H.264 decoder at 4K holds up to five reference frames (level 5.1: ITU-T H.264, table A-1)
  /// and the frame it decodes. That exceeds most CPU caches.
  static constexpr std::size_t kBuffers = 6;

  /// Uses at most as many buffers as the scene has frames.
  FrameLoop(cv::Size size, Scene scene, Format format = Format::i420,
            std::size_t buffers = kBuffers);

  saliency::FrameView view(std::size_t i) const;
  /// The frame's bytes. I420 is CV_8UC1 of 3/2 the height, as OpenCV has it.
  const cv::Mat &bytes(std::size_t i) const
  {
    return frames_[i % frames_.size()];
  }
  cv::Size size() const
  {
    return size_;
  }

private:
  cv::Size size_;
  Format format_;
  std::vector<cv::Mat> frames_;
};

} // namespace bench
