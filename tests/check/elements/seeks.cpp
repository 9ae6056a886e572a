// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Seeks and gaps at every pad of every element that has a stream, and within bins. players_seeks
// has players.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "gst/fusion/sound_meta.h"
#include "tracks/klv.h"

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/stream_watch.h"
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

namespace {

constexpr GstClockTime kStep = 40 * GST_MSECOND;

/// A stream that goes into an element.
struct Input
{
  const char *pad;
  const char *caps;
  GstBuffer *(*make)();
};

struct Case
{
  const char *element; ///< a launch line
  std::vector<Input> inputs;
  std::vector<const char *> gaps;   ///< ELEMENT:PAD where gaps pass
  std::vector<const char *> silent; ///< ELEMENT:PAD without buffers
};

GstBuffer *
map_of(float level)
{
  const float levels[] = { level, 0 };
  return gst_tactile_map_buffer_new(levels, 2);
}

GstBuffer *
bytes(gsize size)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, 0, size);
  return buffer;
}

const Input kFrames{ "sink", "video/x-raw,format=GRAY8,width=16,height=16,framerate=25/1", [] {
                      return bytes(256);
                    } };
const Input kFeltFrames{ "sink", kFrames.caps, [] {
                          GstBuffer *frame = bytes(256);
                          const float levels[] = { 1, 0 };
                          gst_buffer_add_tactile_meta(frame, 1, 2, levels, 2);
                          return frame;
                        } };
const Input kMaps{ "sink", "application/x-tactile-map,rows=1,columns=2,framerate=25/1", [] {
                    return map_of(1);
                  } };
const Input kTrack{ "tactile", kMaps.caps, kMaps.make };
const Input kText{ "sink", "text/x-raw,format=utf8", [] {
                    return gst_buffer_new_memdup("100 0", 5);
                  } };
const Input kCues{ "text_sink", kText.caps, kText.make };
const Input kPictures{ "video_sink", "video/x-raw,format=I420,width=16,height=16,framerate=25/1",
                       [] {
                         return bytes(384);
                       } };
const Input kSound{ "sink", "audio/x-raw,format=F32LE,rate=48000,channels=1,layout=interleaved",
                    [] {
                      return bytes(48000 / 25 * sizeof(float));
                    } };

/// As it is in WebM: name, settings and text of a cue.
const Input kWords{ "sink", "application/x-subtitle-unknown", [] {
                     return gst_buffer_new_memdup("\n\nwords", 7);
                   } };
const Input kKlv{ "sink", "meta/x-klv,parsed=true", [] {
                   tactile::TactileMap map(1, 2);
                   map.levels = { 1, 0 };
                   const auto packet = tactile::write_klv(map, std::chrono::milliseconds(40));
                   return gst_buffer_new_memdup(packet.data(), packet.size());
                 } };

const std::vector<Case> kCases{
  { "tactileextractor name=x", { kFeltFrames }, { "x:src", "x:tactile" }, {} },
  { "tactileextractor name=x",
    { kFrames },
    { "x:src", "x:tactile" },
    { "x:tactile", "to-tactile:sink" } },
  { "tactilecombiner name=x", { kTrack, kFrames }, { "x:src" }, {} },
  { "soundtactile name=x", { kSound }, { "x:src", "x:tactile" }, {} },
  { "tactilesynth name=x", { kMaps }, {}, {} },
  { "tactoraudiosink name=x audio-sink=fakesink", { kMaps }, {}, {} },
  { "visuotactilesink name=x driver=simulator video-sink=fakesink",
    { kFeltFrames },
    { "analysis:src", "video-queue:src", "extractor:tactile", "tactors:sink" },
    {} },
  { "saliencytactile name=x", { kFrames }, { "x:src" }, {} },
  { "tactileoverlay name=x",
    { { "sink", "video/x-raw,format=I420,width=16,height=16,framerate=25/1",
        [] {
          return bytes(384);
        } } },
    { "x:src" },
    {} },
  { "tactileconverter name=x ! capsfilter caps=text/x-raw", { kMaps }, { "x:src" }, {} },
  { "tactileconverter name=x ! capsfilter caps=application/x-tactile-map",
    { kText },
    { "x:src" },
    {} },
  { "tactileconverter name=x ! capsfilter caps=application/x-tactile-map",
    { kMaps },
    { "x:src" },
    {} },
  { "tactilesubtitles name=x", { kPictures, kCues }, { "x:src" }, { "words:text_sink" } },
  { "tactileklvdec name=x", { kKlv }, { "x:src" }, { "x:src", "to-src:sink" } },
  { "tactileklvdec name=x", { kWords }, { "x:src" }, {} },
  { "tactorsink name=x driver=simulator", { kMaps }, { "x:sink" }, {} },
};

