// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "pipeline.h"

#include <future>
#include <string>
#include <vector>

/// One of a film's own subtitles: all that a muxer needs of it.
struct Subtitles
{
  struct MiniUnref
  {
    void operator()(gpointer object) const
    {
      gst_mini_object_unref(GST_MINI_OBJECT_CAST(object));
    }
  };
  std::unique_ptr<GstCaps, MiniUnref> caps;
  std::unique_ptr<GstTagList, MiniUnref> tags;               ///< NULL: none
  std::vector<std::unique_ptr<GstBuffer, MiniUnref>> cues{}; ///< in running time
};

/// Whether a stream is of these: words or SSA.
bool is_subtitles(const GstStructure *structure);

/// A film's subtitles, in its order. Muxers wait for the next cue of each of their streams, so that
/// a film whose subtitles are read along with it would have to wait in memory. A film without any
/// is not read to its end. Throws std::runtime_error; false if it was stopped by SIGINT or SIGTERM.
bool read_subtitles(const std::string &path, GstClockTime duration, bool quiet,
                    std::vector<Subtitles> &subtitles);

/// Waits until what comes before a pad's first data, tags among it, has gone through the pad:
/// matroskamux writes the names of its streams as soon as it has data of pictures and sounds,
/// whether it has been told those of subtitles or not.
class Preface
{
public:
  /// Before the pad is active. `tags`: to be sent, too, or NULL.
  explicit Preface(GstPad *pad, const GstTagList *tags = nullptr);

  /// At most some seconds, for a pipeline that is stopped meanwhile.
  void wait();

private:
  std::future<void> past_;
};

/// Links subtitles to a muxer, in a pipeline that plays. False if it cannot hold them.
bool add_subtitles(GstElement *pipeline, GstElement *muxer, const Subtitles &subtitles);
