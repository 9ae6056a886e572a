// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "gst/saliency/framemapping.h"

#include <gst/gst.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace quality {

/// The frames of a film or of a picture, decoded, one after the other. GStreamer is initialized.
/// What goes wrong throws std::runtime_error with the file's name.
class Decoder
{
public:
  /// `decoder`: the element that decodes the file (decodebin, jpegdec); `format`: of the frames,
  /// I420 or BGR say.
  Decoder(const std::filesystem::path &file, const char *decoder, const char *format);
  ~Decoder();
  Decoder(const Decoder &) = delete;
  Decoder &operator=(const Decoder &) = delete;

  /// Goes on to the next frame; false at the end.
  bool next();

  /// The frame, valid until the next one.
  const saliency::FrameView &view() const
  {
    return mapping_->view();
  }

  /// When the frame is shown and for how long, of a film.
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
  GstElement *sink_ = nullptr; ///< held by the pipeline
  std::unique_ptr<GstSample, Unref> sample_;
  GstVideoInfo info_;
  std::unique_ptr<FrameMapping> mapping_;
};

/// The films in `directory` by name: avi, m4v, mkv, mov, mp4, mpg, ogv, ts, webm. Throws
/// std::runtime_error if there is none.
std::vector<std::filesystem::path> list_films(const std::filesystem::path &directory);

} // namespace quality
