// SPDX-License-Identifier: LGPL-2.1-or-later
#include "queuewatch.h"

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace {

constexpr GstClockTime kBetweenLooks = GST_SECOND;
constexpr int kLooks = 3;
/// Bound on elements in a row.
constexpr int kDeepest = 64;

struct Unref
{
  void operator()(gpointer object) const
  {
    gst_object_unref(object);
  }
};
template <typename T> using Ref = std::unique_ptr<T, Unref>;

/// The peer pad, through ghost pads.
Ref<GstPad>
other_end(GstPad *pad)
{
  Ref<GstPad> peer(gst_pad_get_peer(pad));
  while (peer && GST_IS_PROXY_PAD(peer.get())) {
    const Ref<GstProxyPad> inside(gst_proxy_pad_get_internal(GST_PROXY_PAD(peer.get())));
    peer.reset(inside ? gst_pad_get_peer(GST_PAD(inside.get())) : nullptr);
  }
  return peer;
}

/// Calls `visit` with each pad. Consumes the iterator.
void
for_each_pad(GstIterator *pads, const std::function<void(GstPad *)> &visit)
{
  if (!pads)
    return;
  // Without a resync: the next look sees pads that come and go now.
  gst_iterator_foreach(
      pads,
      [](const GValue *item, gpointer data) {
        (*static_cast<const std::function<void(GstPad *)> *>(data))(
            GST_PAD(g_value_get_object(item)));
      },
      const_cast<std::function<void(GstPad *)> *>(&visit));
  gst_iterator_free(pads);
}

/// Whether the pad has a thread of its own, as a queue's has.
bool
has_thread(GstPad *pad)
{
  return gst_pad_get_task_state(pad) != GST_TASK_STOPPED;
}

/// The kinds of sinks downstream of a pad.
struct Ends
{
  bool unqueued = false; ///< a sink is in the pad's own thread
  bool waiting = false;  ///< a sink has no first frame
};

void
look_down(GstPad *src, bool queued, int depth, Ends &ends)
{
  queued |= has_thread(src);
  const Ref<GstPad> pad = other_end(src);
  const Ref<GstElement> element(pad ? gst_pad_get_parent_element(pad.get()) : nullptr);
  if (!element || depth == 0)
    return;
  if (element->numsrcpads == 0) {
    GST_OBJECT_LOCK(element.get());
    ends.waiting |= GST_STATE_RETURN(element.get()) == GST_STATE_CHANGE_ASYNC;
    GST_OBJECT_UNLOCK(element.get());
    ends.unqueued |= !queued;
    return;
  }
  for_each_pad(gst_pad_iterate_internal_links(pad.get()),
               [&](GstPad *next) { look_down(next, queued, depth - 1, ends); });
}

/// Whether the pad's thread is blocked downstream.
bool
is_held(GstPad *sink)
{
  if (!GST_PAD_STREAM_TRYLOCK(sink))
    return true;
  GST_PAD_STREAM_UNLOCK(sink);
  return false;
}

/// Whether the element feeds several sinks from one thread and one blocks while another waits.
bool
is_stuck(GstElement *element, GstPad *sink)
{
  Ends ends;
  int linked = 0;
  for_each_pad(gst_element_iterate_src_pads(element), [&](GstPad *src) {
    linked += gst_pad_is_linked(src);
    look_down(src, false, kDeepest, ends);
  });
  return linked > 1 && ends.unqueued && ends.waiting && is_held(sink);
}

/// Name of the element upstream of a sink at which its thread is stuck; empty if there is none.
std::string
stuck_at(GstElement *sink)
{
  Ref<GstPad> pad(gst_element_get_static_pad(sink, "sink"));
  for (int depth = 0; pad && depth < kDeepest; depth++) {
    const Ref<GstPad> src = other_end(pad.get());
    const Ref<GstElement> element(src ? gst_pad_get_parent_element(src.get()) : nullptr);
    if (!element || has_thread(src.get()))
      return {};
    pad.reset();
    for_each_pad(gst_pad_iterate_internal_links(src.get()), [&](GstPad *next) {
      if (!pad)
        pad.reset(GST_PAD(gst_object_ref(next)));
    });
    if (pad && is_stuck(element.get(), pad.get()))
      return GST_OBJECT_NAME(element.get());
  }
  return {};
}

/// State of the looks; the clock's thread frees it.
struct Looking
{
  Looking(GstElement *element, std::function<bool()> ready) : is_ready(std::move(ready))
  {
    const std::lock_guard lock(mutex);
    g_weak_ref_init(&sink, element);
  }
  ~Looking()
  {
    g_weak_ref_clear(&sink);
  }
  Looking(const Looking &) = delete;
  Looking &operator=(const Looking &) = delete;

  std::mutex mutex; ///< for ThreadSanitizer, which does not see GstClock's own
  GWeakRef sink;    ///< weak, or the clock's thread could be the one that finalizes the element
  std::function<bool()> is_ready;
  int stuck = 0; ///< finds in a row
};

gboolean
look(GstClock *, GstClockTime time, GstClockID, gpointer data)
{
  auto *looking = static_cast<Looking *>(data);
  const std::lock_guard lock(looking->mutex);
  const Ref<GstElement> sink(static_cast<GstElement *>(g_weak_ref_get(&looking->sink)));
  if (!sink || !GST_CLOCK_TIME_IS_VALID(time) || looking->stuck == kLooks)
    return TRUE;
  const std::string where = looking->is_ready() ? stuck_at(sink.get()) : "";
  looking->stuck = where.empty() ? 0 : looking->stuck + 1;
  if (looking->stuck == kLooks)
    GST_ELEMENT_WARNING(
        sink.get(), CORE, PAD,
        ("The pipeline waits forever: a queue is missing after '%s'.", where.c_str()),
        ("For two seconds one of the sinks after '%s' has held its thread, and another has got "
         "nothing to begin with. Put a queue into each branch, as in %s. ! queue ! %s",
         where.c_str(), where.c_str(), GST_OBJECT_NAME(sink.get())));
  return TRUE;
}

} // namespace

void
QueueWatch::start(std::function<bool()> is_ready)
{
  stop();
  const Ref<GstClock> clock(gst_system_clock_obtain());
  looks_ = gst_clock_new_periodic_id(clock.get(), gst_clock_get_time(clock.get()) + kBetweenLooks,
                                     kBetweenLooks);
  auto looking = std::make_unique<Looking>(sink_, std::move(is_ready));
  gst_clock_id_wait_async(looks_, look, looking.release(), [](gpointer data) {
    const std::unique_ptr<Looking> done(static_cast<Looking *>(data));
    const std::lock_guard lock(done->mutex);
  });
}

void
QueueWatch::stop()
{
  if (!looks_)
    return;
  gst_clock_id_unschedule(looks_);
  gst_clock_id_unref(looks_);
  looks_ = nullptr;
}
