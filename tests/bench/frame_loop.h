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

/// As GStreamer spells it.
const char *name(Format format);

/// What the camera shows, over and over.
enum class Scene
{
  disc, ///< two frames: noise, and the same with something in it
  pan,  ///< the camera goes to and fro, 4 pixels a frame, over random squares
};

/// A film in memory. BT.709, limited range; width and height are even.
class FrameLoop
{
public:
  /// At 4K a decoder of H.264 keeps up to five frames for reference (level 5.1: ITU-T H.264, table
  /// A-1) while it makes another. Few processors' caches hold as many.
  static constexpr std::size_t kBuffers = 6;

  /// Frames lie in that many buffers, or as many as the scene has.
  FrameLoop(cv::Size size, Scene scene, Format format = Format::i420,
            std::size_t buffers = kBuffers);

  saliency::FrameView view(std::size_t i) const;
  /// The frame's bytes; of I420 as OpenCV takes it, CV_8UC1 of 3/2 the height.
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
