// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <string>

/// A film on its way to a chair, of one of the kinds in which applications build it.
class Stage
{
public:
  enum class Kind
  {
    file,    ///< decodebin, analysis, a video and a tactile branch
    live,    ///< a camera, likewise
    network, ///< maps over RTP and UDP, from a pipeline that plays elsewhere
    playbin, ///< a film with sound in playbin, shown by visuotactilesink
  };

  /// `film` is a seekable file, for the kinds that play one.
  Stage(Kind kind, const std::string &film);
  ~Stage();
  Stage(const Stage &) = delete;
  Stage &operator=(const Stage &) = delete;

  static bool is_seekable(Kind kind)
  {
    return kind == Kind::file || kind == Kind::playbin;
  }
  bool is_seekable() const
  {
    return is_seekable(kind);
  }
  /// The end of a stream is on its way to its sink or there, though perhaps not yet on the bus.
  bool is_at_end() const;
  /// The pad that maps or frames with maps come from: what happens there happens to tactorsink's
  /// upstream. Transfer full.
  GstPad *upstream_pad() const;

  const Kind kind;
  GstElement *pipeline = nullptr;
  GstElement *tactors = nullptr;
  GstElement *analysis = nullptr; ///< NULL: it is elsewhere
  GstElement *size = nullptr;     ///< a capsfilter of the picture's size; may be NULL
  GstElement *branch
      = nullptr; ///< the tactile branch's queue, where it can be taken away; may be NULL
  GstElement *source = nullptr; ///< of the other computer; may be NULL

private:
  void link_decoder();
};

constexpr gint64 kFilmLength = 12 * GST_SECOND;

/// Writes so much of a ball that moves about, with a tone; each frame can be sought.
void make_film(const std::string &path);
