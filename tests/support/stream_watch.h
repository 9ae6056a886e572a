// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What a seek is made of, as gst-validate checks it at each pad: flushes, segments and EOS have its
// sequence number, it comes before its flush, and the first buffer after it is discontinuous.
// Besides, buffers have data, and they and gaps follow each other.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

/// Keeps what passes pads.
class StreamWatch
{
public:
  /// One thing that passed a pad.
  struct Passed
  {
    std::string what;      ///< an event's name; "buffer"
    guint32 seqnum = 0;    ///< of an event
    GstClockTime time = 0; ///< of a buffer or a gap
    bool discont = false;
    gsize size = 0; ///< of a buffer
  };
  using ByPad = std::map<std::string, std::vector<Passed>>;

  /// The pads of one element, without those in it.
  void add(GstElement *element)
  {
    GstIterator *pads = gst_element_iterate_pads(element);
    const auto found = [](const GValue *item, gpointer watch) {
      static_cast<StreamWatch *>(watch)->add(GST_PAD(g_value_get_object(item)));
    };
    gst_iterator_foreach(pads, found, this);
    gst_iterator_free(pads);
  }

  /// By the path of each pad.
  ByPad passed()
  {
    const std::lock_guard lock(mutex_);
    return passed_;
  }
  /// `is_enough` only reads what it is given.
  void wait_until(const std::function<bool(const ByPad &)> &is_enough)
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_enough(passed_); });
  }

private:
  void add(GstPad *pad)
  {
    gst_pad_add_probe(pad,
                      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER
                                                   | GST_PAD_PROBE_TYPE_EVENT_BOTH
                                                   | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                      on_data, this, nullptr);
  }

  static GstPadProbeReturn on_data(GstPad *pad, GstPadProbeInfo *info, gpointer user)
  {
    auto *self = static_cast<StreamWatch *>(user);
    g_autofree gchar *path = gst_object_get_path_string(GST_OBJECT(pad));
    Passed passed;
    if (info->type & GST_PAD_PROBE_TYPE_BUFFER) {
      GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
      passed.what = "buffer";
      passed.time = GST_BUFFER_PTS(buffer);
      passed.discont = GST_BUFFER_IS_DISCONT(buffer);
      passed.size = gst_buffer_get_size(buffer);
    } else {
      GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
      passed.what = gst_event_type_get_name(GST_EVENT_TYPE(event));
      passed.seqnum = gst_event_get_seqnum(event);
      if (GST_EVENT_TYPE(event) == GST_EVENT_GAP)
        gst_event_parse_gap(event, &passed.time, nullptr);
    }
    const std::lock_guard lock(self->mutex_);
    self->passed_[path].push_back(passed);
    self->changed_.notify_all();
    return GST_PAD_PROBE_OK;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  ByPad passed_;
};

/// Checks a pad from the first seek on. Returns how often it had all that a seek is made of.
inline std::size_t
check_seeks(const std::string &pad, const std::vector<StreamWatch::Passed> &passed,
            const std::vector<guint32> &seeks)
{
  std::size_t flushed = 0;  ///< seeks whose flush began
  std::size_t complete = 0; ///< and whose buffers came
  bool begins = false;
  GstClockTime last = 0; ///< of the segment
  for (const StreamWatch::Passed &now : passed) {
    const bool starts = now.what == "flush-start";
    if (starts)
      flushed++;
    if (now.what == "seek")
      fail_unless(flushed < seeks.size() && now.seqnum == seeks[flushed],
                  "%s: a seek comes after its flush", pad.c_str());
    if (flushed == 0)
      continue;
    fail_unless(flushed <= seeks.size(), "%s: a flush that nobody asked for", pad.c_str());
    if (starts || now.what == "flush-stop" || now.what == "segment" || now.what == "eos")
      fail_unless(now.seqnum == seeks[flushed - 1], "%s: %s has another number than the seek",
                  pad.c_str(), now.what.c_str());
    if (now.what == "flush-stop")
      begins = true;
    if (now.what == "segment")
      last = 0;
    if (now.what == "buffer" || now.what == "gap") {
      fail_unless(now.time >= last, "%s: a %s goes back in time", pad.c_str(), now.what.c_str());
      last = now.time;
    }
    fail_if(now.what == "buffer" && now.size == 0, "%s: an empty buffer", pad.c_str());
    if (now.what == "buffer" && begins) {
      fail_unless(now.discont, "%s: no DISCONT after a seek", pad.c_str());
      begins = false;
      complete++;
    }
  }
  return complete;
}
