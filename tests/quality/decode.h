// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "gst/saliency/framemapping.h"

#include <gst/gst.h>

#include <opencv2/core/mat.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace quality {

/// Decodes the frames of a film or a picture. Requires gst_init(). Errors throw std::runtime_error
/// with the file's name.
class Decoder
{
public:
  /// `decoder` is an element such as decodebin or jpegdec, `format` one such as I420 or BGR.
  Decoder(const std::filesystem::path &file, const char *decoder, const char *format);
  ~Decoder();
  Decoder(const Decoder &) = delete;
  Decoder &operator=(const Decoder &) = delete;

  /// Moves to the next frame. False at the end.
  bool next();

  /// The frame, valid until the next one.
  const saliency::FrameView &view() const
  {
    return mapping_->view();
  }

  /// Display time of a film's frame.
  std::chrono::nanoseconds time() const;
  std::chrono::nanoseconds duration() const;

private:
  struct Unref
  {
    void operator()(GstElement *element) const;
    void operator()(GstSample *sample) const;
  };

  std::string name_;
  std::unique_ptr<GstElement, Unref> pipeline_;
  GstElement *sink_ = nullptr; ///< owned by the pipeline
  std::unique_ptr<GstSample, Unref> sample_;
  GstVideoInfo info_;
  std::unique_ptr<FrameMapping> mapping_;
};

/// An OpenCV view of a decoded BGR frame.
cv::Mat as_mat(const saliency::FrameView &bgr);

/// The films in `directory`, sorted by name: avi, m4v, mkv, mov, mp4, mpg, ogv, ts, webm. Throws
/// std::runtime_error if there is none.
std::vector<std::filesystem::path> list_films(const std::filesystem::path &directory);

} // namespace quality
