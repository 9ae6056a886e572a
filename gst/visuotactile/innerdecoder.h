// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <mutex>

/// The video decoder in visuotactiledecoder, chosen by the stream. Queries come on any thread.
class InnerDecoder
{
public:
  /// Puts decoders into `bin`, between its ghost pad `sink` and `next`. None of them is owned.
  InnerDecoder(GstBin *bin, GstPad *sink, GstElement *next);
  ~InnerDecoder();
  InnerDecoder(const InnerDecoder &) = delete;
  InnerDecoder &operator=(const InnerDecoder &) = delete;

  /// Whether the stream can be decoded. The first stream that can be gets its decoder. Another one
  /// gets another decoder only if it `begins` before any other has begun.
  bool accept(GstCaps *caps, bool begins);
  /// Streams that can be decoded. Transfer full.
  GstCaps *caps(GstCaps *filter);
  /// Takes the decoder out of the bin.
  void remove();

private:
  GstElement *ref() const;
  bool add(GstCaps *caps);
  void take_out();

  GstBin *bin_;
  GstPad *sink_;
  GstElement *next_;
  std::mutex choosing_;           ///< while a decoder is chosen, put in or taken out
  GstElement *decoder_ = nullptr; ///< in the bin, owned; guarded by the bin's object lock
};