/// An element that plays, between pads of the test's and sinks that take all at once.
class Played
{
public:
  explicit Played(const Case &of)
      : inputs_(of.inputs), pipeline_(gst_pipeline_new(nullptr)),
        element_(gst_parse_bin_from_description(of.element, FALSE, nullptr))
  {
    fail_unless(element_ != nullptr, "%s", of.element);
    gst_bin_add(GST_BIN(pipeline_), element_);
    for_each(element_, [this](GstElement *element) { prepare(element); });
    for (const Input &input : inputs_)
      feed(input);
    for_each(pipeline_, [this](GstElement *element) { watch.add(element); });
    fail_if(gst_element_set_state(pipeline_, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    for (const GstPad *source : sources_)
      fail_unless(gst_pad_set_active(const_cast<GstPad *>(source), TRUE));
  }
  ~Played()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    for (GstPad *source : sources_)
      gst_object_unref(source);
    gst_object_unref(pipeline_);
  }
  Played(const Played &) = delete;
  Played &operator=(const Played &) = delete;

  void begin()
  {
    for (std::size_t i = 0; i < sources_.size(); i++) {
      push(i, gst_event_new_stream_start(inputs_[i].pad));
      push(i, gst_event_new_caps(gst_caps_from_string(inputs_[i].caps)));
    }
    open_segment(0, gst_util_seqnum_next());
  }

  /// As a demuxer does. Returns the seek's number.
  guint32 seek(GstClockTime to)
  {
    GstEvent *seek = gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_SET,
                                        static_cast<gint64>(to), GST_SEEK_TYPE_NONE, 0);
    const guint32 number = gst_event_get_seqnum(seek);
    gst_element_send_event(pipeline_, seek);
    push_to_all([number] {
      GstEvent *event = gst_event_new_flush_start();
      gst_event_set_seqnum(event, number);
      return event;
    });
    push_to_all([number] {
      GstEvent *event = gst_event_new_flush_stop(TRUE);
      gst_event_set_seqnum(event, number);
      return event;
    });
    open_segment(to, number);
    return number;
  }

  void play(int count)
  {
    for (int n = 0; n < count; n++, time_ += kStep)
      for (std::size_t i = 0; i < sources_.size(); i++) {
        GstBuffer *buffer = inputs_[i].make();
        GST_BUFFER_PTS(buffer) = time_;
        GST_BUFFER_DURATION(buffer) = kStep;
        if (begins_ && n == 0)
          GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
        fail_unless_equals_int(gst_pad_push(sources_[i], buffer), GST_FLOW_OK);
      }
    begins_ = false;
  }

  void play_gap()
  {
    push_to_all([this] { return gst_event_new_gap(time_, kStep); });
    time_ += kStep;
  }

  void end(guint32 number)
  {
    push_to_all([number] {
      GstEvent *event = gst_event_new_eos();
      gst_event_set_seqnum(event, number);
      return event;
    });
    wait_for_eos(pipeline_);
  }

  StreamWatch watch;

private:
  static void for_each(GstElement *bin, const std::function<void(GstElement *)> &act)
  {
    GstIterator *all = gst_bin_iterate_recurse(GST_BIN(bin));
    gst_iterator_foreach(
        all,
        [](const GValue *item, gpointer data) {
          (*static_cast<const std::function<void(GstElement *)> *>(data))(
              GST_ELEMENT(g_value_get_object(item)));
        },
        const_cast<std::function<void(GstElement *)> *>(&act));
    gst_iterator_free(all);
  }

  /// No clock is waited for, and no sink for a preroll that some pads never have.
  static void prepare(GstElement *element)
  {
    GObjectClass *properties = G_OBJECT_GET_CLASS(element);
    for (const char *name : { "sync", "async" })
      if (g_object_class_find_property(properties, name) && !GST_IS_BIN(element))
        g_object_set(element, name, FALSE, nullptr);
  }

