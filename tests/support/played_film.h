// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film for players, and the decoder that they choose for it.
#pragma once

#include "support/playing.h"

#include <string>

/// A moving ball with a tone. Every frame is a key frame.
inline void
make_film(const std::string &path, guint frames)
{
  const std::string line
      = "tactiletestsrc pattern=dynamic-motion num-buffers=" + std::to_string(frames)
        + " ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! "
          "jpegenc quality=95 ! matroskamux name=mux ! filesink location="
        + path + " audiotestsrc samplesperbuffer=1470 num-buffers=" + std::to_string(frames)
        + " ! audio/x-raw,format=S16LE,rate=44100,channels=1 ! mux.";
  play_to_the_end(make_pipeline(line));
}

inline std::string
uri_of(const std::string &film)
{
  g_autofree gchar *uri = gst_filename_to_uri(film.c_str(), nullptr);
  return uri;
}

inline void
rank_decoder(const char *name, guint rank)
{
  g_autoptr(GstPluginFeature) feature = gst_registry_lookup_feature(gst_registry_get(), name);
  fail_unless(feature != nullptr, "no %s", name);
  gst_plugin_feature_set_rank(feature, rank);
}
