// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <string>

/// A pipeline from film to chair, of one of the kinds that applications build.
class Stage
{
public:
  enum class Kind
  {
    file,    ///< decodebin, analysis, a video and a tactile branch
    live,    ///< the same with a camera
    network, ///< maps over RTP and UDP, from a pipeline that plays elsewhere
    playbin, ///< a film with sound in playbin, shown by visuotactilesink
    decoder, ///< a film that visuotactiledecoder decodes for a sink of the player's
  };

  /// `film` is a seekable file, for the kinds that play one.
  Stage(Kind kind, const std::string &film);
  ~Stage();
  Stage(const Stage &) = delete;
  Stage &operator=(const Stage &) = delete;

  static bool is_seekable(Kind kind)
  {
    return kind == Kind::file || kind == Kind::playbin || kind == Kind::decoder;
  }
  bool is_seekable() const
  {
    return is_seekable(kind);
  }
  /// Whether the chair is beside a picture that goes on without it.
  static bool is_beside(Kind kind)
  {
    return kind == Kind::playbin || kind == Kind::decoder;
  }
  /// Whether EOS has entered the stream. Its message may not be on the bus yet.
  bool is_at_end() const;
  /// The pad upstream of tactorsink that maps, or frames with maps, come from. Transfer full.
  GstPad *upstream_pad() const;

  const Kind kind;
  GstElement *pipeline = nullptr;
  GstElement *tactors = nullptr;
  GstElement *analysis = nullptr; ///< NULL if it runs elsewhere
  GstElement *size = nullptr;     ///< capsfilter for the picture's size, or NULL
  GstElement *branch = nullptr;   ///< queue of a tactile branch that can be removed, or NULL
  GstElement *source = nullptr;   ///< of the sender, or NULL

private:
  void link_decoder();
};

constexpr gint64 kFilmLength = 12 * GST_SECOND;

/// Writes a film of kFilmLength: a moving ball, with a tone. Every frame is a key frame.
void make_film(const std::string &path);
