// SPDX-License-Identifier: LGPL-2.1-or-later
#include "playgate.h"

#include "gst/fusion/topmost.h"

#include <utility>

PlayGate::PlayGate(GstElement *owner, GstPad *pad)
    : owner_(owner), pad_(GST_PAD(gst_object_ref(pad)))
{
}

PlayGate::~PlayGate()
{
  open();
  gst_object_unref(pad_);
}

/// True also without a pipeline, whose states would open the gate.
bool
PlayGate::pipeline_plays() const
{
  g_autoptr(GstObject) top = topmost(GST_OBJECT(owner_));
  if (top == GST_OBJECT(owner_))
    return true;
  GST_OBJECT_LOCK(top);
  const bool plays
      = GST_STATE(top) == GST_STATE_PLAYING && GST_STATE_PENDING(top) == GST_STATE_VOID_PENDING;
  GST_OBJECT_UNLOCK(top);
  return plays;
}

void
PlayGate::flush()
{
  const std::lock_guard lock(mutex_);
  flushed_ = true;
}

void
PlayGate::pass()
{
  {
    const std::lock_guard lock(mutex_);
    if (!flushed_)
      return;
  }
  const bool plays = pipeline_plays(); // without the mutex: others' locks are taken
  const std::lock_guard lock(mutex_);
  // open() may have come meanwhile.
  if (!std::exchange(flushed_, false) || closed_ != 0 || plays)
    return;
  closed_ = gst_pad_add_probe(
      pad_, static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER),
      [](GstPad *, GstPadProbeInfo *, gpointer) { return GST_PAD_PROBE_OK; }, nullptr, nullptr);
}

void
PlayGate::open()
{
  const std::lock_guard lock(mutex_);
  flushed_ = false;
  if (closed_ != 0)
    gst_pad_remove_probe(pad_, std::exchange(closed_, 0));
}
