// SPDX-License-Identifier: LGPL-2.1-or-later
#include "playgate.h"

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
  auto *top = GST_OBJECT(gst_object_ref(owner_));
  while (GstObject *parent = gst_object_get_parent(top)) {
    gst_object_unref(top);
    top = parent;
  }
  bool plays = true;
  if (top != GST_OBJECT(owner_)) {
    GST_OBJECT_LOCK(top);
    plays = GST_STATE(top) == GST_STATE_PLAYING && GST_STATE_PENDING(top) == GST_STATE_VOID_PENDING;
    GST_OBJECT_UNLOCK(top);
  }
  gst_object_unref(top);
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
  const std::lock_guard lock(mutex_);
  if (!std::exchange(flushed_, false) || closed_ != 0 || pipeline_plays())
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
