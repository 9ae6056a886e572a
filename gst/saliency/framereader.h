// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frameshrinker.h"

#include <gst/video/video.h>

#include <memory>
#include <optional>
#include <utility>

/// The pixels that the analysis reads. Holds a reference to their buffer.
struct ReadFrame
{
  struct Window
  {
    double x;
    double y;
    double width;
    double height;
  };

  ReadFrame(const SmallPicture &picture, GstBuffer *buffer_, std::optional<Window> window_ = {})
      : info(picture.info), placement(picture.placement), window(window_), buffer(buffer_)
  {
  }
  ~ReadFrame()
  {
    if (buffer)
      gst_buffer_unref(buffer);
  }
  ReadFrame(ReadFrame &&other) noexcept
      : info(other.info), placement(other.placement), window(other.window),
        buffer(std::exchange(other.buffer, nullptr))
  {
  }
  ReadFrame &operator=(ReadFrame &&) = delete;

  GstVideoInfo info;
  Placement placement;
  /// The samples of a small picture that the frame's pixels fill, or the visible ones
  /// (GstVideoCropMeta).
  std::optional<Window> window;
  GstBuffer *buffer; ///< the frame, or a small picture of it; of a format that FrameMapping reads
};

/// Chooses how frames are read, by their memory and format. Streaming thread only, but for
/// set_caps() and stop() while it is stopped.
class FrameReader
{
public:
  enum class Path
  {
    none,      ///< frames cannot be read
    mapped,    ///< as they are, in the memory that they are in
    converted, ///< of a format that the analysis does not know, by GstVideoConverter
    gl,        ///< shrunk by OpenGL, in a module of its own
    element,   ///< shrunk by an element that takes their memory
  };

  /// `owner` is the element whose sink pad the frames come from.
  explicit FrameReader(GstElement *owner) : owner_(owner)
  {
  }
  ~FrameReader();
  FrameReader(const FrameReader &) = delete;
  FrameReader &operator=(const FrameReader &) = delete;

  /// Frames are of these caps from now on. `info` is NULL where they cannot be parsed.
  void set_caps(GstCaps *caps, const GstVideoInfo *info);
  /// Frees what frames needed.
  void stop();

  /// The pixels of a frame that may be halved as often before its analysis: a small picture, or the
  /// frame itself if halving is not needed or not possible. `frame` outlives the result. None if
  /// frames of these caps cannot be read.
  std::optional<ReadFrame> read(GstBuffer *frame, int halvings);

  /// How the last frame was read.
  Path path() const
  {
    return path_;
  }
  /// Read from small pictures so far.
  guint64 bytes() const
  {
    return bytes_;
  }

private:
  FrameShrinker *shrinker(int halvings);
  std::unique_ptr<FrameShrinker> make_shrinker(int halvings);
  std::optional<ReadFrame> shrink(GstBuffer *frame, int halvings);

  GstElement *owner_;
  GstCaps *caps_ = nullptr;
  GstVideoInfo info_{};
  bool parsed_ = false; ///< info_ is of caps_
  bool known_ = false;  ///< FrameMapping reads the format
  std::unique_ptr<FrameShrinker> shrinker_;
  int halvings_ = -1;         ///< that the shrinker, which may be none, was made for
  Path shrinks_ = Path::none; ///< how it does
  Path path_ = Path::none;
  guint64 bytes_ = 0;
};

/// For statistics: "none", "mapped", …
const char *name_of(FrameReader::Path path);
