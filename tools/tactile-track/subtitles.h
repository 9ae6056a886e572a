// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <future>
#include <memory>
#include <string>
#include <vector>

/// One subtitle stream of a film: all that a muxer needs of it.
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

/// Whether caps are those of subtitles that can be muxed: text or SSA.
bool is_subtitles(const GstStructure *structure);

/// A film's subtitles, in its order, read before muxing: a muxer waits for the next cue of each
/// stream, and would have all data up to it queued. A film without subtitles is not read to its
/// end. Throws std::runtime_error; false after SIGINT or SIGTERM.
bool read_subtitles(const std::string &path, GstClockTime duration, bool quiet,
                    std::vector<Subtitles> &subtitles);

/// Waits until the events before a pad's first buffer, tags among them, have passed the pad.
/// matroskamux writes its header, with the names of streams, as soon as it has video and audio: the
/// tags of subtitles have to precede these.
class Preface
{
public:
  /// Before the pad is active. `tags`: pushed before the first buffer, or NULL.
  explicit Preface(GstPad *pad, const GstTagList *tags = nullptr);

  /// Times out after 10 s, for a pipeline that is stopped meanwhile.
  void wait();

private:
  std::future<void> past_;
};

/// Links subtitles to a muxer in a pipeline that plays. False if the muxer does not take them.
bool add_subtitles(GstElement *pipeline, GstElement *muxer, const Subtitles &subtitles);