  /// Links all source pads that have no peer, and this input.
  void feed(const Input &input)
  {
    g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(element_), "x");
    g_autoptr(GstPad) sink = gst_element_get_static_pad(element, input.pad);
    if (sink == nullptr)
      sink = gst_element_request_pad_simple(element, input.pad);
    GstPad *source = GST_PAD(gst_object_ref_sink(gst_pad_new(input.pad, GST_PAD_SRC)));
    gst_pad_set_event_function(source, [](GstPad *, GstObject *, GstEvent *event) -> gboolean {
      gst_event_unref(event);
      return TRUE;
    });
    ck_assert_int_eq(gst_pad_link_full(source, sink, GST_PAD_LINK_CHECK_NOTHING), GST_PAD_LINK_OK);
    sources_.push_back(source);
    while (GstPad *open = gst_bin_find_unlinked_pad(GST_BIN(element_), GST_PAD_SRC)) {
      g_autofree gchar *name = g_strconcat("to-", GST_PAD_NAME(open), nullptr);
      GstElement *taker = gst_element_factory_make("fakesink", name);
      prepare(taker);
      gst_bin_add(GST_BIN(element_), taker);
      g_autoptr(GstPad) takes = gst_element_get_static_pad(taker, "sink");
      ck_assert_int_eq(gst_pad_link(open, takes), GST_PAD_LINK_OK);
      gst_object_unref(open);
    }
  }

  void push(std::size_t source, GstEvent *event)
  {
    fail_unless(gst_pad_push_event(sources_[source], event), "%s of %s", GST_EVENT_TYPE_NAME(event),
                inputs_[source].pad);
  }
  void push_to_all(const std::function<GstEvent *()> &make)
  {
    for (GstPad *source : sources_)
      gst_pad_push_event(source, make());
  }

  void open_segment(GstClockTime time, guint32 number)
  {
    push_to_all([time, number] {
      GstSegment segment;
      gst_segment_init(&segment, GST_FORMAT_TIME);
      segment.start = segment.time = segment.position = time;
      GstEvent *event = gst_event_new_segment(&segment);
      gst_event_set_seqnum(event, number);
      return event;
    });
    time_ = time;
    begins_ = true;
  }

  const std::vector<Input> inputs_;
  GstElement *pipeline_;
  GstElement *element_;
  std::vector<GstPad *> sources_;
  GstClockTime time_ = 0;
  bool begins_ = true; ///< the next buffers are a source's first ones
};

/// Whether a pad's path is of ELEMENT:PAD.
bool
is_pad(const std::string &path, const std::string &name)
{
  const std::size_t colon = name.find(':');
  return path.find(":" + name.substr(0, colon) + ".") != std::string::npos
         && path.ends_with(name.substr(colon));
}

bool
is_one_of(const std::string &path, const std::vector<const char *> &names)
{
  return std::ranges::any_of(names, [&](const char *name) { return is_pad(path, name); });
}

} // namespace

/// All streams have come through since the last seek.
void
wait_for_buffers(Played &played, const Case &of)
{
  played.watch.wait_until([&](const StreamWatch::ByPad &all) {
    return std::ranges::all_of(all, [&](const auto &pad) {
      const auto last = std::ranges::find(pad.second.rbegin(), pad.second.rend(), "flush-stop",
                                          &StreamWatch::Passed::what);
      return is_one_of(pad.first, of.silent)
             || std::ranges::count(pad.second.rbegin(), last, "buffer", &StreamWatch::Passed::what)
                    > 0;
    });
  });
}

CHECK_LOOP_TEST(test_seeks_and_gaps, 0, kCases.size())
{
  const Case &of = kCases.at(static_cast<std::size_t>(__i__));
  Played played(of);
  played.begin();
  played.play(6);
  std::vector<guint32> seeks{ played.seek(10 * GST_SECOND) };
  played.play(6);
  played.play_gap(); // ends a cue
  wait_for_buffers(played, of);
  seeks.push_back(played.seek(5 * GST_SECOND));
  played.play_gap(); // first of all
  played.play(6);
  played.play_gap();
  played.play(4);
  played.end(seeks.back());

  std::vector<std::string> gaps(of.gaps.begin(), of.gaps.end());
  for (const auto &[pad, passed] : played.watch.passed()) {
    const std::size_t complete = check_seeks(pad, passed, seeks);
    ck_assert_msg(complete == (is_one_of(pad, of.silent) ? 0 : seeks.size()),
                  "%s: %s has %zu seeks with buffers", of.element, pad.c_str(), complete);
    if (std::ranges::count(passed, "gap", &StreamWatch::Passed::what) >= 2)
      std::erase_if(gaps, [&pad = pad](const std::string &name) { return is_pad(pad, name); });
  }
  fail_unless(gaps.empty(), "%s: gaps do not pass %s", of.element,
              gaps.empty() ? "" : gaps.front().c_str());
}

CHECK_MAIN(seeks)
